// SPDX-License-Identifier: Apache-2.0
// Sphere through the origin: a conic (conic.h) of K = 0, for which everything shortens.
//
//   A = c,   B = N - c p.d,   C = c p.p - 2 z,   n = (-c x, -c y, 1 - c z),   |n| = 1                                   (1)
//
// in conic.h's (3) to (5): the normal is a unit vector, so that refraction needs no division (refraction.h).
#pragma once

#include "lib/surface/conic.h"

namespace sagitta::surface {

struct Sphere {
  static constexpr bool has_unit_normals = true;

  double curvature = 0;  // c, 1/mm

  static constexpr std::string_view kernel() { return "sphere"; }
  double vertex_curvature() const { return curvature; }
  template <class T>
  T sag(const T& x, const T& y) const {
    return Conic{curvature}.sag(x, y);
  }
  template <class T>
  Gradient<T> gradient(const T& x, const T& y) const {
    return Conic{curvature}.gradient(x, y);
  }

  template <class T>
  Crossing<T> meet(const Vec3<T>& start, const Vec3<T>& d) const {
    const T c = curvature;
    const NearestToVertex<T> from = nearest_to_vertex(start, d);
    const Vec3<T>& p = from.point;
    return crossing_of_quadric(from, d, c, c, c, c, T(d.z - c * dot(d, p)), T(c * dot(p, p) - T(2) * p.z));
  }
};

}  // namespace sagitta::surface
