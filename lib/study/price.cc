// SPDX-License-Identifier: Apache-2.0
#include "lib/study/price.h"

#include <algorithm>
#include <cmath>

#include "lib/numerics/parallel.h"

namespace sagitta::study {
namespace {

constexpr double probe_points = 4000;
constexpr std::int64_t probe_rays = 2000, probe_compared = 128;

double compared_rays(const Variant& variant) { return static_cast<double>(std::min(variant.rays, variant.most_compared)); }

// (1) without its rest.
double seconds_without_rest(const Variant& variant, double points, const Row& row) {
  const double ratio = row.points > 0 ? points / static_cast<double>(row.points) : 1;
  const bool is_nearest = variant.search == Search::nearest_vertex;
  const double prepare_s = ratio * row.prepare_wall_s.median;
  const double trace_s = 1e-9 * row.wall_ns_per_ray.median * (is_nearest ? ratio : 1) / numerics::thread_count_of(variant.threads);
  const double rays = std::min(static_cast<double>(variant.rays), is_nearest ? longest_search_s / trace_s : INFINITY);
  const auto [runs, passes] = tracing_repeats(rays * trace_s);
  return ratio * row.sampling_s + preparation_repeats(prepare_s, variant.prepare_repeats) * prepare_s +
         compared_rays(variant) * (is_nearest ? ratio : 1) * row.comparing_s / static_cast<double>(row.compared) +
         (1 + runs * passes) * rays * (1e-9 * row.launching_ns_per_ray + trace_s);
}

}  // namespace

Variant probe_of(const Variant& variant, double points) {
  Variant probe = variant;
  if (points > probe_points && probe.arrangement.rings == 0) probe.arrangement.points_per_mm2 *= probe_points / points;
  probe.rays = std::min(variant.rays, probe_rays);
  probe.most_compared = std::min(variant.most_compared, probe_compared);
  probe.threads = 1;
  return probe;
}

double seconds_of(const Variant& variant, double points, const Probe& probe) {
  const double own = static_cast<double>(probe.row.points);
  const double rest = probe.seconds - seconds_without_rest(probe_of(variant, points), own, probe.row);
  return seconds_without_rest(variant, points, probe.row) + std::max(0.0, rest);
}

double exact_seconds_of(const Variant& variant, const Probe& probe, int thread_count) {
  return compared_rays(variant) * probe.exact_s_per_ray / numerics::thread_count_of(thread_count);
}

}  // namespace sagitta::study
