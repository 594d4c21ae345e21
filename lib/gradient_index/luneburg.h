// SPDX-License-Identifier: Apache-2.0
// Luneburg's lens: a ball that brings every collimated bundle to a point of its rim.
//
//   n^2 = n0^2 (2 - rho^2/R^2),   rho the distance from the centre (0, 0, z_c);   n grad n = -(n0/R)^2 (place - centre)  (1)
//
// n0  index at the rim rho = R, that of what is around it        R  radius of the ball, mm
//
// Rays are ellipses about the centre; r x p is the same along each. There is no such medium from rho = R sqrt(2) on.
//
// Source: Luneburg, Mathematical Theory of Optics (1964; lectures of 1944), section 29.
#pragma once

#include "lib/gradient_index/polynomial.h"

namespace sagitta::gradient_index {

struct Luneburg {
  static constexpr std::string_view kind = "luneburg";
  static constexpr std::array keys{
      numerics::Key{.name = "index", .meaning = "n0: refractive index at the rim", .range = indices, .fallback = 1},
      numerics::Key{.name = "radius_mm", .meaning = "R: radius of the ball", .required = true, .range = numerics::positive},
      numerics::Key{.name = "center_z_mm", .meaning = "z of its centre from the vertex"}};

  double index = 1, radius = 1, centre_z = 0;

  template <class Parameters, class Arena>
  static Luneburg from(const Parameters& given, Arena&) {
    return {given.number("index"), given.number("radius_mm"), given.number("center_z_mm")};
  }

  template <class T>
  InMedium<T> at(const Vec3<T>& place) const {
    const FromCentre<T> from = from_centre(place, centre_z);
    const T rim = T(index) * T(index), fall = -rim / (T(radius) * T(radius));
    return {T(2) * rim + fall * from.squared, fall * from.offset};
  }
  template <class T>
  T index_at(const Vec3<T>& place) const {
    using std::sqrt;
    return sqrt(at(place).squared_index);
  }
};

}  // namespace sagitta::gradient_index
