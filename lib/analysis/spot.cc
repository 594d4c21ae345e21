// SPDX-License-Identifier: Apache-2.0
#include "lib/analysis/spot.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lib/numerics/instruction_set.h"
#include "lib/numerics/lanes.h"

namespace sagitta::analysis {
namespace {

using numerics::Lanes;
using numerics::select;

constexpr std::size_t block_size = numerics::ConvexHull::block_size;  // rays; their columns stay in the first-level cache
constexpr std::size_t columns = numerics::ColumnSum::columns;         // as many as any vector holds, or more

std::size_t area(int size) { return static_cast<std::size_t>(size) * static_cast<std::size_t>(size); }

// The largest integer that is not above x, |x| < 2^31. 1.5 * 2^52 leaves no digits for fractions.
template <class T>
T floor_of(const T& x) {
  const T nearest = (x + T(0x1.8p52)) - T(0x1.8p52);
  return select(nearest > x, nearest - T(1), nearest);
}

}  // namespace

SpotImage::SpotImage(int image_size, double pixel, double x, double y)
    : size(image_size), pixel_mm(pixel), centre_x(x), centre_y(y), counts(area(image_size)), pixels_per_mm_(1 / pixel) {}

void SpotImage::add(double x, double y) {
  const double dx[]{x - centre_x, x - centre_x}, dy[]{y - centre_y, y - centre_y};
  add_from_centre<2>(dx, dy, 1);
}

template <int n>
void SpotImage::add_from_centre(const double* dx, const double* dy, std::size_t count) {
  using Vector = Lanes<n>;
  const Vector half = size / 2, length = size;
  for (;;) {
    const Vector scale = pixels_per_mm_;
    auto inside = half == half;
    for (std::size_t i = 0; i < count; i += n) {
      const Vector right = Vector::load(dx + i) * scale, up = Vector::load(dy + i) * scale;
      inside = inside & (right >= -half) & (right < half) & (up >= -half) & (up < half);
    }
    if (all(inside)) break;
    double_pixels();
  }
  const Vector scale = pixels_per_mm_;  // halving keeps its digits
  std::int32_t pixel[block_size];
  for (std::size_t i = 0; i < count; i += n)
    ((half - Vector(1) - floor_of(Vector::load(dy + i) * scale)) * length + half + floor_of(Vector::load(dx + i) * scale)).store(pixel + i);
  for (std::size_t i = 0; i < count; ++i) ++counts[static_cast<std::size_t>(pixel[i])];
}

[[gnu::noinline]] void SpotImage::double_pixels() {
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

void SpotCollector::add(const double* x, const double* y, const std::int32_t* ended, std::size_t count) {
  for (std::size_t from = 0; from < count; from += block_size) add_block(x + from, y + from, ended + from, std::min(block_size, count - from));
}

void SpotCollector::add_block(const double* x, const double* y, const std::int32_t* ended, std::size_t count) {
  double arrived_x[block_size], arrived_y[block_size];
  std::int32_t any_ended = 0;
  for (std::size_t i = 0; i < count; ++i) any_ended |= ended[i];
  if (any_ended == 0) {
    rays_.of[static_cast<std::size_t>(surface::Status::ok)] += static_cast<std::int64_t>(count);
  } else {
    std::size_t arrived = 0;
    for (std::size_t i = 0; i < count; ++i) {
      rays_.add(ended[i]);
      if (ended[i] == 0) arrived_x[arrived] = x[i], arrived_y[arrived] = y[i], ++arrived;
    }
    if (arrived == 0) return;
    x = arrived_x, y = arrived_y, count = arrived;
  }

  numerics::with_chosen_instructions_flat([&]<int n>() {
    using Vector = Lanes<n>;
    // From the image's centre, and zeros behind them: they add nothing to the sums.
    const std::size_t whole = (count + columns - 1) / columns * columns;
    const double centre_x = image_.centre_x, centre_y = image_.centre_y;
    double dx[block_size], dy[block_size], squares[block_size];
    for (std::size_t i = whole - columns; i < whole; ++i) dx[i] = dy[i] = 0;
    for (std::size_t i = 0; i < count; ++i) dx[i] = x[i] - centre_x, dy[i] = y[i] - centre_y;
    for (std::size_t i = 0; i < whole; i += n) {
      const Vector right = Vector::load(dx + i), up = Vector::load(dy + i);
      (right * right + up * up).store(squares + i);
    }
    x_.add<n>(dx, whole);
    y_.add<n>(dy, whole);
    squares_.add<n>(squares, whole);
    for (std::size_t i = count; i < whole; ++i) dx[i] = dx[count - 1], dy[i] = dy[count - 1];
    if (image_.size > 0) image_.add_from_centre<n>(dx, dy, count);
    hull_.add<n>(dx, dy, count);
  });
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
