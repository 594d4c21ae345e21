// SPDX-License-Identifier: Apache-2.0
// sagitta study NAME_OR_FILE -o DIR: error against run time, variant by variant.
#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <tuple>
#include <utility>

#include "lib/output/atomic_file.h"
#include "lib/output/progress.h"
#include "lib/prescription/study_reader.h"
#include "tools/commands.h"
#include "tools/load.h"
#include "tools/pictures.h"
#include "tools/study_page.h"
#include "tools/study_run.h"
#include "tools/version.h"
#include "tools/write.h"

namespace sagitta::tools {
namespace {

namespace fs = std::filesystem;
constexpr const char* command = "study";

std::optional<prescription::StudyFile> load_study(const std::string& name) {
  const auto file = prescription::find_study(name);
  if (!file) {
    const std::vector<std::string> names = prescription::study_names();
    const std::string meant = prescription::nearest_name(name, names);
    fmt::print(stderr, "sagitta study: there is no study '{}'\n  hint: {}\n", prescription::excerpt(name),
               meant.empty() ? fmt::format("give a file, or one of {}", fmt::join(names, ", ")) : fmt::format("did you mean '{}'?", meant));
    return std::nullopt;
  }
  prescription::StudyReadResult read = prescription::read_study(*file);
  if (!report(read.findings)) return std::nullopt;
  return std::move(read.study);
}

// Both files, whole. True if they were written.
bool save(const fs::path& folder, const prescription::StudyFile& study, const std::vector<StudyRow>& rows) {
  const output::Records records = records_of(rows);
  const auto csv = output::write_file((folder / "study.csv").string(), to_csv(records));
  const auto json = output::write_file((folder / "study.json").string(), to_json({{"study", study.name}, {"title", study.title}, {"source", study.source}, {"system", study.system.name},
                                                                                 {"version", version()}, {"build", build()}, {"processor", processor_name()}}, records));
  const bool csv_is_written = written(command, csv);
  return written(command, json) && csv_is_written;
}

struct Pending {
  StudyRow* row;
  study::Variant variant;

  // Variants with the same exact rays come one after the other, and among them those with the same rough points.
  auto shared() const {
    const bool is_rough = variant.noise.rms_um > 0;
    const auto shared_points = is_rough ? std::tuple(variant.arrangement.kind, variant.arrangement.points_per_mm2, variant.arrangement.rings, variant.arrangement.meridians,
                                                     variant.margin_spacings, variant.cloud_radius_mm)
                                        : std::tuple(study::ArrangementKind{}, 0.0, 0, 0, 0.0, 0.0);
    return std::tuple(is_rough ? variant.noise.rms_um : 0, is_rough ? variant.noise.correlation_length_um : 0, is_rough ? variant.seed : 0, variant.pattern.kind, variant.pattern.seed,
                      std::min(variant.rays, variant.most_compared), shared_points);
  }
  // About how long, in microseconds: for the time left.
  std::uint64_t price(double area) const {
    const double points = std::max(variant.arrangement.points_per_mm2 * area, 1.0 * variant.arrangement.rings * variant.arrangement.meridians);
    const bool is_nearest = variant.search == study::Search::nearest_vertex;
    const bool is_rough = variant.noise.rms_um > 0;
    return static_cast<std::uint64_t>(1e5 + points * (3 * variant.prepare_repeats + (is_rough ? 2 : 1)) + (is_nearest ? 2e6 : static_cast<double>(variant.rays)));
  }
};

std::vector<Pending> pending_of(std::vector<StudyRow>& rows, int thread_count) {
  std::vector<Pending> pending;
  for (StudyRow& row : rows) {
    if (row.is_measured()) continue;
    study::Variant variant = variant_of(*row.settings);
    if (variant.threads == 0) variant.threads = thread_count;
    pending.push_back({&row, variant});
  }
  std::stable_sort(pending.begin(), pending.end(), [](const Pending& a, const Pending& b) { return a.shared() < b.shared(); });
  return pending;
}

// True if what was measured last is written.
bool measure_all(const prescription::StudyFile& study, std::vector<StudyRow>& rows, const fs::path& folder, int thread_count) {
  std::vector<Pending> pending = pending_of(rows, thread_count);
  if (pending.empty()) return save(folder, study, rows);
  study::Subject subject(study.system, study.surface_number, study.field);
  const double area = 3.2 * subject.beam_radius() * subject.beam_radius();
  std::uint64_t total = 0;
  for (const Pending& one : pending) total += one.price(area);
  output::Progress progress("sagitta study " + study.name, total, {.tells_time_left = true});
  bool is_saved = true;
  for (const Pending& one : pending) {
    subject.know_truth(one.variant, thread_count);
    subject.know_rough_cloud(one.variant, thread_count);
    const MeasuredRow measured = measure_apart(subject, one.variant, [&] { progress.advance(0); });
    fill(*one.row, study, measured);
    is_saved = save(folder, study, rows);  // a disk that was full may have room for the next
    progress.advance(one.price(area));
  }
  return is_saved;
}

}  // namespace

int study_command(const StudyOptions& options) {
  const auto study = load_study(options.study);
  if (!study) return 1;
  if (!pictures(command)) return 1;
  const fs::path folder(options.folder);
  if (!make_folder(command, folder)) return 1;

  std::vector<StudyRow> rows = rows_of(*study);
  std::ifstream earlier(folder / "study.csv", std::ios::binary);
  const int kept = take_finished(rows, *study, std::string(std::istreambuf_iterator<char>(earlier), {}));
  if (kept > 0) fmt::print(stderr, "sagitta study: {} of {} rows are kept from an earlier run\n", kept, rows.size());
  bool all_written = measure_all(*study, rows, folder, options.thread_count);

  const std::vector<StudyPlot> plots = plots_of(*study, rows);
  for (const StudyPlot& plot : plots) all_written = write_chart(command, folder / plot.file, plot.chart) && all_written;
  all_written = written(command, output::write_file((folder / "study.md").string(), study_page(*study, rows, plots))) && all_written;

  int failed = 0;
  for (const StudyRow& row : rows) {
    if (!row.has_failed()) continue;
    ++failed;
    fmt::print(stderr, "sagitta study: {}: {}\n", row.name, row.text("failed"));
  }
  fmt::print("{}: {} of {} variants measured, {} of them before; see {}\n", study->title, rows.size() - static_cast<std::size_t>(failed), rows.size(), kept, (folder / "study.md").string());
  return all_written && failed == 0 ? 0 : 1;
}

}  // namespace sagitta::tools
