// SPDX-License-Identifier: Apache-2.0
// A polynomial in x and y on a base conic: Zemax's Extended Polynomial, CODE V's XYP.
//
//   z = conic(r; c, K) + sum_j C_j X^i Y^k,   X = x/r0, Y = y/r0                                                     (1)
//
// r0    normalization_radius_mm, 1 unless given: then C_j has the unit mm^(1 - i - k)
// C_j   coefficients {j: C_j}, mm; j counts the terms from 1 by rising degree n = i + k, in it by falling power of X:
//         1: x   2: y   3: x^2   4: x y   5: y^2   6: x^3   7: x^2 y   8: x y^2   9: y^3   10: x^4 ...
//         j = n (n+1)/2 + k,  up to degree 20, j = 230                                                               (2)
//
// The domain is the conic's; outside r0 the terms go on. The hit is that of conic_departure.h, with s_n = sum of |C_j| of degree n and
// rho = r/r0:   |grad p| <= sum n s_n rho^(n-1)/r0,   second derivatives below sum n (n-1) s_n rho^(n-2)/r0^2.            (3)
//
// Error of the sum (numerics/polynomial.h): below 2 (N + 3) u of sum |C_j X^i Y^k|.
//
// Source: Zemax OpticStudio's help, "Extended Polynomial"; the order of the terms is CODE V's too (there C1 is the conic constant, C2 that of x).
#pragma once

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "lib/surface/conic_departure.h"

namespace sagitta::surface {

struct XyPolynomial : ConicDeparture<XyPolynomial> {
  static constexpr int highest_degree = 20;
  static constexpr std::string_view kind = "xy_polynomial";
  static constexpr std::array keys{
      base_radius_key, base_conic_constant_key,
      numerics::Key{.name = "normalization_radius_mm", .meaning = "radius r0 of the terms x/r0 and y/r0",
                    .range = {.low = 1e-15, .high = 1e15, .reason = "it is in mm; powers of the radius over it would leave the range of numbers"}, .fallback = 1},
      numerics::Key{.name = "coefficients", .kind = numerics::ValueKind::indexed,
                    .meaning = "{1: x, 2: y, 3: x^2, 4: x y, 5: y^2, 6: x^3, ...}: coefficient of each term in mm, or a list from the first", .required = true,
                    .indices = [](std::string_view) { return numerics::IndexRange{1, highest_degree * (highest_degree + 3) / 2}; }}};
  static constexpr double size_at_any_place = 0;

  double per_radius = 1;
  numerics::Polynomial polynomial;
  const double* sizes = nullptr;  // s_n, from 0 to the degree

  template <class Parameters, class Arena>
  static XyPolynomial from(const Parameters& given, Arena& arena) {
    XyPolynomial result;
    result.base = {1 / given.number("radius_mm"), given.number("conic_constant")};
    result.per_radius = 1 / given.number("normalization_radius_mm");
    const auto degree_of = [](int j) {
      int n = 1;
      while (n * (n + 3) / 2 < j) ++n;
      return n;
    };
    int degree = -1;
    for (const auto& [j, value] : given.list("coefficients"))
      if (value != 0) degree = degree_of(j);
    std::vector<double> values(numerics::Polynomial::count(degree)), sizes(static_cast<std::size_t>(degree + 1));
    for (const auto& [j, value] : given.list("coefficients")) {
      if (value == 0) continue;
      const int n = degree_of(j), k = j - n * (n + 1) / 2;  // (2)
      values[numerics::Polynomial::place(degree, n - k, k)] = value;
      sizes[static_cast<std::size_t>(n)] += std::abs(value);
    }
    result.polynomial = {degree, arena.keep(std::move(values))};
    result.sizes = arena.keep(std::move(sizes));
    return result;
  }

  std::string kernel() const { return "polynomial in x and y of degree " + std::to_string(polynomial.degree); }
  std::size_t data_bytes() const { return sizeof *this + (numerics::Polynomial::count(polynomial.degree) + static_cast<std::size_t>(polynomial.degree + 1)) * sizeof(double); }
  double vertex_curvature() const { return curvature_by(0, 2); }
  double vertex_curvature_x() const { return curvature_by(2, 0); }
  // With the term X^i Y^k, which is a square.
  double curvature_by(int i, int k) const {
    const int degree = polynomial.degree;
    return base.curvature + (degree < 2 ? 0 : 2 * polynomial.coefficients[numerics::Polynomial::place(degree, i, k)] * per_radius * per_radius);
  }

  template <class T>
  [[gnu::always_inline]] Sum<T> sum_of_polynomial(const T& x, const T& y) const {
    const Sum<T> p = polynomial.evaluate<T>(x * T(per_radius), y * T(per_radius));
    return {p.value, p.along_x * T(per_radius), p.along_y * T(per_radius)};
  }
  // (3), or of the sum itself.
  template <class T>
  [[gnu::always_inline]] T bound_at(const T& rho, int derivatives) const {
    T sum(0);
    for (int n = polynomial.degree; n >= derivatives; --n) {
      double factor = 1;
      for (int k = 0; k < derivatives; ++k) factor *= n - k;
      sum = sum * rho + T(factor * sizes[n]);
    }
    return sum;
  }
  template <class T>
  T size_of_terms(const T& x, const T& y) const {
    using std::sqrt;
    return bound_at(T(sqrt(x * x + y * y) * T(per_radius)), 0);
  }
  template <class T>
  [[gnu::always_inline]] T steepest_squared_within(const T& r_squared) const {
    using std::sqrt;
    const T slope = bound_at(T(sqrt(r_squared) * T(per_radius)), 1) * T(per_radius);
    return slope * slope;
  }
  template <class T>
  T bound_within(const T& radius, int derivatives) const {
    T bound = bound_at(T(radius * T(per_radius)), derivatives);
    for (int k = 0; k < derivatives; ++k) bound *= T(per_radius);
    return bound;
  }
  template <class T>
  T reach_from(const T& r) const {
    const T r0 = T(1) / T(per_radius), further = r * T(1 + 1.0 / polynomial.degree);
    return further < r0 ? r0 : further;
  }
  SumRounding sum_rounding(double x, double y) const {
    const double rho = std::hypot(x, y) * per_radius, u = std::numeric_limits<double>::epsilon() / 2, count = 4.0 * (polynomial.degree + 3);
    return {count * u * bound_at(rho, 0), count * u * bound_at(rho, 1) * per_radius, bound_at(rho, 0)};
  }
};

}  // namespace sagitta::surface
