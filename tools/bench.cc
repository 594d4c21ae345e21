// SPDX-License-Identifier: Apache-2.0
// Ray-surfaces per second of every shape, by the tracer that all commands use, and their ratios to the conic.
//
// The surface is like a cornea's front (R = 7.72 mm, beam of 4 mm). Plane, conic, asphere and the like: 65536 rays through eight
// copies of it, 0.5 mm apart, alternately from air into 1.376 and back, so that the tracer's blocks stay in the cache as
// they do in a lens. Facets: 2^20 rays through one surface, so that every ray comes to facets it has not just seen; their
// points are uniformly random over a disc of 8 mm. `bundle` is collimated, in the order of the hexapolar pattern, as a
// trace launches it; `random` has random places and directions up to 3 degrees off the axis, in no order.
//
// Embree, where the build has found it, is given the same facets and rays (bench_embree.h).
#include <benchmark/benchmark.h>
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "lib/trace/trace.h"
#include "tools/bench_clock.h"
#include "tools/bench_embree.h"
#include "tools/bench_growth.h"
#include "tools/bench_jobs.h"
#include "tools/bench_kernels.h"
#include "tools/bench_limit.h"
#include "tools/bench_preparation.h"
#include "tools/bench_startup.h"
#include "tools/bench_stability.h"
#include "tools/bench_subject.h"

namespace {

using namespace sagitta;
using bench::Medians, bench::median, bench::decimal, bench::now, bench::Subject;

// Made once for all repetitions and calls.
const Subject& subject(const std::string& kind, int point_count, bool are_random) {
  static std::map<std::string, Subject> made;
  const std::string name = fmt::format("{} {} {}", kind, point_count, are_random);
  const auto found = made.find(name);
  if (found != made.end()) return found->second;
  scene::Scene scene = bench::corneas(kind, point_count, point_count > 0 ? 1 : 8);
  trace::RayBatch rays = bench::beam(scene, point_count > 0 ? 1u << 20 : 1u << 16, are_random);
  return made.emplace(name, Subject{std::move(scene), std::move(rays)}).first->second;
}

void measure(benchmark::State& state, const std::string& kind, int point_count, bool are_random, int thread_count) {
  const auto& [scene, start] = subject(kind, point_count, are_random);
  trace::RayBatch rays = start;
  for (auto _ : state) {
    rays = start;
    const double before = now(thread_count);
    trace::trace(scene, scene.primary, rays, thread_count);
    state.SetIterationTime(now(thread_count) - before);
  }
  const auto ray_count = static_cast<std::int64_t>(start.size());
  if (trace::count_statuses(rays)[surface::Status::ok] != ray_count) return state.SkipWithError("a ray was lost");
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(scene.surfaces.size()) * ray_count);
}

void measure_embree(benchmark::State& state, int point_count, bool are_random, const std::string& call) {
  const auto& [scene, start] = subject("linear", point_count, are_random);
  const auto rays = bench::embree_rays(*std::get<surface::Facets>(scene.surface(1).shape).mesh, start, call);
  for (auto _ : state) {
    rays->forget_hits();
    const double before = now(1);
    rays->run();
    state.SetIterationTime(now(1) - before);
  }
  // All of ours hit; in single precision, and without the robust mode, a ray may slip between two triangles.
  const std::int64_t lost = static_cast<std::int64_t>(start.size()) - rays->hits();
  if (lost > 10) return state.SkipWithError("Embree does not hit what the tracer hits");
  state.counters["lost"] = static_cast<double>(lost);
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(start.size()));
}

