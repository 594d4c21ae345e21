// SPDX-License-Identifier: Apache-2.0
// The program as a user runs it, `sagitta trace` of the Navarro eye, 1e6 rays a field and wavelength, in a process of its own;
// and, so that one sees where its time goes, the same steps by the library, one after another on one thread.
#include "tools/bench_jobs.h"

#include <benchmark/benchmark.h>
#include <fmt/core.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "lib/analysis/job.h"
#include "lib/output/atomic_file.h"
#include "lib/output/raster.h"
#include "lib/output/report.h"
#include "lib/prescription/search_path.h"
#include "lib/scene/compile.h"
#include "lib/trace/launch.h"
#include "lib/trace/trace.h"
#include "tools/bench_clock.h"
#include "tools/bench_program.h"
#include "tools/bench_subject.h"

namespace sagitta::bench {
namespace {

constexpr const char* system_file = "navarro-eye.yaml";
constexpr std::int64_t ray_count = 1'000'000;

class Folder {
 public:
  Folder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "sagitta-bench-XXXXXX").string();
    path_ = mkdtemp(pattern.data());
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

void measure_program(benchmark::State& state, int thread_count) {
  const std::string system = prescription::find_file(std::string("systems/") + system_file, ".").value_or("");
  Run total;
  double bytes = 0, writing = 0;
  for (auto _ : state) {
    const Folder folder;
    std::vector<std::string> arguments{"trace", system, "-o", folder.path().string(), "--rays", std::to_string(ray_count)};
    if (thread_count > 0) arguments.insert(arguments.end(), {"--threads", std::to_string(thread_count)});
    const auto run = run_program(std::move(arguments));
    if (!run) return state.SkipWithError("the program failed");
    state.SetIterationTime(run->wall);
    total.processor += run->processor, total.wall += run->wall;
    for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
      std::ifstream stream(entry.path(), std::ios::binary);
      const std::string text{std::istreambuf_iterator<char>(stream), {}};
      bytes += static_cast<double>(text.size());
      const double before = now(0);
      if (!output::write_file(entry.path().string() + ".again", text).ok()) return state.SkipWithError("a file could not be written");
      writing += now(0) - before;
    }
  }
  const auto rounds = static_cast<double>(state.iterations());
  state.counters["processor_s"] = total.processor / rounds;
  state.counters["wall_s"] = total.wall / rounds;
  state.counters["bytes"] = bytes / rounds;
  state.counters["writing_s"] = writing / rounds;
}

output::Report report_of(const prescription::Model& model, const scene::CompileResult& compiled) {
  output::Report report;
  report.system = model.name;
  for (const auto& field : model.fields.points) report.fields.push_back({field.x, field.y});
  report.wavelengths_nm = model.wavelengths_nm;
  report.surface_names.resize(model.surfaces.size());
  report.first_order = compiled.first_order;
  return report;
}

// Seconds of each part.
class Stopwatch {
 public:
  void lap(const char* part) {
    const double time = now(1);
    seconds_[part] += time - last_;
    last_ = time;
  }
  void add(const char* part, double seconds) { seconds_[part] += seconds; }
  void skip() { last_ = now(1); }
  const std::map<std::string, double>& seconds() const { return seconds_; }

