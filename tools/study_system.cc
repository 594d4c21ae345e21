// SPDX-License-Identifier: Apache-2.0
#include "tools/study_system.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "lib/analysis/job.h"
#include "lib/output/atomic_file.h"
#include "lib/output/progress.h"
#include "lib/output/text.h"
#include "lib/prescription/study_reader.h"
#include "tools/load.h"
#include "tools/pictures.h"
#include "tools/study_table.h"
#include "tools/version.h"
#include "tools/write.h"

namespace sagitta::tools {
namespace {

namespace fs = std::filesystem;
constexpr const char* command = "study";

study::Sampling sample_with_progress(const prescription::Model& model, int thread_count) {
  constexpr std::uint64_t steps = 1000;
  output::Progress line("sagitta study " + model.name, steps, {.tells_time_left = true});
  std::uint64_t shown = 0;
  study::SamplingRequest request;
  request.thread_count = thread_count;
  return study::sample_system(model, request, [&](double share) {
    const auto reached = static_cast<std::uint64_t>(share * steps);
    line.advance(reached - shown);
    shown = reached;
  });
}

std::string cell(double value) { return std::isfinite(value) ? fmt::format("{}", value) : ""; }
std::string cell(std::int64_t value) { return fmt::format("{}", value); }

// The cells of a row whose setting is known: what was found for one field and wavelength.
struct Found {
  study::Quantity quantity;
  const study::Answers& answers;
  double wavelength_um;
  const study::Answer& truth;
  double uncertainty, error, worst, bound;
};

class Rows {
 public:
  explicit Rows(output::Records& records) : records_(records) {}

  void add(const std::string& varied, const study::Run& run, const study::CloudRun* cloud, const Found& found, const study::ToleranceRun* tolerance = nullptr) {
    const bool in_percent = found.truth.size() == 1 && found.truth.front() >= study::negligible(found.quantity, found.wavelength_um);
    const auto percent = [&](double error) { return in_percent ? cell(100 * error / found.truth.front()) : ""; };
    const study::Answer& value = study::answer_of(found.answers, found.quantity);
    records_.rows.push_back({study::name_of(found.quantity), varied, run.pattern, run.rays > 0 ? cell(run.rays) : "", run.grid > 0 ? cell(static_cast<std::int64_t>(run.grid)) : "",
                             cloud ? cell(static_cast<std::int64_t>(cloud->surface_number)) : "", cloud ? cloud->interpolation : "", tolerance ? cell(tolerance->tolerance_mm) : "", tolerance ? cell(tolerance->steps) : "",
                             cell(static_cast<std::int64_t>(found.answers.field)), fmt::format("{:g}", found.wavelength_um * 1e3), cell(found.answers.launched), cell(found.answers.arrived),
                             study::unit_of(found.quantity), value.size() == 1 ? cell(value.front()) : "", cell(found.error), percent(found.error), cell(found.worst), cell(found.bound), percent(found.bound),
                             cell(found.uncertainty), cell(run.processor_s.median), cell(run.processor_s.least), cell(run.processor_s.most), cell(run.wall_s.median),
                             cell(static_cast<std::int64_t>(run.processor_s.runs)), cloud ? cell(cloud->prepare_s) : "", study::reason_of(found.answers, found.quantity)});
  }

  void add_failed(const study::CloudRun& cloud) {
    std::vector<std::string> cells(records_.columns.size());
    const auto cell_of = [&](const char* name) -> std::string& {
      return cells[static_cast<std::size_t>(std::find_if(records_.columns.begin(), records_.columns.end(), [&](const auto& column) { return column.name == name; }) - records_.columns.begin())];
    };
    cell_of("varied") = "interpolation";
    cell_of("surface") = cell(static_cast<std::int64_t>(cloud.surface_number));
    cell_of("interpolation") = cloud.interpolation;
    cell_of("reason") = cloud.reason;
    records_.rows.push_back(std::move(cells));
  }