struct Case {
  const char* name;
  const char* kind;
  int point_count;
  bool are_random;
};
constexpr Case cases[]{{"plane", "plane", 0, false},
                       {"conic", "conic", 0, false},
                       {"asphere_5", "asphere", 0, false},
                       {"biconic", "biconic", 0, false},
                       {"toroid_5", "toroid", 0, false},
                       {"xy_polynomial_27", "xy_polynomial", 0, false},
                       {"zernike_36", "zernike", 0, false},
                       {"grid_4e4/bundle", "grid", 0, false},
                       {"grid_4e4/random", "grid", 0, true},
                       {"linear_4e3/bundle", "linear", 4'000, false},
                       {"linear_4e3/random", "linear", 4'000, true},
                       {"linear_4e4/bundle", "linear", 40'000, false},
                       {"linear_4e4/random", "linear", 40'000, true},
                       {"linear_4e5/bundle", "linear", 400'000, false},
                       {"linear_4e5/random", "linear", 400'000, true},
                       {"c1_4e3/bundle", "c1", 4'000, false},
                       {"c1_4e3/random", "c1", 4'000, true},
                       {"c1_4e4/bundle", "c1", 40'000, false},
                       {"c1_4e4/random", "c1", 40'000, true},
                       {"c1_4e5/bundle", "c1", 400'000, false},
                       {"c1_4e5/random", "c1", 400'000, true},
                       {"linear_1e3/random", "linear", 1'000, true},
                       {"linear_1e5/random", "linear", 100'000, true},
                       {"linear_1e7/random", "linear", 10'000'000, true}};
constexpr const char *one_thread = "/one_thread", *all_threads = "/all_threads";

// The usual console, and the medians of all figures.
class MedianKeeper : public benchmark::ConsoleReporter {
 public:
  MedianKeeper() : ConsoleReporter(OO_None) {}  // no colours: it is read from files too
  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs)
      if (run.aggregate_name == "median" && !run.error_occurred)
        for (const auto& [counter, value] : run.counters) medians[run.run_name.function_name][counter] = value;
    ConsoleReporter::ReportRuns(runs);
  }
  Medians medians;
};

double million_per_second(const Medians& medians, const std::string& name) { return median(medians, name, "items_per_second") / 1e6; }

void print_shapes(const Medians& medians) {
  const double conic = million_per_second(medians, std::string("conic") + one_thread);
  std::string rows;
  for (const Case& c : cases) {
    const double one = million_per_second(medians, std::string(c.name) + one_thread);
    const double all = million_per_second(medians, std::string(c.name) + all_threads);
    if (std::isnan(one) && std::isnan(all)) continue;
    rows += fmt::format("{:<20}{:>12}{:>10}{:>14}{:>10}\n", c.name, decimal(one, 2), decimal(one / conic, 3), decimal(all, 2),
                        decimal(all / conic, 3));
  }
  if (rows.empty()) return;
  fmt::print("\nMillions of rays times surfaces per second, medians; ratio to the conic on one thread\n\n{:<20}{:>12}{:>10}{:>14}{:>10}\n{}",
             "shape", "one thread", "ratio", "all threads", "ratio", rows);
}

struct Beside {
  const char* points;
  int point_count;
};
constexpr Beside beside_embree[]{{"4e3", 4'000}, {"4e4", 40'000}, {"4e5", 400'000}};
std::vector<std::string> calls_for(bool are_random) {
  auto calls = bench::embree_calls();
  if (are_random && calls.size() > 1) calls.resize(1);
  return calls;
}
std::string embree_name(const char* points, bool are_random, const std::string& call) {
  return fmt::format("embree_{}/{}/{}", points, are_random ? "random" : "bundle", call);
}

void print_beside_embree(const Medians& medians) {
  std::string rows;
  for (const bool are_random : {true, false})
    for (const auto& [points, point_count] : beside_embree) {
      const auto ours = [&, p = points](const char* kind) {
        return million_per_second(medians, fmt::format("{}_{}/{}{}", kind, p, are_random ? "random" : "bundle", one_thread));
      };
      const double linear = ours("linear"), c1 = ours("c1");
      if (std::isnan(linear)) continue;
      double best = std::numeric_limits<double>::quiet_NaN();
      std::string best_call = "-";
      for (const std::string& call : calls_for(are_random)) {
        const double rate = million_per_second(medians, embree_name(points, are_random, call));
        if (!(rate <= best) && !std::isnan(rate)) best = rate, best_call = call;
      }
      rows += fmt::format("{:<8}{:<8}{:>8}{:>8}{:>11}{:>9}  {:<16}{:>13}{:>11}\n", points, are_random ? "random" : "bundle",
                          decimal(linear, 2), decimal(c1, 2), decimal(c1 / linear, 2), decimal(best, 2), best_call, decimal(linear / best, 2),
                          decimal(c1 / best, 2));
    }
  if (rows.empty()) return;
  const std::string version = bench::embree_version();
  fmt::print("\nThe same points and rays, one thread, millions of rays per second, medians. Sagitta's linear and c1: in double\n"
             "precision, all that a surface does with a ray: hit, refraction, path, status. Embree: in single precision, the hit\n"
             "alone, from rays that lie ready in its own layout; of its calls the fastest. {}\n\n"
             "{:<8}{:<8}{:>8}{:>8}{:>11}{:>9}  {:<16}{:>13}{:>11}\n{}",
             version.empty() ? "Skipped: the build has found no Embree." : "This is " + version + ".", "points", "rays", "linear", "c1",
             "c1/linear", "Embree", "by", "linear/Embree", "c1/Embree", rows);
}

std::string processor() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);)
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  return "unknown processor";
}

}  // namespace

int main(int argc, char** argv) {
  if (bench::is_kernel_process(argc, argv)) return bench::run_kernel_process(argv);
  for (const Case& c : cases)
    for (const bool all : {false, true})
      benchmark::RegisterBenchmark((std::string(c.name) + (all ? all_threads : one_thread)).c_str(), [c, all](benchmark::State& state) {
        measure(state, c.kind, c.point_count, c.are_random, all ? 0 : 1);
      })->UseManualTime()->Unit(benchmark::kMillisecond);
  for (const auto& [points, point_count] : beside_embree)
    for (const bool are_random : {true, false})
      for (const std::string& call : calls_for(are_random))
        benchmark::RegisterBenchmark(embree_name(points, are_random, call).c_str(), [=, count = point_count](benchmark::State& state) {
          measure_embree(state, count, are_random, call);
        })->UseManualTime()->Unit(benchmark::kMillisecond);
  bench::register_preparation();
  bench::register_startup();
  bench::register_limit();
  bench::register_stability();
  bench::register_kernels();
  bench::register_jobs();
  bench::register_growth();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  fmt::print(stderr, "{}; compiler {}\n", processor(), __VERSION__);
  MedianKeeper keeper;
  benchmark::RunSpecifiedBenchmarks(&keeper);
  print_shapes(keeper.medians);
  print_beside_embree(keeper.medians);
  bench::print_preparation(keeper.medians);
  bench::print_startup(keeper.medians);
  bench::print_limit(keeper.medians);
  bench::print_stability(keeper.medians);
  bench::print_kernels(keeper.medians);
  bench::print_jobs(keeper.medians);
  bench::print_growth(keeper.medians);
  return 0;
}
