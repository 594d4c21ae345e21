// SPDX-License-Identifier: Apache-2.0
// Each kernel: 1e6 rays in one batch, with apertures, path and status, through trace::trace.
//
// The double Gauss of 12 spheres is systems/double-gauss.yaml with its two planes bent (R = 1 m) and its stop made the two faces
// of a thin meniscus, so that all of its 12 surfaces refract; its conics are the same with K = -0.1 and 0.1 in turn; its moved
// ones these conics with 10 um of decenter and 0.02 degrees of tilt each. The fraction is of what the divider allows, for the roots and
// divisions of a ray at a surface; where divisions are quick, the ports that multiply and add are the nearer limit, for as many such
// operations, none of them joined (the same bits everywhere). `sagitta explain` counts them. Points lie over just the beam, 4 mm wide. The eye has 7
// surfaces and two gradient-index media, which take nearly all of its time.
#include "tools/bench_kernels.h"

#include <benchmark/benchmark.h>
#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "lib/trace/trace.h"
#include "tools/bench_clock.h"
#include "tools/bench_limit.h"
#include "tools/bench_subject.h"

namespace sagitta::bench {
namespace {

constexpr std::size_t ray_count = 1'000'000;
constexpr double aperture = 40, meniscus = 1, data_radius = 2.05;  // mm

enum class Bend { sphere, conic, moved };

scene::Scene double_gauss(Bend bend) {
  prescription::Model model = read_system("double-gauss.yaml");
  auto& surfaces = model.surfaces;
  const auto stop = std::find_if(surfaces.begin(), surfaces.end(), [](const auto& surface) { return surface.stop; });
  prescription::Surface back = *stop;
  back.stop = false;
  back.thickness_mm -= meniscus;
  stop->thickness_mm = meniscus;
  stop->medium = medium::constant("", 1.5);
  surfaces.insert(stop + 1, back);
  for (std::size_t i = 0; i + 1 < surfaces.size(); ++i) {
    prescription::Surface& surface = surfaces[i];
    surface.semi_diameter_mm = aperture;
    auto& given = surface.shape.parameters;
    if (surface.shape.kind == "plane") given.numbers["radius_mm"] = 1000;
    surface.shape.kind = "conic";
    given.numbers["conic_constant"] = bend == Bend::sphere ? 0 : i % 2 == 0 ? -0.1 : 0.1;
    if (bend != Bend::moved) continue;
    surface.decenter_mm = {0, i % 2 == 0 ? 0.01 : -0.01, 0};
    surface.tilt_deg = {i % 2 == 0 ? 0.02 : -0.02, 0.02, 0};
  }
  scene::Scene scene = compiled(model);
  scene.surfaces.pop_back();  // the image
  return scene;
}

struct Kernel {
  const char* name;
  double asked;  // M ray-surfaces/s
  int root_count, division_count, operation_count;  // of a ray at a surface; 0 where it is no closed form
  std::function<Subject()> make;
};

Subject with_beam(scene::Scene scene, bool is_random) {
  trace::RayBatch rays = beam(scene, ray_count, is_random);
  return {std::move(scene), std::move(rays)};
}

const std::vector<Kernel>& kernels() {
  static const std::vector<Kernel> all{
      {"spheres_12", 280, 2, 1, 79, [] { return with_beam(double_gauss(Bend::sphere), false); }},
      {"conics_12", 210, 2, 2, 94, [] { return with_beam(double_gauss(Bend::conic), false); }},
      {"moved_conics_12", NAN, 2, 2, 127, [] { return with_beam(double_gauss(Bend::moved), false); }},
      {"zernike_36", 40, 0, 0, 0, [] { return with_beam(corneas("zernike", 0, 1), false); }},
      {"linear_4e4/random", 20, 0, 0, 0, [] { return with_beam(corneas("linear", 40'000, 1, data_radius), true); }},
      {"linear_4e4/bundle", 30, 0, 0, 0, [] { return with_beam(corneas("linear", 40'000, 1, data_radius), false); }},
      {"linear_4e6/random", 10, 0, 0, 0, [] { return with_beam(corneas("linear", 4'000'000, 1, data_radius), true); }},
      {"linear_4e6/bundle", 16, 0, 0, 0, [] { return with_beam(corneas("linear", 4'000'000, 1, data_radius), false); }},
      {"gradient_eye_7", NAN, 0, 0, 0, [] { return with_beam(compiled(read_system("liou-brennan-eye.yaml")), false); }},
      {"c1_4e4/random", 10, 0, 0, 0, [] { return with_beam(corneas("c1", 40'000, 1, data_radius), true); }}};
  return all;
}
constexpr std::array<const char*, 3> on_every_set{"spheres_12", "conics_12", "zernike_36"};
struct LesserSet {
  const char* isa;
  int bits;
  double asked;  // of the conics' best
};
constexpr LesserSet lesser_sets[]{{"x86-64-v3", 256, 0.6}, {"x86-64", 128, 0.3}};

const Kernel& kernel_named(const std::string& name) {
  return *std::find_if(kernels().begin(), kernels().end(), [&](const Kernel& kernel) { return kernel.name == name; });
}

std::string benchmark_name(const std::string& kernel, const std::string& how) { return "kernel_" + kernel + "/" + how; }
constexpr const char *one_thread = "one_thread", *two_threads = "two_threads";

struct Times {
  double processor = 0, wall = 0;
};
Times operator-(const Times& a, const Times& b) { return {a.processor - b.processor, a.wall - b.wall}; }

Times times(int thread_count) {
  timespec time{};
  clock_gettime(thread_count == 1 ? CLOCK_THREAD_CPUTIME_ID : CLOCK_PROCESS_CPUTIME_ID, &time);
  return {static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec), now(0)};
}

// None where a ray is lost.
std::optional<Times> traced(const Subject& subject, trace::RayBatch& rays, int thread_count) {
  rays = subject.rays;
  const Times before = times(thread_count);
  trace::trace(subject.scene, subject.scene.primary, rays, thread_count);
  const Times after = times(thread_count);
  if (trace::count_statuses(rays)[surface::Status::ok] != static_cast<std::int64_t>(rays.size())) return std::nullopt;
  return after - before;
}

double ray_surfaces(const Subject& subject) { return static_cast<double>(subject.rays.size() * subject.scene.surfaces.size()); }

void measure(benchmark::State& state, const Kernel& kernel, int thread_count) {
  static std::map<std::string, Subject> made;
  auto found = made.find(kernel.name);
  if (found == made.end()) found = made.emplace(kernel.name, kernel.make()).first;
  trace::RayBatch rays;
  Times total;
  for (auto _ : state) {
    const auto took = traced(found->second, rays, thread_count);
    if (!took) return state.SkipWithError("a ray was lost");
    state.SetIterationTime(took->wall);
    total.processor += took->processor, total.wall += took->wall;
  }
  const double work = ray_surfaces(found->second) * static_cast<double>(state.iterations());
  state.counters["million_per_s"] = 1e-6 * work / total.processor;
  state.counters["million_per_wall_s"] = 1e-6 * work / total.wall;
}

std::string own_file() {
  std::string path(4096, '\0');
  const ssize_t size = readlink("/proc/self/exe", path.data(), path.size());
  path.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
  return path;
}

constexpr const char* kernel_option = "--kernel-process";

void measure_elsewhere(benchmark::State& state, const std::string& kernel, const std::string& isa) {
  for (auto _ : state) {
    std::FILE* pipe = popen(fmt::format("SAGITTA_ISA={} '{}' {} {}", isa, own_file(), kernel_option, kernel).c_str(), "r");
    double rate = 0;
    const bool has_figure = pipe && std::fscanf(pipe, "%lf", &rate) == 1;
    if (!pipe || pclose(pipe) != 0 || !has_figure) return state.SkipWithError("the process for another instruction set failed");
    state.SetIterationTime(1 / rate);
    state.counters["million_per_s"] = rate;
  }
}

double rate(const Medians& medians, const std::string& kernel, const std::string& how) {
  return median(medians, benchmark_name(kernel, how), "million_per_s");
}

// What share of the two limits a rate is, with vectors of `bits`.
struct Shares {
  double of_divider = NAN, of_ports = NAN;
};
Shares shares(const Medians& medians, const Kernel& kernel, double rate, int bits) {
  if (kernel.root_count == 0) return {};
  return {rate / divider_limit(medians, bits, kernel.root_count, kernel.division_count), rate / port_limit(medians, bits, kernel.operation_count)};
}

std::string row(const std::string& what, double value, const Shares& of, const std::string& asked, bool is_met) {
  return fmt::format("{:<40}{:>9}{:>12}{:>12}{:>10}{:>5}\n", what, decimal(value, 2), decimal(of.of_divider, 2), decimal(of.of_ports, 2), asked,
                     asked == "-" || std::isnan(value) ? "-" : is_met ? "yes" : "no");
}

}  // namespace

bool is_kernel_process(int argc, char** argv) { return argc == 3 && std::strcmp(argv[1], kernel_option) == 0; }

int run_kernel_process(char** argv) {
  const Subject subject = kernel_named(argv[2]).make();
  trace::RayBatch rays;
  std::array<double, 7> seconds{};
  for (double& each : seconds) {
    const auto took = traced(subject, rays, 1);
    if (!took) return 1;
    each = took->processor;
  }
  std::sort(seconds.begin(), seconds.end());
  fmt::print("{}\n", 1e-6 * ray_surfaces(subject) / seconds[seconds.size() / 2]);
  return 0;
}

void register_kernels() {
  const auto add = [](const std::string& kernel, const std::string& how, const std::function<void(benchmark::State&)>& take) {
    return benchmark::RegisterBenchmark(benchmark_name(kernel, how).c_str(), take)->UseManualTime()->Unit(benchmark::kMillisecond);
  };
  for (const Kernel& kernel : kernels()) add(kernel.name, one_thread, [&](benchmark::State& state) { measure(state, kernel, 1); });
  add("conics_12", two_threads, [](benchmark::State& state) { measure(state, kernel_named("conics_12"), 2); });
  for (const char* kernel : on_every_set)
    for (const LesserSet& set : lesser_sets)
      add(kernel, set.isa, [=](benchmark::State& state) { measure_elsewhere(state, kernel, set.isa); })->Iterations(1);
}

void print_kernels(const Medians& medians) {
  std::string rows;
  const int widest = std::isnan(divider_limit(medians, 512, 1, 1)) ? 256 : 512;
  for (const Kernel& kernel : kernels()) {
    const double value = rate(medians, kernel.name, one_thread);
    if (std::isnan(value)) continue;
    rows += row(kernel.name, value, shares(medians, kernel, value, widest), std::isnan(kernel.asked) ? "-" : fmt::format(">= {}", kernel.asked), value >= kernel.asked);
  }
  const double conics = rate(medians, "conics_12", one_thread);
  if (!std::isnan(conics)) {
    const double fraction = conics / divider_limit(medians, widest, 2, 2);
    if (!std::isnan(fraction)) rows += row("conics_12, of the divider's limit", fraction, {}, ">= 0.65", fraction >= 0.65);
  }
  for (const char* kernel : on_every_set)
    for (const LesserSet& set : lesser_sets) {
      const double value = rate(medians, kernel, set.isa), share = value / rate(medians, kernel, one_thread);
      if (std::isnan(value)) continue;
      const bool is_asked = std::strcmp(kernel, "conics_12") == 0;
      rows += row(fmt::format("{}, {}", kernel, set.isa), value, shares(medians, kernel_named(kernel), value, set.bits), "-", true);
      rows += row("  over the best instruction set's", share, {}, is_asked ? fmt::format(">= {}", set.asked) : "-", share >= set.asked);
    }
  const auto ratio = [&](const char* what, double value, double most, double least) {
    if (!std::isnan(value)) rows += row(what, value, {}, most > 0 ? fmt::format("<= {}", most) : fmt::format(">= {}", least), most > 0 ? value <= most : value >= least);
  };
  ratio("moved conics: cost over centred ones'", conics / rate(medians, "moved_conics_12", one_thread), 1.3, 0);
  ratio("conics_12, two threads: processor time", conics / rate(medians, "conics_12", two_threads), 1.1, 0);
  const auto wall = [&](const char* how) { return median(medians, benchmark_name("conics_12", how), "million_per_wall_s"); };
  ratio("conics_12, two threads: wall speed-up", wall(two_threads) / wall(one_thread), 0, 1.7);
  if (rows.empty()) return;
  fmt::print("\nKernels on one thread, 1e6 rays, medians of processor time: millions of rays times surfaces per second, as a fraction of\n"
             "what the divider allows and of what the ports for additions and multiplications do (measured in the same run), and what is asked\n\n"
             "{:<40}{:>9}{:>12}{:>12}{:>10}{:>5}\n{}", "kernel", "M/s", "of divider", "of ports", "asked", "met", rows);
}

}  // namespace sagitta::bench
