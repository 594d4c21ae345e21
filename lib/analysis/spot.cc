// SPDX-License-Identifier: Apache-2.0
#include "lib/analysis/spot.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sagitta::analysis {
namespace {

constexpr std::size_t block_size = numerics::ConvexHull::block_size;  // rays; their columns stay in the first-level cache

std::size_t area(int size) { return static_cast<std::size_t>(size) * static_cast<std::size_t>(size); }

}  // namespace

SpotImage::SpotImage(int image_size, double pixel, double x, double y)
    : size(image_size), pixel_mm(pixel), centre_x(x), centre_y(y), counts(area(image_size)), pixels_per_mm_(1 / pixel) {}

void SpotImage::add(double x, double y) {
  const double dx = x - centre_x, dy = y - centre_y;
  add_from_centre(&dx, &dy, 1);
}

void SpotImage::add_from_centre(const double* dx, const double* dy, std::size_t count) {
  const int half = size / 2;
  std::int32_t pixel[most_at_once];
  for (;;) {
    const double scale = pixels_per_mm_;
    int outside = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const double right = dx[i] * scale, up = dy[i] * scale;
      outside |= (right >= -half) & (right < half) & (up >= -half) & (up < half) ? 0 : 1;
    }
    if (outside == 0) break;
    double_pixels();
  }
  const double scale = pixels_per_mm_;  // halving keeps its digits
  for (std::size_t i = 0; i < count; ++i) pixel[i] = (half - 1 - floor_of(dy[i] * scale)) * size + half + floor_of(dx[i] * scale);
  for (std::size_t i = 0; i < count; ++i) ++counts[static_cast<std::size_t>(pixel[i])];
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
  pixels_per_mm_ /= 2;
}

void SpotCollector::add(const trace::RayBatch& rays) {
  for (std::size_t from = 0; from < rays.size(); from += block_size) add_block(rays, from, std::min(block_size, rays.size() - from));
}

// One loop for each purpose: those that can become vectors do.
void SpotCollector::add_block(const trace::RayBatch& rays, std::size_t from, std::size_t count) {
  const double *x = &rays.x[from], *y = &rays.y[from];
  const std::int32_t* ended = &rays.ended[from];
  double dx[block_size]{}, dy[block_size]{}, squares[block_size];
  std::int32_t any_ended = 0;
  for (std::size_t i = 0; i < count; ++i) any_ended |= ended[i];
  const double centre_x = image_.centre_x, centre_y = image_.centre_y;
  for (std::size_t i = 0; i < count; ++i) dx[i] = x[i] - centre_x, dy[i] = y[i] - centre_y;
  if (any_ended == 0)
    rays_.of[static_cast<std::size_t>(surface::Status::ok)] += static_cast<std::int64_t>(count);
  else
    for (std::size_t i = 0; i < count; ++i) {
      rays_.add(ended[i]);
      if (ended[i] != 0) dx[i] = dy[i] = 0;  // adds nothing to the sums
    }
  for (std::size_t i = 0; i < count; ++i) squares[i] = dx[i] * dx[i] + dy[i] * dy[i];
  x_.add(dx, count);
  y_.add(dy, count);
  squares_.add(squares, count);
  std::size_t arrived = any_ended == 0 ? count : 0;
  for (std::size_t i = arrived; i < count; ++i) {
    if (ended[i] != 0) continue;
    dx[arrived] = dx[i], dy[arrived] = dy[i];
    ++arrived;
  }
  image_.add_from_centre(dx, dy, arrived);
  hull_.add(dx, dy, arrived);
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
