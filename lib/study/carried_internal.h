// SPDX-License-Identifier: Apache-2.0
// A double that carries along what rounding has done to it at most, and its derivatives by six variables: a template of a number type bounds and
// differentiates itself with it.
//   fl(a o b) = (a o b)(1 + e), |e| <= u = 2^-53:   rounding of a + b: r_a + r_b + u |a + b|,   of a b: |a| r_b + |b| r_a + r_a r_b + u |a b|            (1)
//
// Source: Higham, Accuracy and Stability of Numerical Algorithms (2nd ed., 2002), section 3.3 (running error analysis).
#pragma once

#include <array>
#include <cmath>
#include <limits>

namespace sagitta::study {

struct Carried {
  static constexpr std::size_t variables = 6;
  double value = 0, rounding = 0;
  std::array<double, variables> slopes{};

  Carried(double exact = 0) : value(exact) {}
  explicit operator double() const { return value; }

  friend Carried operator+(const Carried& a, const Carried& b) { return made(a.value + b.value, a.rounding + b.rounding, a, 1, b, 1); }
  friend Carried operator-(const Carried& a, const Carried& b) { return made(a.value - b.value, a.rounding + b.rounding, a, 1, b, -1); }
  friend Carried operator-(const Carried& a) { return Carried(0) - a; }
  friend Carried operator*(const Carried& a, const Carried& b) {
    return made(a.value * b.value, std::abs(a.value) * b.rounding + std::abs(b.value) * a.rounding + a.rounding * b.rounding, a, b.value, b, a.value);
  }
  friend Carried operator/(const Carried& a, const Carried& b) {
    const double quotient = a.value / b.value, least = std::abs(b.value) - b.rounding;  // below it: no bound
    const double off = least > 0 ? (a.rounding + std::abs(quotient) * b.rounding) / least : std::numeric_limits<double>::infinity();
    return made(quotient, off, a, 1 / b.value, b, -quotient / b.value);
  }
  friend Carried sqrt(const Carried& a) {
    const double root = std::sqrt(a.value);
    return made(root, a.rounding > 0 ? a.rounding / root : 0, a, .5 / root, a, 0);  // sqrt(a + r) - sqrt(a) < r/sqrt(a)
  }
  friend Carried abs(const Carried& a) { return a.value < 0 ? -a : a; }
  friend bool operator>(const Carried& a, const Carried& b) { return a.value > b.value; }

 private:
  static Carried made(double value, double rounding, const Carried& a, double by_a, const Carried& b, double by_b) {
    Carried result(value);
    result.rounding = rounding + 0x1p-53 * std::abs(value);
    for (std::size_t i = 0; i < variables; ++i) result.slopes[i] = a.slopes[i] * by_a + b.slopes[i] * by_b;
    return result;
  }
};

}  // namespace sagitta::study

template <>
struct std::numeric_limits<sagitta::study::Carried> : std::numeric_limits<double> {};
