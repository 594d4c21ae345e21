// SPDX-License-Identifier: Apache-2.0
// Maxwell's fisheye, which images every point sharply:
//
//   n = n0/(1 + q),   q = (rho/a)^2, rho the distance from the centre (0, 0, z_c);   n grad n = -2 n^2/(a^2 (1 + q)) (place - centre)   (1)
//
// n0  index at the centre        a  radius at which the index is half of that, mm
//
// Rays are circles; those from P meet at -a^2 P/|P|^2 (from the centre), with an optical path of pi a n0/2. r x p is the same along each.
//
// Source: Maxwell, Cambridge and Dublin Math. J. 8, 188 (1854); Born and Wolf, Principles of Optics (7th ed. 1999), section 4.2.2.
#pragma once

#include "lib/gradient_index/polynomial.h"

namespace sagitta::gradient_index {

struct Maxwell {
  static constexpr std::string_view kind = "maxwell";
  static constexpr std::array keys{
      numerics::Key{.name = "index", .meaning = "n0: refractive index at the centre", .required = true, .range = indices},
      numerics::Key{.name = "radius_mm", .meaning = "a: where the index is half of that", .required = true, .range = numerics::positive},
      numerics::Key{.name = "center_z_mm", .meaning = "z of its centre from the vertex"}};

  double index = 1, radius = 1, centre_z = 0;

  template <class Parameters, class Arena>
  static Maxwell from(const Parameters& given, Arena&) {
    return {given.number("index"), given.number("radius_mm"), given.number("center_z_mm")};
  }

  template <class T>
  InMedium<T> at(const Vec3<T>& place) const {
    const FromCentre<T> from = from_centre(place, centre_z);
    const T per_square = T(1) / (T(radius) * T(radius)), shrinks = T(1) / (T(1) + from.squared * per_square), n = T(index) * shrinks;
    return {n * n, (T(-2) * n * n * shrinks * per_square) * from.offset};
  }
  template <class T>
  T index_at(const Vec3<T>& place) const {
    return T(index) / (T(1) + from_centre(place, centre_z).squared / (T(radius) * T(radius)));
  }
};

}  // namespace sagitta::gradient_index
