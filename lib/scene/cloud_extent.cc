// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>

#include "lib/scene/cloud_fit.h"
#include "lib/scene/mesh_internal.h"

namespace sagitta::scene {

using numerics::Vec3;

CloudExtent extent_of(const prescription::PointCloud& cloud) {
  constexpr double inf = std::numeric_limits<double>::infinity();
  Vec3<double> low{inf, inf, inf}, high{-inf, -inf, -inf};
  Rectangle places;
  for (const Vec3<double>& p : cloud.points) {
    places.include(p.x, p.y);
    if (std::isnan(p.z)) continue;
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  const std::vector<Vec3<double>> some = sample_of(cloud.points);
  std::vector<double> values(some.size());
  const auto median = [&](auto&& coordinate) {
    if (some.empty()) return 0.0;
    std::transform(some.begin(), some.end(), values.begin(), coordinate);
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
  };
  const Vec3<double> centre{median([](const auto& p) { return p.x; }), median([](const auto& p) { return p.y; }),
                            median([](const auto& p) { return p.z; })};
  const Vec3<double> up = high - centre, down = centre - low;
  return {places, low, high, centre, std::max({up.x, up.y, up.z, down.x, down.y, down.z}), fit_base_sphere(cloud.points, centre)};
}

}  // namespace sagitta::scene
