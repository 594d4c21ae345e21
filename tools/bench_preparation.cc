// SPDX-License-Identifier: Apache-2.0
// Seconds of preparing a point cloud for tracing, of which the Delaunay triangulation is the part that no other program
// escapes: the whole (repeated points, trimming, mesh, patches of c1) is given as a multiple of it.
//
// Each is measured in a process of its own, as a user's command has it: in one that did the same before, some of what it
// needs would be warm memory that it had before, and mostly the triangulation's.
//
// The points lie over a square, in random places and random order, or on a regular grid, row by row; the heights are a cornea's.
#include "tools/bench_preparation.h"

#include <benchmark/benchmark.h>
#include <fmt/core.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <string>

#include "lib/scene/delaunay.h"
#include "lib/scene/fit_patches.h"
#include "lib/scene/triangulate.h"
#include "lib/surface/conic.h"
#include "tools/bench_clock.h"

namespace sagitta::bench {
namespace {

prescription::PointCloud cloud_of(int side, bool is_regular) {
  constexpr double half = 4;
  std::mt19937_64 engine(20240607);
  const auto random = [&] { return half * (static_cast<double>(engine() >> 11) * 0x1p-52 - 1); };
  const surface::Conic cornea{1 / 7.72, -0.26};
  prescription::PointCloud cloud;
  for (int j = 0; j < side; ++j)
    for (int i = 0; i < side; ++i) {
      const double x = is_regular ? half * (2.0 * i / (side - 1) - 1) : random(), y = is_regular ? half * (2.0 * j / (side - 1) - 1) : random();
      cloud.points.push_back({x, y, cornea.sag(x, y)});
    }
  return cloud;
}

// What work() returns, which it does in a new process; NaNs where that fails.
template <class Work>
auto in_a_process_of_its_own(const Work& work) {
  decltype(work()) result;
  result.fill(std::numeric_limits<double>::quiet_NaN());
  int ends[2];
  if (pipe(ends) != 0) return result;
  const pid_t child = fork();
  if (child == 0) {
    const auto made = work();
    _exit(write(ends[1], made.data(), sizeof made) == sizeof made ? 0 : 1);
  }
  close(ends[1]);
  if (child > 0) {
    auto made = result;
    if (read(ends[0], made.data(), sizeof made) == sizeof made) result = made;
    waitpid(child, nullptr, 0);
  }
  close(ends[0]);
  return result;
}

std::array<double, 1> triangulated(const prescription::PointCloud& cloud, int thread_count) {
  const double begin = now(thread_count);
  std::vector<numerics::Vec3<double>> points;
  points.reserve(cloud.points.size());
  for (const std::uint32_t i : scene::along_curve(cloud.points)) points.push_back(cloud.points[i]);
  benchmark::DoNotOptimize(scene::delaunay(points).data());
  return {now(thread_count) - begin};
}
std::array<double, 2> prepared(const prescription::PointCloud& cloud, int thread_count) {  // mesh; patches
  const double begin = now(thread_count);
  const auto mesh = scene::triangulate(cloud).mesh;
  const double made = now(thread_count);
  benchmark::DoNotOptimize(scene::fit_patches(mesh->mesh, thread_count).patches.data());
  return {made - begin, now(thread_count) - made};
}

void measure(benchmark::State& state, int side, bool is_regular, int thread_count) {
  const prescription::PointCloud cloud = cloud_of(side, is_regular);
  // Once untimed: a virtual machine gives memory back that was free for a while, and takes long to get it again.
  in_a_process_of_its_own([&] { return prepared(cloud, thread_count); });
  double delaunay = 0, mesh = 0, patches = 0;
  for (auto _ : state) {
    const auto [triangulating] = in_a_process_of_its_own([&] { return triangulated(cloud, thread_count); });
    const auto [making, fitting] = in_a_process_of_its_own([&] { return prepared(cloud, thread_count); });
    state.SetIterationTime(making + fitting);
    delaunay += triangulating;
    mesh += making;
    patches += fitting;
  }
  const auto rounds = static_cast<double>(state.iterations());
  state.counters["delaunay_s"] = delaunay / rounds;
  state.counters["mesh_s"] = mesh / rounds;  // the triangulation in it
  state.counters["c1_s"] = patches / rounds;
  state.counters["whole_per_delaunay"] = (mesh + patches) / delaunay;
}

std::string name_of(int side, bool is_regular, int thread_count) {
  return std::string("preparation_") + (side == 1000 ? "1e6" : "1e5") + (is_regular ? "/regular" : "/random") +
         (thread_count == 1 ? "/one_thread" : "/all_threads");
}

template <class Take>
void for_each(const Take& take) {
  for (const int side : {316, 1000})
    for (const bool is_regular : {false, true})
      for (const int thread_count : {1, 0}) take(side, is_regular, thread_count);
}

}  // namespace

void register_preparation() {
  for_each([](int side, bool is_regular, int thread_count) {
    benchmark::RegisterBenchmark(name_of(side, is_regular, thread_count).c_str(),
                                 [=](benchmark::State& state) { measure(state, side, is_regular, thread_count); })
        ->UseManualTime()->Unit(benchmark::kMillisecond);
  });
}

void print_preparation(const Medians& medians) {
  std::string rows;
  for_each([&](int side, bool is_regular, int thread_count) {
    const auto of = [&](const char* counter) { return median(medians, name_of(side, is_regular, thread_count), counter); };
    if (std::isnan(of("delaunay_s"))) return;
    rows += fmt::format("{:<8}{:<10}{:<9}{:>15.3f}{:>9.3f}{:>9.3f}{:>9.3f}{:>22.2f}\n", side == 1000 ? "1e6" : "1e5", is_regular ? "regular" : "random",
                        thread_count == 1 ? "one" : "all", of("delaunay_s"), of("mesh_s"), of("c1_s"), of("mesh_s") + of("c1_s"),
                        of("whole_per_delaunay"));
  });
  if (rows.empty()) return;
  fmt::print("\nPreparation of a point cloud, seconds, medians: the triangulation alone; all that linear needs, the triangulation in\n"
             "it; the patches of c1 on top; and the whole, also as a multiple of the triangulation\n\n"
             "{:<8}{:<10}{:<9}{:>15}{:>9}{:>9}{:>9}{:>22}\n{}",
             "points", "layout", "threads", "triangulation", "linear", "c1", "whole", "whole/triangulation", rows);
}

}  // namespace sagitta::bench
