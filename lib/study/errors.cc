// SPDX-License-Identifier: Apache-2.0
#include "lib/study/errors.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "lib/numerics/sum.h"

namespace sagitta::study {
namespace {

using Long = long double;
using numerics::Vec3;

constexpr double um_per_mm = 1e3, arcmin_per_radian = 60 * 180 / std::numbers::pi;

Statistics statistics_of(const std::vector<double>& values) {
  if (values.empty()) return {};
  numerics::Sum sum, squares;
  for (const double value : values) sum.add(value), squares.add(value * value);
  const auto count = static_cast<double>(values.size());
  return {sum.value() / count, std::sqrt(squares.value() / count), *std::max_element(values.begin(), values.end())};
}

// Calls visit(i) for the rays that both find.
template <class Visit>
Found for_each_in_both(const trace::RayBatch& variant, const std::vector<TrueRay>& truth, const Visit& visit) {
  Found found;
  for (std::size_t i = 0; i < variant.size(); ++i) {
    const bool in_variant = variant.ended[i] == 0, in_truth = truth[i].ended == 0;
    ++(in_variant ? (in_truth ? found.by_both : found.by_variant_only) : (in_truth ? found.by_truth_only : found.by_neither));
    if (in_variant && in_truth) visit(i);
  }
  return found;
}

double rms_radius_um(const std::vector<Vec3<Long>>& points) {
  if (points.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto count = static_cast<Long>(points.size());
  Long x = 0, y = 0, squares = 0;
  for (const auto& p : points) x += p.x / count, y += p.y / count;
  for (const auto& p : points) squares += ((p.x - x) * (p.x - x) + (p.y - y) * (p.y - y)) / count;
  return um_per_mm * static_cast<double>(std::sqrt(squares));
}

}  // namespace

SurfaceErrors surface_errors(const trace::RayBatch& variant, const std::vector<TrueRay>& truth) {
  std::vector<double> distances, angles;
  SurfaceErrors errors;
  errors.found = for_each_in_both(variant, truth, [&](std::size_t i) {
    const auto hit = numerics::vec3_cast<Long>(variant.position(i)), direction = numerics::vec3_cast<Long>(variant.direction(i));
    distances.push_back(um_per_mm * static_cast<double>(norm(hit - truth[i].position)));
    angles.push_back(arcmin_per_radian * static_cast<double>(angle_between(direction, truth[i].direction)));
  });
  errors.distance_um = statistics_of(distances);
  errors.angle_arcmin = statistics_of(angles);
  return errors;
}

SpotErrors spot_errors(const trace::RayBatch& variant, const std::vector<TrueRay>& truth) {
  std::vector<Vec3<Long>> of_variant, of_truth;
  SpotErrors errors;
  errors.found = for_each_in_both(variant, truth, [&](std::size_t i) {
    of_variant.push_back(numerics::vec3_cast<Long>(variant.position(i)));
    of_truth.push_back(truth[i].position);
  });
  errors.rms_radius_um = rms_radius_um(of_variant);
  errors.true_rms_radius_um = rms_radius_um(of_truth);
  if (errors.true_rms_radius_um > 0) errors.rms_radius_percent = 100 * (errors.rms_radius_um / errors.true_rms_radius_um - 1);
  return errors;
}

}  // namespace sagitta::study
