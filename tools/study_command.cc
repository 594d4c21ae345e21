// SPDX-License-Identifier: Apache-2.0
// sagitta study NAME_OR_FILE -o DIR: error against run time, variant by variant; with --system, of one system as it is.
#include <fmt/format.h>

#include <fstream>
#include <iterator>
#include <utility>

#include "lib/output/atomic_file.h"
#include "lib/output/progress.h"
#include "lib/prescription/study_reader.h"
#include "tools/commands.h"
#include "tools/load.h"
#include "tools/solve_fields.h"
#include "tools/pictures.h"
#include "tools/study_page.h"
#include "tools/study_plan.h"
#include "tools/study_run.h"
#include "tools/study_system.h"
#include "tools/version.h"
#include "tools/write.h"

namespace sagitta::tools {
namespace {

namespace fs = std::filesystem;
constexpr const char* command = "study";

std::optional<prescription::StudyFile> load_study(const std::string& name, const std::string& folder) {
  const auto file = prescription::find_study(name);
  if (!file) {
    const std::vector<std::string> names = prescription::study_names();
    const std::string meant = prescription::nearest_name(name, names);
    fmt::print(stderr, "sagitta study: there is no study '{}'\n  hint: {}\n", prescription::excerpt(name),
               meant.empty() ? fmt::format("give a file, or one of {}", fmt::join(names, ", ")) : fmt::format("did you mean '{}'?", meant));
    return std::nullopt;
  }
  if (is_of_the_other_kind(*file, "sagitta", "this is a system, not a study", fmt::format("give it with --system: sagitta study --system {} -o {}", *file, folder))) return std::nullopt;
  prescription::StudyReadResult read = prescription::read_study(*file);
  if (!report(read.findings) || !report(solve_fields(read.study->system))) return std::nullopt;
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

std::string text_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

void would_be_lost(const fs::path& file) {
  fmt::print(stderr, "sagitta study: {} is of another kind of study, and would be lost\n  hint: give another folder, or move it away\n", file.string());
}

// How many rows are taken from an earlier run; none, after saying so, where what is there would be lost.
std::optional<int> take_earlier(std::vector<StudyRow>& rows, const prescription::StudyFile& study, const fs::path& file) {
  std::error_code failure;
  if (!fs::exists(file, failure)) return 0;
  Finished finished{0, 0, true};
  if (fs::is_regular_file(file, failure)) finished = take_finished(rows, study, text_of(file));
  if (finished.is_unreadable) {
    would_be_lost(file);
    return std::nullopt;
  }
  if (finished.taken > 0) fmt::print(stderr, "sagitta study: {} of {} rows are kept from an earlier run\n", finished.taken, rows.size());
  if (finished.others > 0) fmt::print(stderr, "sagitta study: {} rows of an earlier run are left out: they failed, or are of other settings\n", finished.others);
  return finished.taken;
}

// True if what was measured last is written.
bool measure_all(const prescription::StudyFile& study, std::vector<StudyRow>& rows, const fs::path& folder, int thread_count) {
  const std::vector<PlannedVariant> planned = plan_of(study, rows, thread_count);
  if (planned.empty()) return save(folder, study, rows);
  const auto steps = [](double seconds) { return static_cast<std::uint64_t>(1e6 * seconds); };
  double seconds = 0;
  for (const PlannedVariant& one : planned) seconds += one.seconds;
  fmt::print(stderr, "sagitta study: {} variant{} to measure, about {}\n", planned.size(), planned.size() == 1 ? "" : "s", output::duration_in_words(seconds));
  output::Progress progress("sagitta study " + study.name, steps(seconds), {.tells_time_left = true});
  CurrentSubject subjects(study);
  bool is_saved = true;
  for (const PlannedVariant& one : planned) {
    study::Subject& subject = subjects.of(one);
    subject.know_truth(one.variant, thread_count);
    subject.know_rough_cloud(one.variant, thread_count);
    const MeasuredRow measured = measure_apart(subject, one.variant, [&] { progress.advance(0); });
    fill(*one.row, study, measured);
    is_saved = save(folder, study, rows);  // a disk that was full may have room for the next
    progress.advance(steps(one.seconds));
  }
  return is_saved;
}

}  // namespace

int study_command(const StudyOptions& options) {
  if (!options.system.empty()) {
    const fs::path file = fs::path(options.folder) / "study.csv";
    if (std::error_code failure; !fs::is_regular_file(file, failure) || !output::rows_of_csv(text_of(file), study_columns())) return study_system(options);
    would_be_lost(file);
    return 1;
  }
  const auto study = load_study(options.study, options.folder);
  if (!study) return 1;
  if (!pictures(command)) return 1;
  const fs::path folder(options.folder);
  if (!make_folder(command, folder)) return 1;

  std::vector<StudyRow> rows = rows_of(*study, options.thread_count);
  const auto kept = take_earlier(rows, *study, folder / "study.csv");
  if (!kept) return 1;
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
  fmt::print("{}: {} of {} variants measured, {} of them before; {} {}\n", study->title, rows.size() - static_cast<std::size_t>(failed), rows.size(), *kept,
             all_written ? "see" : "not all is written in", all_written ? (folder / "study.md").string() : folder.string());
  return all_written && failed == 0 ? 0 : 1;
}

}  // namespace sagitta::tools
