// SPDX-License-Identifier: Apache-2.0
// An index that is a polynomial along the axis and in even powers across it:
//
//   n = n0 + sum_i a_i z^i + sum_k b_k r^k,   r^2 = x^2 + y^2,   k even                                             (1)
//   n grad n = n (2 x B, 2 y B, A),   B = sum_k (k/2) b_k r^(k-2),   A = sum_i i a_i z^(i-1)                        (2)
//
// a_i in mm^-i, b_k in mm^-k. With z to the third and r to the sixth power it is Zemax' "Gradient 3". n grows without bound far from the axis: there
// is no such medium where n <= 0 (then n^2 is NaN).
//
// Source: the lens of Liou and Brennan, J. Opt. Soc. Am. A 14, 1684 (1997), table 1; Zemax OpticStudio, "Gradient 3".
#pragma once

#include <algorithm>
#include <array>
#include <limits>

#include "lib/gradient_index/field.h"
#include "lib/numerics/key.h"
#include "lib/numerics/lanes.h"

namespace sagitta::gradient_index {

inline constexpr int highest_power = 12;
inline constexpr numerics::Range indices{.low = 1e-3, .high = 1e3, .reason = "beyond, directions lose their digits from one medium to the next"};

struct Polynomial {
  static constexpr std::string_view kind = "polynomial";
  static constexpr std::array keys{
      numerics::Key{.name = "index", .meaning = "n0: refractive index at the vertex", .required = true, .range = indices},
      numerics::Key{.name = "z_coefficients", .kind = numerics::ValueKind::indexed, .meaning = "power of z in mm: coefficient",
                    .indices = [](std::string_view) { return numerics::IndexRange{1, highest_power}; }},
      numerics::Key{.name = "r_coefficients", .kind = numerics::ValueKind::indexed, .meaning = "even power of r in mm: coefficient",
                    .indices = [](std::string_view) { return numerics::IndexRange{2, highest_power, 2}; }}};

  double index = 1;
  int z_degree = 0, r_degree = 0;                // the highest powers; r_degree of r^2
  std::array<double, highest_power + 1> z{};     // z[i] = a_i, z[0] unused
  std::array<double, highest_power / 2 + 1> r{};  // r[k/2] = b_k, likewise

  template <class Parameters, class Arena>
  static Polynomial from(const Parameters& given, Arena&) {
    Polynomial result{.index = given.number("index")};
    for (const auto& [power, coefficient] : given.list("z_coefficients"))
      if (coefficient != 0) result.z[static_cast<std::size_t>(power)] = coefficient, result.z_degree = power;
    for (const auto& [power, coefficient] : given.list("r_coefficients"))
      if (coefficient != 0) result.r[static_cast<std::size_t>(power / 2)] = coefficient, result.r_degree = power / 2;
    return result;
  }

  // sum_(i>0) c_i x^i and its derivative, by Horner's rule.
  template <class T>
  struct WithSlope {
    T value, slope;
  };
  template <class T, std::size_t size>
  static WithSlope<T> sum(const std::array<double, size>& coefficients, int degree, const T& x) {
    T value(0), slope(0);
    for (int i = degree; i > 0; --i) {
      slope = slope * x + value;
      value = value * x + T(coefficients[static_cast<std::size_t>(i)]);
    }
    return {value * x, slope * x + value};
  }

  template <class T>
  InMedium<T> at(const Vec3<T>& place) const {
    const WithSlope<T> along = sum(z, z_degree, place.z), across = sum(r, r_degree, T(place.x * place.x + place.y * place.y));
    const T n = T(index) + along.value + across.value, twice = T(2) * n * across.slope;
    const T squared = numerics::select<T>(n > T(0), n * n, std::numeric_limits<T>::quiet_NaN());
    return {squared, {twice * place.x, twice * place.y, n * along.slope}};
  }
  template <class T>
  T index_at(const Vec3<T>& place) const {
    return T(index) + sum(z, z_degree, place.z).value + sum(r, r_degree, T(place.x * place.x + place.y * place.y)).value;
  }
};

}  // namespace sagitta::gradient_index
