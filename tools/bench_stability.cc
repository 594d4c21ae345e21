// SPDX-License-Identifier: Apache-2.0
// Each step meets a conic, refracts and adds to the path, in the vectors of the best instruction set, on the same rays, which stay in the nearest
// cache. The first is the leanest there is: the quadratic's root as it stands, from where the ray is, that root as the path, the textbook's root
// in Snell's law, directions left as they come: as many roots and divisions as the last, which is lib/surface's.
#include "tools/bench_stability.h"

#include <benchmark/benchmark.h>
#include <fmt/core.h>

#include <array>
#include <random>
#include <vector>

#include "lib/numerics/instruction_set.h"
#include "lib/numerics/lanes.h"
#include "lib/surface/conic.h"
#include "lib/surface/refraction.h"
#include "tools/bench_clock.h"

namespace sagitta::bench {
namespace {

using numerics::Vec3;
constexpr std::size_t ray_count = 512;
constexpr int round_count = 2000;

// What is added to the step before.
enum class Measure { none, nearest_point, refraction };
struct Named {
  Measure measure;
  const char *name, *text;
};
constexpr std::array<Named, 3> measures{{{Measure::none, "stability_conic_none", "the formulas as they stand"},
                                         {Measure::nearest_point, "stability_conic_root", "from the point nearest the vertex, the root without cancellation"},
                                         {Measure::refraction, "stability_conic_all", "Snell's root by its conjugate, unit length: lib/surface"}}};

template <class T>
struct Stepped {
  Vec3<T> hit, direction;
  T opl;
};

template <Measure measure, class T>
Stepped<T> step(const surface::Conic& conic, const surface::IndexRatio<T>& ratio, const T& index, const Vec3<T>& start, const Vec3<T>& d, const T& opl) {
  using std::sqrt, numerics::select, numerics::negate_where;
  if constexpr (measure == Measure::refraction) {
    const auto crossing = conic.meet(start, d);
    return {crossing.point, refract(d, crossing.normal, crossing.along, ratio), opl + index * crossing.path};
  }
  const T c = conic.curvature, one_plus_K = T(1) + T(conic.conic_constant);
  const auto from = measure == Measure::none ? surface::NearestToVertex<T>{T(0), start} : surface::nearest_to_vertex(start, d);
  const Vec3<T>& p = from.point;
  const T A = c * (d.x * d.x + d.y * d.y + one_plus_K * d.z * d.z);
  const T B = d.z - c * (d.x * p.x + d.y * p.y + one_plus_K * d.z * p.z);
  const T C = c * (p.x * p.x + p.y * p.y + one_plus_K * p.z * p.z) - T(2) * p.z;
  const auto is_backward = d.z < T(0);
  const T along = negate_where<T>(is_backward, sqrt(B * B - A * C)), s_B = negate_where<T>(is_backward, B);
  const auto is_near = s_B >= T(0);
  const T t = measure == Measure::none ? (B - along) / A : select<T>(is_near, C, B - along) / select<T>(is_near, B + along, A);
  const Vec3<T> hit = p + t * d, normal{-c * hit.x, -c * hit.y, T(1) - one_plus_K * c * hit.z};
  const T v = ratio.mu * along, n_squared = dot(normal, normal);
  const T w = negate_where<T>(is_backward, sqrt((T(1) - ratio.mu * ratio.mu) * n_squared + v * v));
  return {hit, ratio.mu * d + ((w - v) / n_squared) * normal, opl + index * (from.path + t)};
}

using Column = std::array<double, ray_count>;
struct Columns {
  alignas(64) Column x, y, z, l, m, n, opl;
};

Columns rays() {
  Columns columns{};
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> place(-3, 3), slope(-.2, .2);
  for (std::size_t i = 0; i < ray_count; ++i) {
    const Vec3<double> d = normalized(Vec3<double>{slope(random), slope(random), 1});
    columns.x[i] = place(random), columns.y[i] = place(random), columns.z[i] = -1;
    columns.l[i] = d.x, columns.m[i] = d.y, columns.n[i] = d.z;
  }
  return columns;
}

template <Measure measure>
[[gnu::noinline]] void take(const surface::Conic& given, const Columns& from, Columns& to) {
  numerics::with_chosen_instructions_flat([&]<int n>() {
    using T = numerics::TwiceLanes<n>;
    const surface::Conic conic = given;
    const auto ratio = surface::IndexRatio<double>::of(1, 1.376);
    const surface::IndexRatio<T> in_lanes{T(ratio.mu), T(ratio.one_minus_mu_squared)};
    for (std::size_t i = 0; i < ray_count; i += 2 * n) {
      const auto at = [&](const Column& column) { return T::load(column.data() + i); };
      const Stepped<T> stepped = step<measure>(conic, in_lanes, T(1), Vec3<T>{at(from.x), at(from.y), at(from.z)}, Vec3<T>{at(from.l), at(from.m), at(from.n)}, at(from.opl));
      stepped.hit.x.store(to.x.data() + i), stepped.hit.y.store(to.y.data() + i), stepped.hit.z.store(to.z.data() + i);
      stepped.direction.x.store(to.l.data() + i), stepped.direction.y.store(to.m.data() + i), stepped.direction.z.store(to.n.data() + i);
      stepped.opl.store(to.opl.data() + i);
    }
  });
}

template <Measure kind>
void measure(benchmark::State& state) {
  const surface::Conic conic{1 / 7.72, -.26};
  const Columns from = rays();
  Columns to{};
  take<kind>(conic, from, to);
  for (auto _ : state) {
    const double before = now(1);
    for (int round = 0; round < round_count; ++round) {
      take<kind>(conic, from, to);
      benchmark::ClobberMemory();
    }
    state.SetIterationTime(now(1) - before);
  }
  state.SetItemsProcessed(state.iterations() * round_count * static_cast<std::int64_t>(ray_count));
}

}  // namespace

void register_stability() {
  const auto add = [](const Named& of, auto run) { benchmark::RegisterBenchmark(of.name, run)->UseManualTime()->Unit(benchmark::kMillisecond); };
  add(measures[0], measure<Measure::none>);
  add(measures[1], measure<Measure::nearest_point>);
  add(measures[2], measure<Measure::refraction>);
}

void print_stability(const Medians& medians) {
  const auto rate = [&](const Named& of) { return median(medians, of.name, "items_per_second") / 1e6; };
  std::string rows;
  for (const Named& of : measures)
    if (!std::isnan(rate(of))) rows += fmt::format("{:<68}{:>8}{:>8}\n", of.text, decimal(rate(of), 0), decimal(rate(measures[0]) / rate(of), 2));
  if (rows.empty()) return;
  fmt::print("\nWhat stability costs at a conic: hit, refraction and path, one thread, medians, millions of rays per second and\n"
             "the time over the first's; each line with what the lines above it have\n\n{}", rows);
}

}  // namespace sagitta::bench