 private:
  output::Records& records_;
};

}  // namespace

bool is_of_the_other_kind(const std::string& file, const std::string& key, const std::string& what, const std::string& meant) {
  const auto place = prescription::place_of_root_key(file, key);
  if (!place) return false;
  prescription::Findings findings;
  findings.error(*place, what, meant);
  return !report(findings);
}

output::Records system_records(const SystemStudy& system) {
  output::Records records{{{"answer", true}, {"varied", true}, {"pattern", true}, {"rays"}, {"grid"}, {"surface"}, {"interpolation", true}, {"tolerance_mm"}, {"steps"}, {"field"}, {"wavelength_nm"}, {"launched"}, {"arrived"},
                           {"unit", true}, {"value"}, {"error"}, {"error_percent"}, {"worst_to_next"}, {"claim"}, {"claim_percent"}, {"truth_uncertainty"}, {"processor_s"}, {"processor_least_s"}, {"processor_most_s"},
                           {"wall_s"}, {"runs"}, {"prepare_s"}, {"reason", true}},
                          {}};
  Rows rows(records);
  for (const study::Curve& curve : system.curves)
    for (const study::Step& step : curve.steps)
      for (std::size_t k = 0; k < curve.truths.size(); ++k) {
        const study::Answers& answers = step.run->answers[k];
        rows.add(step.run->grid > 0 ? "samples" : "rays", *step.run, nullptr,
                 {curve.quantity, answers, system.sampling.wavelengths_um[answers.wavelength], curve.truths[k].value, curve.truths[k].uncertainty, step.errors[k], step.worst[k], step.bounds[k]});
      }
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  const auto add_changed = [&](const char* varied, const auto& changed, const auto& finest_run, const study::CloudRun* cloud, const study::ToleranceRun* tolerance) {
    for (const study::Quantity quantity : study::quantities) {
      const study::Run& run = study::run_of(changed, quantity);
      const auto& finest = study::run_of(finest_run, quantity).answers;
      for (std::size_t k = 0; k < run.answers.size(); ++k) {
        const study::Answer truth = k < finest.size() ? study::answer_of(finest[k], quantity) : study::Answer{};
        const study::Answers& answers = run.answers[k];
        rows.add(varied, run, cloud, {quantity, answers, system.sampling.wavelengths_um[answers.wavelength], truth, none, study::error_of(study::answer_of(answers, quantity), truth), none, none}, tolerance);
      }
    }
  };
  for (const study::CloudChange& change : system.changes) {
    if (!change.run->reason.empty()) rows.add_failed(*change.run);
    add_changed("interpolation", *change.run, *change.finest, change.run, nullptr);
  }
  for (const study::ToleranceChange& change : system.tolerances) add_changed("tolerance", *change.run, *system.tolerances.front().run, nullptr, change.run);
  return records;
}

int study_system(const StudyOptions& options) {
  if (is_of_the_other_kind(options.system, "sagitta_study", "this is a study, not a system", fmt::format("give it as it is: sagitta study {} -o {}", options.system, options.folder))) return 1;
  const auto model = load_model(options.system, options.settings);
  if (!model) return model.status;  // nothing is made where it is wrong
  if (!load_scene(*model, analysis::beam_of_job())) return 1;
  if (!pictures(command)) return 1;
  const fs::path folder(options.folder);
  if (!make_folder(command, folder)) return 1;
  const study::Sampling sampling = sample_with_progress(*model, options.thread_count);
  if (!report(prescription::in_order(sampling.findings, model->documents))) return 1;

  SystemStudy system{*model, sampling, study::curves_of(sampling), study::changes_of(sampling), study::tolerance_changes_of(sampling), {}, {}};
  system.advice = study::advice(system.curves, system.changes, system.tolerances);
  for (std::string& line : study::missing_answers(sampling)) system.advice.push_back(std::move(line));
  system.truth_note = study::truth_note(system.curves, system.changes);

  const output::Records records = system_records(system);
  bool all_written = written(command, output::write_file((folder / "study.csv").string(), to_csv(records)));
  all_written = written(command, output::write_file((folder / "study.json").string(), to_json({{"study", "system"}, {"system", model->name}, {"advice", fmt::format("{}", fmt::join(system.advice, "\n"))},
                                                                                             {"truth", system.truth_note}, {"version", version()}, {"build", build()}, {"processor", processor_name()}}, records))) && all_written;
  const std::vector<SystemPlot> plots = system_plots(system);
  for (const SystemPlot& plot : plots) all_written = write_chart(command, folder / plot.file, plot.chart) && all_written;
  all_written = written(command, output::write_file((folder / "study.md").string(), system_page(system, plots))) && all_written;

  fmt::print("{}: {}\n", output::printable(model->name, 200), fields_of(*model));
  for (const std::string& line : system.advice) fmt::print("{}\n", output::printable(line, 1000));
  if (!system.truth_note.empty()) fmt::print("{}\n", system.truth_note);
  const bool any_arrived = std::any_of(system.curves.begin(), system.curves.end(), [](const study::Curve& curve) { return curve.quantity == study::Quantity::spot_rms; });
  if (!any_arrived) fmt::print(stderr, "sagitta study: not one ray arrived at the image surface\n");
  return all_written && any_arrived ? 0 : 1;
}

}  // namespace sagitta::tools
