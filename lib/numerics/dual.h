// SPDX-License-Identifier: Apache-2.0
// A number with its derivative by one variable: templates of a number type differentiate themselves with it.
//   (a + a' e)(b + b' e) = a b + (a' b + a b') e,   1/(a + a' e) = 1/a - a'/a^2 e,   e^2 = 0
#pragma once

#include <limits>

namespace sagitta::numerics {

struct Dual {
  double value = 0, slope = 0;

  constexpr Dual(double constant = 0) : value(constant) {}
  constexpr Dual(double given, double given_slope) : value(given), slope(given_slope) {}

  friend constexpr Dual operator+(const Dual& a, const Dual& b) { return {a.value + b.value, a.slope + b.slope}; }
  friend constexpr Dual operator-(const Dual& a, const Dual& b) { return {a.value - b.value, a.slope - b.slope}; }
  friend constexpr Dual operator-(const Dual& a) { return {-a.value, -a.slope}; }
  friend constexpr Dual operator*(const Dual& a, const Dual& b) { return {a.value * b.value, a.slope * b.value + a.value * b.slope}; }
  friend constexpr Dual operator/(const Dual& a, const Dual& b) {
    const double quotient = a.value / b.value;
    return {quotient, (a.slope - quotient * b.slope) / b.value};
  }
  friend constexpr bool operator>(const Dual& a, const Dual& b) { return a.value > b.value; }
};

}  // namespace sagitta::numerics

template <>
struct std::numeric_limits<sagitta::numerics::Dual> : std::numeric_limits<double> {};
