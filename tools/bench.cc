// SPDX-License-Identifier: Apache-2.0
// Ray-surfaces per second of every shape, by the tracer that all commands use, and their ratios to the conic.
//
// The surface is like a cornea's front (R = 7.72 mm, beam of 4 mm). Plane, conic and Zernike: 65536 rays through eight
// copies of it, 0.5 mm apart, alternately from air into 1.376 and back, so that the tracer's blocks stay in the cache as
// they do in a lens. Facets: 2^20 rays through one surface, so that every ray comes to facets it has not just seen; their
// points are uniformly random over a disc of 8 mm. `bundle` is collimated, in the order of the hexapolar pattern, as a
// trace launches it; `random` has random places and directions up to 3 degrees off the axis, in no order.
#include <benchmark/benchmark.h>
#include <fmt/core.h>

#include <cmath>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <limits>
#include <map>
#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "lib/scene/compile.h"
#include "lib/trace/launch.h"
#include "lib/trace/pattern.h"
#include "lib/trace/trace.h"
#include "tools/bench_preparation.h"

namespace {

using namespace sagitta;

constexpr double radius = 7.72, conic_constant = -0.26, gap = 0.5, beam_radius = 2, data_radius = 4;

class Random {
 public:
  // Uniform over a disc.
  numerics::Vec3<double> in_disc(double disc_radius) {
    const double r = disc_radius * std::sqrt(next()), angle = 2 * std::numbers::pi * next();
    return {r * std::cos(angle), r * std::sin(angle), 0};
  }

 private:
  double next() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }
  std::mt19937_64 engine_{20240607};
};

prescription::Shape shape_of(const std::string& kind, int point_count) {
  prescription::Shape shape;
  shape.kind = point_count > 0 ? "delaunay" : kind;
  auto& given = shape.parameters;
  given.numbers = {{"radius_mm", radius}, {"conic_constant", conic_constant}, {"normalization_radius_mm", 3},
                   {"smoothing_um", 0}, {"max_edge_mm", std::numeric_limits<double>::infinity()}};
  given.texts = {{"indexing", "osa"}, {"interpolation", kind}};
  // 36 terms of OSA, of the size of a cornea's: falling with the order, signs in turn.
  for (int index = 0; index < 36; ++index) {
    const int order = numerics::osa_term(index).n;
    given.indexed["coefficients_um"].push_back({index, order < 2 ? 0 : (index % 2 == 0 ? 1 : -1) * 2.0 / std::pow(order, 3)});
  }
  if (point_count == 0) return shape;
  auto cloud = std::make_shared<prescription::PointCloud>();
  Random random;
  const surface::Conic cornea{1 / radius, conic_constant};
  for (int i = 0; i < point_count; ++i) {
    auto point = random.in_disc(data_radius);
    point.z = cornea.sag(point.x, point.y);
    cloud->points.push_back(point);
  }
  cloud->lines.resize(cloud->points.size());
  shape.cloud = std::move(cloud);
  return shape;
}

scene::Scene make_scene(const std::string& kind, int point_count, std::size_t copies) {
  prescription::Model model;
  model.wavelengths_nm = {550};
  model.aperture.value = 2 * beam_radius;
  prescription::Surface first;
  first.shape = shape_of(kind, point_count);
  first.stop = true;
  first.medium = medium::constant("", 1.376);
  model.surfaces = {first, {}};
  model.surfaces.back().medium = medium::air();
  const auto compiled = scene::compile(model);
  if (!compiled.scene) {
    for (const auto& finding : compiled.findings.all()) fmt::print(stderr, "{}\n", prescription::format(finding));
    std::exit(1);
  }
  scene::Scene scene = *compiled.scene;
  const scene::Surface surface = scene.surface(1);
  scene.surfaces.assign(copies, surface);
  for (std::size_t i = 1; i < copies; ++i) scene.surfaces[i].local_from_previous.translation.z = -gap;
  scene.primary.index.clear();
  for (std::size_t i = 0; i <= copies; ++i) scene.primary.index.push_back(i % 2 == 0 ? 1 : 1.376);
  return scene;
}

trace::RayBatch make_rays(const scene::Scene& scene, std::size_t ray_count, bool are_random) {
  auto pupil = trace::pupil_points({}, static_cast<std::int64_t>(ray_count));
  pupil.resize(ray_count);
  trace::RayBatch rays = trace::launch(scene, scene.fields.front(), 1, pupil);
  Random random;
  for (std::size_t i = 0; are_random && i < ray_count; ++i) {
    const auto position = random.in_disc(beam_radius);
    auto direction = random.in_disc(std::sin(3 * std::numbers::pi / 180));
    direction.z = std::sqrt(1 - dot(direction, direction));
    rays.set(i, position, direction, 0);
  }
  return rays;
}

