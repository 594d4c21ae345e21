// SPDX-License-Identifier: Apache-2.0
// A squared index that is linear and quadratic along each axis:
//
//   n^2 = n0^2 + sum_i (l_i x_i + q_i x_i^2),   n grad n = (l_i/2 + q_i x_i)                                        (1)
//
// n0  index at the vertex        l_i  1/mm, q_i  1/mm^2: along x, y, z
//
// Rays are parabolas where q = 0, sines and hyperbolic sines of the optical parameter (transfer.h) otherwise. There is no such medium where n^2 <= 0.
//
// Source: Marchand, Gradient Index Optics (1978), chapter 4.
#pragma once

#include "lib/gradient_index/polynomial.h"

namespace sagitta::gradient_index {

struct Quadratic {
  static constexpr std::string_view kind = "quadratic";
  static constexpr std::array keys{
      numerics::Key{.name = "index", .meaning = "n0: refractive index at the vertex", .required = true, .range = indices},
      numerics::Key{.name = "x_per_mm", .meaning = "coefficient of x in n^2"},
      numerics::Key{.name = "y_per_mm", .meaning = "coefficient of y in n^2"},
      numerics::Key{.name = "z_per_mm", .meaning = "coefficient of z in n^2"},
      numerics::Key{.name = "x2_per_mm2", .meaning = "coefficient of x^2 in n^2"},
      numerics::Key{.name = "y2_per_mm2", .meaning = "coefficient of y^2 in n^2"},
      numerics::Key{.name = "z2_per_mm2", .meaning = "coefficient of z^2 in n^2"}};

  double index = 1;
  Vec3<double> linear{}, quadratic{};

  template <class Parameters, class Arena>
  static Quadratic from(const Parameters& given, Arena&) {
    return {given.number("index"),
            {given.number("x_per_mm"), given.number("y_per_mm"), given.number("z_per_mm")},
            {given.number("x2_per_mm2"), given.number("y2_per_mm2"), given.number("z2_per_mm2")}};
  }

  template <class T>
  InMedium<T> at(const Vec3<T>& place) const {
    const auto l = numerics::vec3_cast<T>(linear), q = numerics::vec3_cast<T>(quadratic);
    const Vec3<T> of_square{q.x * place.x, q.y * place.y, q.z * place.z};
    return {T(index) * T(index) + dot(l + of_square, place), T(0.5) * l + of_square};
  }
  template <class T>
  T index_at(const Vec3<T>& place) const {
    using std::sqrt;
    return sqrt(at(place).squared_index);
  }
};

}  // namespace sagitta::gradient_index
