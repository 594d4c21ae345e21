// SPDX-License-Identifier: Apache-2.0
// The even and odd asphere: powers of r on a base conic.
//
//   z = conic(r; c, K) + sum_k a_k r^k,   k from 2 to 40,   r^2 = x^2 + y^2                                            (1)
//
// a_k   coefficients {k: a_k}, mm^(1-k): Zemax's EVENASPH has a_2, a_4, ... as its parameters 1, 2, ..., CODE V's ASP a_4, a_6, ... as A, B, ...
//
// a_2 counts: the vertex curvature is c + 2 a_2. There is no a_1, a cone, which has no normal at its vertex.
//
// Evaluation, u = r^2:  p = u (E(u) + r O(u)),   (dp/dr)/r = 2 (E + u E') + r (3 O + 2 u O')                            (2)
// with the polynomials E of the even, O of the odd powers by Horner's rule; r is worked out only where there are odd ones. No term divides by r.
// Error: below 4 (N + 3) u of sum |a_k| r^k, of the slope below that of sum k |a_k| r^(k-1).
//
// Domain: the conic's. The hit is that of conic_departure.h, with |grad p| <= sum k |a_k| r^(k-1), exact for terms of one sign, and higher
// derivatives along lines likewise, below sum k (k-1) |a_k| r^(k-2) and sum k (k-1) (k-2) |a_k| r^(k-3).
//
// Source: ISO 10110-12:2007, 5.2 (rotationally symmetric aspheres).
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "lib/surface/conic_departure.h"

namespace sagitta::surface {

inline constexpr numerics::IndexRange powers_of_profiles{.first = 2, .last = 40, .is_list = false};
inline constexpr numerics::Key powers_key{
    .name = "coefficients", .kind = numerics::ValueKind::indexed, .meaning = "{power: coefficient}, in mm^(1 - power)",
    .indices = [](std::string_view) { return powers_of_profiles; }};

struct Asphere : ConicDeparture<Asphere> {
  static constexpr std::string_view kind = "asphere";
  static constexpr std::array keys{
      numerics::Key{.name = "radius_mm", .meaning = "vertex radius of the base conic", .required = true, .range = numerics::nonzero_or_infinite},
      base_conic_constant_key, powers_key};
  static constexpr double size_at_any_place = 0;

  int order = 0;  // the highest power
  int even_count = 0, odd_count = 0;
  const double* even = nullptr;  // of the powers 2 even_count, ..., 4, 2
  const double* odd = nullptr;   // of the powers 2 odd_count + 1, ..., 5, 3
  double reach = 1;              // up to here no term's slope is beyond 1

  template <class Parameters, class Arena>
  static Asphere from(const Parameters& given, Arena& arena) {
    Asphere result;
    result.base = {1 / given.number("radius_mm"), given.number("conic_constant")};
    std::vector<double> of_parity[2];
    result.reach = std::numeric_limits<double>::max();
    for (const auto& [power, coefficient] : given.list("coefficients")) {  // by rising power
      if (coefficient == 0) continue;
      auto& values = of_parity[power % 2];
      values.resize(static_cast<std::size_t>((power - power % 2) / 2));
      values.back() = coefficient;
      result.order = power;
      result.reach = std::min(result.reach, std::pow(power * std::abs(coefficient), -1.0 / (power - 1)));
    }
    for (auto& values : of_parity) std::reverse(values.begin(), values.end());
    result.even_count = static_cast<int>(of_parity[0].size()), result.odd_count = static_cast<int>(of_parity[1].size());
    result.even = arena.keep(std::move(of_parity[0])), result.odd = arena.keep(std::move(of_parity[1]));
    return result;
  }

  std::string kernel() const { return "asphere of order " + std::to_string(order); }
  std::size_t data_bytes() const { return sizeof *this + static_cast<std::size_t>(even_count + odd_count) * sizeof(double); }
  double vertex_curvature() const { return base.curvature + (even_count > 0 ? 2 * even[even_count - 1] : 0); }

  // p and (dp/dr)/r; of the terms' sizes, instead of the terms.
  template <class T>
  struct Radial {
    T value, slope_over_r;
  };
  template <bool of_sizes, class T>
  [[gnu::always_inline]] Radial<T> radial(const T& u) const {
    const auto horner = [&](const double* c, int count) {
      T value(0), along(0);
      for (int i = 0; i < count; ++i) {
        along = along * u + value;
        value = value * u + T(of_sizes ? std::abs(c[i]) : c[i]);
      }
      return Radial<T>{value, along};
    };
    using std::sqrt;
    const auto [E, E_u] = horner(even, even_count);
    if (odd_count == 0) return {u * E, T(2) * (E + u * E_u)};  // (2)
    const auto [O, O_u] = horner(odd, odd_count);
    const T r = sqrt(u);
    return {u * (E + r * O), T(2) * (E + u * E_u) + r * (T(3) * O + T(2) * (u * O_u))};
  }

  template <class T>
  [[gnu::always_inline]] Sum<T> sum_of_polynomial(const T& x, const T& y) const {
    const Radial<T> p = radial<false>(T(x * x + y * y));
    return {p.value, p.slope_over_r * x, p.slope_over_r * y};
  }
  template <class T>
  T size_of_terms(const T& x, const T& y) const {
    return radial<true>(T(x * x + y * y)).value;
  }
  template <class T>
  [[gnu::always_inline]] T steepest_squared_within(const T& r_squared) const {
    const T slope_over_r = radial<true>(r_squared).slope_over_r;
    return r_squared * slope_over_r * slope_over_r;
  }
  template <class T>
  T bound_within(const T& radius, int derivatives) const {
    T sum(0);
    for (int power = order; power >= derivatives; --power) {
      const int from_last = (power - power % 2) / 2;
      const double a = power % 2 == 0 ? (from_last <= even_count ? even[even_count - from_last] : 0) : (from_last <= odd_count ? odd[odd_count - from_last] : 0);
      double factor = 1;
      for (int k = 0; k < derivatives; ++k) factor *= power - k;
      sum = sum * radius + T(factor * std::abs(a));
    }
    return sum;
  }
  // In a step to 1 + 1/N of the radius the bound does not grow beyond 3.
  template <class T>
  T reach_from(const T& r) const {
    const T further = r * T(1 + 1.0 / order);
    return further < T(reach) ? T(reach) : further;
  }
  SumRounding sum_rounding(double x, double y) const {
    const double r_squared = x * x + y * y, u = std::numeric_limits<double>::epsilon() / 2;
    const Radial<double> sizes = radial<true>(r_squared);
    return {4 * (order + 3) * u * sizes.value, 4 * (order + 3) * u * std::sqrt(r_squared) * sizes.slope_over_r, sizes.value};
  }
};

}  // namespace sagitta::surface