 private:
  std::map<std::string, double> seconds_;
  double last_ = now(1);
};

bool run_parts(Stopwatch& watch) {
  const prescription::Model model = read_system(system_file);
  const scene::CompileResult compiled = scene::compile(model, analysis::beam_of_job());
  const scene::Scene& scene = *compiled.scene;
  const std::string system = prescription::find_file(std::string("systems/") + system_file, ".").value_or("");
  const auto start = run_program({"check", system});
  if (!start) return false;
  watch.add("start", start->processor);

  analysis::JobRequest request;
  request.thread_count = 1;
  request.ray_count = ray_count;
  output::Report report = report_of(model, compiled);
  report.results = analysis::run_job(scene, request);  // the parts below are for the time alone
  watch.skip();
  trace::PupilStream stream({}, ray_count);
  std::vector<analysis::SpotCollector> collectors;
  for (const auto& result : report.results)
    collectors.emplace_back(analysis::SpotImage(request.spot_image_size, result.spot_image->pixel_mm, result.spot_image->centre_x, result.spot_image->centre_y));
  for (std::vector<trace::PupilPoint> pupil; !(pupil = stream.next(1 << 13)).empty();)
    for (std::size_t i = 0; i < report.results.size(); ++i) {
      const scene::Wavelength& wavelength = scene.wavelengths[report.results[i].wavelength];
      trace::RayBatch rays = launch(scene, scene.fields[report.results[i].field], wavelength, pupil);
      watch.lap("launch");
      trace::trace(scene, wavelength, rays, 1);
      watch.lap("trace");
      collectors[i].add(rays);
      watch.lap("spots");
    }
  analysis::ZernikeFitter fitter(request.wavefront.indexing, request.wavefront.zernike_terms);
  for (const auto& result : report.results)
    benchmark::DoNotOptimize(analysis::wavefront(scene, scene.wavelengths[result.wavelength], scene.fields[result.field], request.wavefront, fitter));
  watch.lap("wavefronts");
  const Folder folder;
  for (const bool is_spot : {true, false}) {
    auto exr = is_spot ? spot_parts(report) : wavefront_parts(report);
    const output::Raster picture = output::render(is_spot ? spot_figure(report) : wavefront_figure(report));
    watch.lap("pictures");
    exr.insert(exr.begin(), output::preview_part(picture));
    const std::string base = (folder.path() / (is_spot ? "spot" : "wavefront")).string();
    if (!output::write_exr(base + ".exr", exr).ok() || !output::write_png(base + ".png", picture).ok()) return false;
    watch.lap("encoding");
  }
  return true;
}

void measure_parts(benchmark::State& state) {
  std::map<std::string, double> total;
  for (auto _ : state) {
    Stopwatch watch;
    if (!run_parts(watch)) return state.SkipWithError("a part failed");
    double sum = 0;
    for (const auto& [part, seconds] : watch.seconds()) total[part] += seconds, sum += seconds;
    state.SetIterationTime(sum);
  }
  for (const auto& [part, seconds] : total) state.counters[part] = seconds / static_cast<double>(state.iterations());
}

constexpr const char *one_thread = "job_navarro/one_thread", *all_threads = "job_navarro/all_threads", *in_parts = "job_navarro/in_parts";

}  // namespace

void register_jobs() {
  const auto add = [](const char* name, auto take) { benchmark::RegisterBenchmark(name, take)->UseManualTime()->Unit(benchmark::kMillisecond)->Iterations(1); };
  add(one_thread, [](benchmark::State& state) { measure_program(state, 1); });
  add(all_threads, [](benchmark::State& state) { measure_program(state, 0); });
  add(in_parts, [](benchmark::State& state) { measure_parts(state); });
}

void print_jobs(const Medians& medians) {
  const auto part = [&](const char* name) { return median(medians, in_parts, name); };
  const auto one = [&](const char* name) { return median(medians, one_thread, name); };
  const auto all = [&](const char* name) { return median(medians, all_threads, name); };
  std::string rows;
  const auto row = [&](const char* what, double seconds) {
    if (!std::isnan(seconds)) rows += fmt::format("{:<52}{:>9.3f}\n", what, seconds);
  };
  row("start, reading, compiling (sagitta check)", part("start"));
  row("pupil points and launch", part("launch"));
  row("tracing", part("trace"));
  row("collecting spots", part("spots"));
  row("wavefronts and their Zernike fits", part("wavefronts"));
  row("drawing the pictures", part("pictures"));
  row("encoding EXR and PNG, writing them", part("encoding"));
  rows += "\n";
  row("the program, one thread: processor", one("processor_s"));
  row("the program, one thread: wall", one("wall_s"));
  row("the program, all threads: processor", all("processor_s"));
  row("the program, all threads: wall", all("wall_s"));
  row("writing the same bytes again", one("writing_s"));
  if (rows == "\n") return;
  fmt::print("\nA whole job: sagitta trace of the Navarro eye, 3 fields, 3 wavelengths, 1e6 rays each; seconds, medians. Above, where\n"
             "the time goes, by the library on one thread (processor); below, the program in a process of its own\n\n{}", rows);
  const double least = part("launch") + part("trace") + one("writing_s"), ratio = one("processor_s") / least;
  if (!std::isnan(ratio))
    fmt::print("The program on one thread takes {:.2f} times launch, tracing and {:.2f} MB of writing; asked: <= 1.5: {}\n", ratio,
               one("bytes") * 1e-6, ratio <= 1.5 ? "yes" : "no");
}

}  // namespace sagitta::bench
