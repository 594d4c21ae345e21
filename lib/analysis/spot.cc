// SPDX-License-Identifier: Apache-2.0
#include "lib/analysis/spot.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sagitta::analysis {
namespace {

std::size_t area(int size) { return static_cast<std::size_t>(size) * static_cast<std::size_t>(size); }

}  // namespace

SpotImage::SpotImage(int image_size, double pixel, double x, double y)
    : size(image_size), pixel_mm(pixel), centre_x(x), centre_y(y), counts(area(image_size)) {}

void SpotImage::add(double x, double y) {
  const double half = size / 2;
  for (;;) {
    const double column = std::floor((x - centre_x) / pixel_mm) + half, row = half - 1 - std::floor((y - centre_y) / pixel_mm);
    if (column >= 0 && column < size && row >= 0 && row < size) {
      ++counts[static_cast<std::size_t>(row) * static_cast<std::size_t>(size) + static_cast<std::size_t>(column)];
      return;
    }
    double_pixels();
  }
}

void SpotImage::double_pixels() {
  std::vector<std::uint32_t> coarse(counts.size());
  const auto length = static_cast<std::size_t>(size), quarter = length / 4;
  // Pixel i stands i - size/2 pixels from the centre; size may be no multiple of 4, so halve that distance, not i.
  const auto halved = [&](std::size_t i) { return (i + length % 4 / 2) / 2 + quarter; };
  for (std::size_t row = 0; row < length; ++row)
    for (std::size_t column = 0; column < length; ++column)
      coarse[halved(row) * length + halved(column)] += counts[row * length + column];
  counts = std::move(coarse);
  pixel_mm *= 2;
}

void SpotCollector::add(const trace::RayBatch& rays) {
  for (std::size_t i = 0; i < rays.size(); ++i) {
    rays_.add(rays.ended[i]);
    if (rays.ended[i] != 0) continue;
    const double dx = rays.x[i] - image_.centre_x, dy = rays.y[i] - image_.centre_y;
    x_.add(dx);
    y_.add(dy);
    squares_.add(dx * dx + dy * dy);
    hull_.add(dx, dy);
    image_.add(rays.x[i], rays.y[i]);
  }
}

Spot SpotCollector::spot() const {
  const auto count = static_cast<double>(rays_[surface::Status::ok]);
  Spot result{rays_};
  if (count == 0) {
    result.centroid_x = result.centroid_y = result.rms_radius = result.geometric_radius = std::numeric_limits<double>::quiet_NaN();
    return result;
  }
  const double mean_x = x_.value() / count, mean_y = y_.value() / count;
  result.centroid_x = image_.centre_x + mean_x;
  result.centroid_y = image_.centre_y + mean_y;
  result.rms_radius = std::sqrt(std::max(0.0, squares_.value() / count - (mean_x * mean_x + mean_y * mean_y)));
  result.geometric_radius = hull_.farthest_from(mean_x, mean_y);
  return result;
}

SpotImage SpotCollector::image_with(double pixel_mm) const {
  SpotImage result = image_;
  while (result.pixel_mm < pixel_mm) result.double_pixels();
  return result;
}

}  // namespace sagitta::analysis
