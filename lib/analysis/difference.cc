// SPDX-License-Identifier: Apache-2.0
#include "lib/analysis/difference.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lib/numerics/sum.h"

namespace sagitta::analysis {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

// (3), by Gram-Schmidt over the samples: of what is left of `values` each of 1, x, y is taken out, itself first made free of
// those before. One that the samples do not tell from those before is left out.
std::vector<double> without_tilt(std::vector<double> values, int size) {
  const auto n = static_cast<std::size_t>(size);
  const auto product = [&](const std::vector<double>& a, const std::vector<double>& b) {
    numerics::Sum sum;
    for (std::size_t i = 0; i < values.size(); ++i)
      if (std::isfinite(values[i])) sum.add(a[i] * b[i]);
    return sum.value();
  };
  std::vector<std::vector<double>> taken;
  const auto take_out = [&](std::vector<double>& from, const std::vector<double>& one) {
    const double share = product(from, one) / product(one, one);
    for (std::size_t i = 0; i < from.size(); ++i) from[i] -= share * one[i];
  };
  for (int power = 0; power < 3; ++power) {
    std::vector<double> one(values.size(), 1);
    for (std::size_t i = 0; i < one.size() && power > 0; ++i) one[i] = static_cast<double>(power == 1 ? i % n : i / n) - (size - 1) / 2.0;
    const double before = product(one, one);
    for (const auto& other : taken) take_out(one, other);
    if (!(product(one, one) > 1e-20 * before)) continue;
    take_out(values, one);
    taken.push_back(std::move(one));
  }
  return values;
}

}  // namespace

WavefrontDifference wavefront_difference(const Wavefront& other, const Wavefront& first) {
  WavefrontDifference result;
  result.size = first.size;
  result.opd_waves.assign(first.mask.size(), nan);
  result.mask.assign(first.mask.size(), outside_pupil);
  numerics::Sum sum, squares;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (std::size_t i = 0; i < first.mask.size(); ++i) {
    if (first.mask[i] == outside_pupil) continue;
    const bool in_first = std::isfinite(first.opd_waves[i]), in_other = std::isfinite(other.opd_waves[i]);
    const Compared compared = in_first ? (in_other ? Compared::in_both : Compared::only_in_first)
                                       : (in_other ? Compared::only_in_other : Compared::in_neither);
    result.mask[i] = static_cast<std::uint32_t>(compared);
    result.only_in_first += compared == Compared::only_in_first;
    result.only_in_other += compared == Compared::only_in_other;
    if (compared != Compared::in_both) continue;
    const double difference = other.opd_waves[i] - first.opd_waves[i];
    result.opd_waves[i] = difference;
    ++result.in_both;
    sum.add(difference);
    low = std::min(low, difference);
    high = std::max(high, difference);
  }
  const auto count = static_cast<double>(result.in_both);
  const double mean = result.mean_waves = sum.value() / count;  // NaN of none
  for (const double difference : result.opd_waves)
    if (std::isfinite(difference)) squares.add((difference - mean) * (difference - mean));
  result.rms_waves = result.in_both > 0 ? std::sqrt(squares.value() / count) : nan;
  result.without_tilt_waves = without_tilt(result.opd_waves, result.size);
  numerics::Sum squares_left;
  for (const double left : result.without_tilt_waves)
    if (std::isfinite(left)) squares_left.add(left * left);
  result.rms_without_tilt_waves = result.in_both > 0 ? std::sqrt(squares_left.value() / count) : nan;
  result.peak_to_valley_waves = result.in_both > 0 ? high - low : nan;
  if (first.zernike && other.zernike)
    for (std::size_t j = 0; j < std::min(first.zernike->coefficients.size(), other.zernike->coefficients.size()); ++j)
      result.zernike_um.push_back(other.zernike->coefficients[j] - first.zernike->coefficients[j]);
  return result;
}

SpotDifference spot_difference(const Spot& other, const Spot& first) {
  const double difference = other.rms_radius - first.rms_radius;
  return {difference, first.rms_radius > 0 ? 100 * difference / first.rms_radius : nan,
          {other.centroid_x - first.centroid_x, other.centroid_y - first.centroid_y}};
}

std::vector<Difference> differences(const std::vector<JobResult>& other, const std::vector<JobResult>& first) {
  std::vector<Difference> result;
  for (std::size_t i = 0; i < first.size(); ++i) {
    const auto &of_other = other[i].wavefront->wavefront, &of_first = first[i].wavefront->wavefront;
    result.push_back({spot_difference(*other[i].spot, *first[i].spot), std::nullopt});
    if (of_other && of_first) result.back().wavefront = wavefront_difference(*of_other, *of_first);
  }
  return result;
}

}  // namespace sagitta::analysis
