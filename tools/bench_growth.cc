// SPDX-License-Identifier: Apache-2.0
// The main job's spots on one thread, the double Gauss on the axis at one wavelength, with ever more rays, fields, wavelengths; and,
// by the tracer alone, a stack of ever more conics. Where the cost is linear, a ray takes the same time at a surface all down the table.
#include "tools/bench_growth.h"

#include <benchmark/benchmark.h>
#include <fmt/core.h>

#include <string>
#include <vector>

#include "lib/analysis/job.h"
#include "lib/trace/trace.h"
#include "tools/bench_clock.h"
#include "tools/bench_subject.h"

namespace sagitta::bench {
namespace {

struct Size {
  double rays = 1e5;
  int fields = 1, wavelengths = 1, surfaces = 0;  // surfaces: of the stack; 0: the double Gauss
};

const std::vector<Size>& sizes() {
  static const std::vector<Size> all = [] {
    std::vector<Size> some;
    for (const double rays : {1e3, 1e4, 1e5, 1e6, 1e7, 1e8}) some.push_back({rays});
    for (const int count : {2, 4, 8}) some.push_back({1e5, count});
    for (const int count : {2, 4, 8}) some.push_back({1e5, 1, count});
    for (const int count : {6, 12, 24, 48, 96}) some.push_back({1e5, 1, 1, count});
    return some;
  }();
  return all;
}

std::string name_of(const Size& size) {
  return fmt::format("growth_rays_1e{:.0f}/{}_fields/{}_wavelengths/{}", std::log10(size.rays), size.fields, size.wavelengths,
                     size.surfaces > 0 ? fmt::format("stack_of_{}", size.surfaces) : "double_gauss");
}

scene::Scene scene_of(const Size& size) {
  if (size.surfaces > 0) return corneas("conic", 0, static_cast<std::size_t>(size.surfaces));
  prescription::Model model = read_system("double-gauss.yaml");
  model.fields.points.clear();
  for (int i = 0; i < size.fields; ++i) model.fields.points.push_back({0, 10.0 * i / size.fields});
  model.wavelengths_nm.clear();
  for (int i = 0; i < size.wavelengths; ++i) model.wavelengths_nm.push_back(587.6 + 5 * i);
  return compiled(model);
}

void measure(benchmark::State& state, const Size& size) {
  const scene::Scene scene = scene_of(size);
  analysis::JobRequest request;
  request.want_wavefront = false;
  request.thread_count = 1;
  request.ray_count = static_cast<std::int64_t>(size.rays);
  const trace::RayBatch start = size.surfaces > 0 ? beam(scene, static_cast<std::size_t>(size.rays), false) : trace::RayBatch();
  trace::RayBatch rays;
  std::int64_t launched = 0;
  double seconds = 0;
  for (auto _ : state) {
    launched = 0;
    rays = start;
    const double before = now(1);
    if (size.surfaces > 0) {
      trace::trace(scene, scene.primary, rays);
      launched = static_cast<std::int64_t>(rays.size());
    } else {
      for (const auto& result : analysis::run_job(scene, request)) launched += result.rays.total();
    }
    const double took = now(1) - before;
    state.SetIterationTime(took);
    seconds += took;
  }
  const auto rounds = static_cast<double>(state.iterations());
  state.counters["seconds"] = seconds / rounds;
  state.counters["ns"] = 1e9 * seconds / rounds / (static_cast<double>(launched) * scene.surface_count());
  state.counters["surfaces"] = scene.surface_count();
}

}  // namespace

void register_growth() {
  for (const Size& size : sizes())
    benchmark::RegisterBenchmark(name_of(size).c_str(), [&](benchmark::State& state) { measure(state, size); })
        ->UseManualTime()->Unit(benchmark::kMillisecond);
}

void print_growth(const Medians& medians) {
  std::string rows;
  for (const Size& size : sizes()) {
    const auto of = [&](const char* counter) { return median(medians, name_of(size), counter); };
    if (std::isnan(of("seconds"))) continue;
    rows += fmt::format("{:<8}{:>8}{:>13}{:>10}{:>12.5f}{:>20.2f}\n", fmt::format("1e{:.0f}", std::log10(size.rays)), size.fields,
                        size.wavelengths, of("surfaces"), of("seconds"), of("ns"));
  }
  if (rows.empty()) return;
  fmt::print("\nGrowth: spots of the double Gauss (12 surfaces) by the main job, and the tracer through stacks of conics, one thread, medians\n\n"
             "{:<8}{:>8}{:>13}{:>10}{:>12}{:>20}\n{}", "rays", "fields", "wavelengths", "surfaces", "s", "ns/ray and surface", rows);
}

}  // namespace sagitta::bench
