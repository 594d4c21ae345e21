// SPDX-License-Identifier: Apache-2.0
// A rod of self-focusing glass, the index falling across the axis by its square:
//
//   n^2 = n0^2 (1 - g^2 r^2),   r^2 = x^2 + y^2;   n grad n = -n0^2 g^2 (x, y, 0)                                   (1)
//
// n0  index on the axis        g  1/mm; the pitch of paraxial rays is 2 pi/g
//
// Every ray is a pair of sines in z with the same pitch 2 pi beta/(n0 g), beta = n cos(angle to the axis), which no ray changes. There is no such medium from
// r = 1/g on.
//
// Source: Fletcher, Murphy and Young, Proc. R. Soc. London A 223, 216 (1954); Uchida et al., IEEE J. Quantum Electron. 6, 606 (1970).
#pragma once

#include "lib/gradient_index/polynomial.h"

namespace sagitta::gradient_index {

struct Selfoc {
  static constexpr std::string_view kind = "selfoc";
  static constexpr std::array keys{
      numerics::Key{.name = "index", .meaning = "n0: refractive index on the axis", .required = true, .range = indices},
      numerics::Key{.name = "g_per_mm", .meaning = "g of n^2 = n0^2 (1 - g^2 r^2)", .required = true}};

  double index = 1, g = 0;

  template <class Parameters, class Arena>
  static Selfoc from(const Parameters& given, Arena&) {
    return {given.number("index"), given.number("g_per_mm")};
  }

  template <class T>
  InMedium<T> at(const Vec3<T>& place) const {
    const T on_axis = T(index) * T(index), fall = -on_axis * (T(g) * T(g));
    return {on_axis + fall * (place.x * place.x + place.y * place.y), {fall * place.x, fall * place.y, T(0)}};
  }
  template <class T>
  T index_at(const Vec3<T>& place) const {
    using std::sqrt;
    return sqrt(at(place).squared_index);
  }
};

}  // namespace sagitta::gradient_index
