// SPDX-License-Identifier: Apache-2.0
#include "lib/analysis/spot.h"

#include <algorithm>
#include <cmath>

#include "lib/numerics/sum.h"

namespace sagitta::analysis {

Spot spot(const trace::RayBatch& rays) {
  Spot result{};
  result.rays = count_statuses(rays);
  const auto arrived = static_cast<double>(result.rays[surface::Status::ok]);
  numerics::Sum sum_x, sum_y, sum_r2;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (rays.ended[i] != 0) continue;
    sum_x.add(rays.x[i]);
    sum_y.add(rays.y[i]);
  }
  result.centroid_x = sum_x.value() / arrived;  // 0/0: NaN where no ray arrived
  result.centroid_y = sum_y.value() / arrived;
  double max_r2 = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (rays.ended[i] != 0) continue;
    const double dx = rays.x[i] - result.centroid_x, dy = rays.y[i] - result.centroid_y, r2 = dx * dx + dy * dy;
    sum_r2.add(r2);
    max_r2 = std::max(max_r2, r2);
  }
  result.rms_radius = std::sqrt(sum_r2.value() / arrived);
  result.geometric_radius = arrived > 0 ? std::sqrt(max_r2) : result.rms_radius;
  return result;
}

SpotImage spot_image(const trace::RayBatch& rays, int size, double pixel_mm, double centre_x, double centre_y) {
  SpotImage image{size, pixel_mm, centre_x, centre_y, std::vector<std::uint32_t>(static_cast<std::size_t>(size) * static_cast<std::size_t>(size))};
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (rays.ended[i] != 0) continue;
    const double column = std::floor((rays.x[i] - centre_x) / pixel_mm + size / 2.0);
    const double row = std::floor((centre_y - rays.y[i]) / pixel_mm + size / 2.0);
    if (column >= 0 && column < size && row >= 0 && row < size)
      ++image.counts[static_cast<std::size_t>(row) * static_cast<std::size_t>(size) + static_cast<std::size_t>(column)];
    else
      ++image.outside;
  }
  return image;
}

}  // namespace sagitta::analysis
