// SPDX-License-Identifier: Apache-2.0
// Mean and standard deviation of a few values, such as the same variant's over its seeds.
//
//   mean = sum x / N,   deviation = sqrt(sum (x - mean)^2 / (N - 1))                                                (1)
//
// over the N values that are finite. The mean is NaN of none, the deviation of fewer than two.
//
// Source: Draper and Smith, Applied Regression Analysis (3rd ed., 1998), section 0.1.
#pragma once

#include <cmath>
#include <limits>
#include <span>

namespace sagitta::study {

struct Mean {
  double mean = std::numeric_limits<double>::quiet_NaN();
  double deviation = std::numeric_limits<double>::quiet_NaN();
  int count = 0;  // of the values that count
};

inline Mean mean_of(std::span<const double> values) {
  Mean result;
  double sum = 0, squares = 0;
  for (const double x : values)
    if (std::isfinite(x)) sum += x, ++result.count;
  if (result.count == 0) return result;
  result.mean = sum / result.count;
  for (const double x : values)
    if (std::isfinite(x)) squares += (x - result.mean) * (x - result.mean);
  if (result.count > 1) result.deviation = std::sqrt(squares / (result.count - 1));
  return result;
}

}  // namespace sagitta::study