// Seconds: of the processor for one thread, so that other work on the machine counts less; of the clock for several.
double now(int thread_count) {
  timespec time{};
  clock_gettime(thread_count == 1 ? CLOCK_THREAD_CPUTIME_ID : CLOCK_MONOTONIC, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

void measure(benchmark::State& state, const std::string& kind, int point_count, bool are_random, int thread_count) {
  const std::size_t copies = point_count > 0 ? 1 : 8, ray_count = point_count > 0 ? 1u << 20 : 1u << 16;
  const scene::Scene scene = make_scene(kind, point_count, copies);
  const trace::RayBatch start = make_rays(scene, ray_count, are_random);
  trace::RayBatch rays = start;
  for (auto _ : state) {
    rays = start;
    const double before = now(thread_count);
    trace::trace(scene, scene.primary, rays, thread_count);
    state.SetIterationTime(now(thread_count) - before);
  }
  if (trace::count_statuses(rays)[surface::Status::ok] != static_cast<std::int64_t>(ray_count)) return state.SkipWithError("a ray was lost");
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(copies * ray_count));
}

struct Case {
  const char* name;
  const char* kind;
  int point_count;
  bool are_random;
};
constexpr Case cases[]{{"plane", "plane", 0, false},
                       {"conic", "conic", 0, false},
                       {"zernike_36", "zernike", 0, false},
                       {"linear_4e3/bundle", "linear", 4'000, false},
                       {"linear_4e3/random", "linear", 4'000, true},
                       {"linear_4e4/bundle", "linear", 40'000, false},
                       {"linear_4e4/random", "linear", 40'000, true},
                       {"linear_4e5/bundle", "linear", 400'000, false},
                       {"linear_4e5/random", "linear", 400'000, true},
                       {"c1_4e4/bundle", "c1", 40'000, false},
                       {"c1_4e4/random", "c1", 40'000, true}};
constexpr const char *one_thread = "/one_thread", *all_threads = "/all_threads";

// The usual console, and the medians of all rates.
class MedianKeeper : public benchmark::ConsoleReporter {
 public:
  MedianKeeper() : ConsoleReporter(OO_None) {}  // no colours: it is read from files too
  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs)
      if (run.aggregate_name == "median" && !run.error_occurred) {
        const auto rate = run.counters.find("items_per_second");
        if (rate != run.counters.end()) medians[run.run_name.function_name] = rate->second;
      }
    ConsoleReporter::ReportRuns(runs);
  }
  std::map<std::string, double> medians;
};

void print_ratios(const std::map<std::string, double>& medians) {
  const auto rate = [&](const std::string& name) {
    const auto found = medians.find(name);
    return found == medians.end() ? std::numeric_limits<double>::quiet_NaN() : found->second;
  };
  fmt::print("\nMillions of ray-surfaces per second, medians; ratio to the conic on one thread\n\n{:<22}{:>12}{:>8}{:>14}{:>8}\n", "shape",
             "one thread", "ratio", "all threads", "ratio");
  const double conic = rate(std::string("conic") + one_thread);
  for (const Case& c : cases) {
    const double one = rate(std::string(c.name) + one_thread), all = rate(std::string(c.name) + all_threads);
    fmt::print("{:<22}{:>12.2f}{:>8.3f}{:>14.2f}{:>8.3f}\n", c.name, one / 1e6, one / conic, all / 1e6, all / conic);
  }
}

std::string processor() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);)
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  return "unknown processor";
}

}  // namespace

int main(int argc, char** argv) {
  for (const Case& c : cases)
    for (const bool all : {false, true})
      benchmark::RegisterBenchmark((std::string(c.name) + (all ? all_threads : one_thread)).c_str(), [c, all](benchmark::State& state) {
        measure(state, c.kind, c.point_count, c.are_random, all ? 0 : 1);
      })->UseManualTime()->Unit(benchmark::kMillisecond);
  bench::register_preparation();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  fmt::print(stderr, "{}; compiler {}\n", processor(), __VERSION__);
  MedianKeeper keeper;
  benchmark::RunSpecifiedBenchmarks(&keeper);
  print_ratios(keeper.medians);
  return 0;
}
