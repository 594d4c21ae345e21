// SPDX-License-Identifier: Apache-2.0
// The order of a law y = a x^order from measured pairs: the slope of the straight line of least squares through
// (ln x, ln y), every pair with the same weight.
//
//   slope = sum (X - mean X)(Y - mean Y) / S,   S = sum (X - mean X)^2,   X = ln x, Y = ln y                        (1)
//   standard error = sqrt(sum residual^2 / ((N - 2) S))                                                             (2)
//
// Pairs that are not both positive and finite are left out. The slope is NaN of fewer than two different x, its error of fewer than
// three pairs.
//
// Source: Draper and Smith, Applied Regression Analysis (3rd ed., 1998), sections 1.2 to 1.4.
#pragma once

#include <cmath>
#include <limits>
#include <span>
#include <vector>

namespace sagitta::study {

struct Order {
  double slope = std::numeric_limits<double>::quiet_NaN();
  double standard_error = std::numeric_limits<double>::quiet_NaN();
  double factor = std::numeric_limits<double>::quiet_NaN();  // a
  int pairs = 0;                                             // that count
};

// x and y are of the same length.
inline Order order_of(std::span<const double> x, std::span<const double> y) {
  std::vector<double> X, Y;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!(x[i] > 0 && y[i] > 0 && std::isfinite(x[i]) && std::isfinite(y[i]))) continue;
    X.push_back(std::log(x[i]));
    Y.push_back(std::log(y[i]));
  }
  Order order;
  order.pairs = static_cast<int>(X.size());
  double mean_X = 0, mean_Y = 0, S = 0, product = 0, squares = 0;
  for (std::size_t i = 0; i < X.size(); ++i) mean_X += X[i] / order.pairs, mean_Y += Y[i] / order.pairs;
  for (std::size_t i = 0; i < X.size(); ++i) S += (X[i] - mean_X) * (X[i] - mean_X), product += (X[i] - mean_X) * (Y[i] - mean_Y);
  if (!(S > 0)) return order;
  order.slope = product / S;
  order.factor = std::exp(mean_Y - order.slope * mean_X);
  for (std::size_t i = 0; i < X.size(); ++i) squares += std::pow(Y[i] - mean_Y - order.slope * (X[i] - mean_X), 2);
  if (order.pairs > 2) order.standard_error = std::sqrt(squares / ((order.pairs - 2) * S));
  return order;
}

}  // namespace sagitta::study
