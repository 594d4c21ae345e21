// SPDX-License-Identifier: Apache-2.0
// Surface of revolution of a conic section about the z axis, vertex at the origin.
//
//   z = c r^2 / (1 + sqrt(1 - (1+K) c^2 r^2)),    r^2 = x^2 + y^2                                              (1)
//   F = c (x^2 + y^2 + (1+K) z^2) - 2 z = 0                                                                    (2)
//
// c   vertex curvature = 1/radius, 1/mm; 0 is a plane        K   conic constant: 0 sphere, -1 paraboloid
//
// The line p + t d put into (2) gives A t^2 - 2 B t + C = 0 with
//   A = c (L^2 + M^2 + (1+K) N^2),   B = N - c (L x + M y + (1+K) N z),   C = c (x^2 + y^2 + (1+K) z^2) - 2 z       (3)
// and along the line  -(1/2) dF/dt = B - A t = +-sqrt(B^2 - A C) = d . n,
//   n = -(1/2) grad F = (-c x, -c y, 1 - (1+K) c z),   |n|^2 = 1 - K c^2 r^2.                                       (4)
// So the root of the discriminant is the cosine of incidence times |n|: refraction needs no second root.
//
// Which root. n has a positive z component exactly on the vertex's side of the equator of the vertex's sheet. Of the
// two roots the hit is the one that the line crosses in its own sense of travel, d.n of the sign s of N:
//   t = C / (B + s sqrt(D)) = (B - s sqrt(D)) / A,       D = B^2 - A C                                             (5)
// For an ellipsoid it has the better z of the two; on a sheet of a hyperboloid or on a paraboloid it is the first
// that the line enters. Of the two forms of (5) the one without cancellation is taken, by the sign of s B. It is a
// miss if D < 0 or if n_z <= 0 there (beyond the equator, or on the other sheet).
//
// Errors. The line is first moved to its point nearest the vertex, p = start + e d, e = -start.d, so a start 1e9 mm away costs only the
// rounding of p itself; (3) holds wherever the line starts, so that rounding is not amplified, and t, which starts at the rounded p, takes
// most of it back. The path e + t is off by the rounding of its own size. No term of (5)
// divides by c or by 1+K: K = -1, a plane and 1e12 mm radii take the same path as any sphere.
// Moving to p and choosing between the forms of (5) take a tenth of a step's time (tools/bench, stability_*). Without the first a start k radii away
// costs 2 log10 k digits of the hit; without the second a ray along a paraboloid's axis, or one to a plane, is 0/0.
//
// Source: the vector form of Spencer and Murty, J. Opt. Soc. Am. 52, 672 (1962), eqs. 15 to 23, with its root chosen
// as above.
#pragma once

#include <array>
#include <cmath>

#include "lib/numerics/key.h"
#include "lib/surface/crossing.h"

namespace sagitta::surface {

// The point of a line from which the vertex is nearest, and the path to it.
template <class T>
struct NearestToVertex {
  T path;
  Vec3<T> point;
};
template <class T>
NearestToVertex<T> nearest_to_vertex(const Vec3<T>& start, const Vec3<T>& d) {
  const T path = -dot(start, d);
  return {path, start + path * d};
}

// (5), from that point and (3). axial = (1+K) c; the curvatures along x and y differ for other quadrics than conics (quadric.h).
template <class T>
Crossing<T> crossing_of_quadric(const NearestToVertex<T>& from, const Vec3<T>& d, const T& c_x, const T& c_y, const T& axial, const T& A, const T& B, const T& C) {
  using std::sqrt;
  const T root = sqrt(B * B - A * C);  // NaN: the line passes by
  const auto is_backward = d.z < T(0);
  const T along = negate_where<T>(is_backward, root), s_B = negate_where<T>(is_backward, B);
  const auto is_near = s_B >= T(0);
  const T t = select<T>(is_near, C, B - along) / select<T>(is_near, B + along, A);  // (5)
  const Vec3<T> point = from.point + t * d;
  const T nz = T(1) - axial * point.z;                 // (4)
  const auto hit = (nz > T(0)) & (t - t == T(0));      // t - t: neither NaN nor infinite
  const T path = from.path + t;  // formed whether or not there is a hit: loops over rays have no branches
  return {select<T>(hit, path, not_a_number<T>()), point, {-c_x * point.x, -c_y * point.y, nz}, along,
          StatusIn<T>::either(hit, Status::ok, Status::missed)};
}

// Of K: beyond 1e15 or so, K times the rounding of z leaves nothing of the normal.
inline constexpr numerics::Range conic_constants{.low = -1e9, .high = 1e9, .reason = "beyond, rounding leaves too few digits of the normal"};

struct Conic {
  static constexpr std::string_view kind = "conic";
  static constexpr std::array keys{
      numerics::Key{"radius_mm", numerics::ValueKind::number, "vertex radius of curvature, + when the centre is at +z",
                    true, numerics::nonzero_or_infinite},
      numerics::Key{"conic_constant", numerics::ValueKind::number, "K: 0 sphere, -1 paraboloid", false, conic_constants}};

  double curvature = 0;       // c, 1/mm
  double conic_constant = 0;  // K

  template <class Parameters, class Arena>
  static Conic from(const Parameters& given, Arena&) {
    return {1 / given.number("radius_mm"), given.number("conic_constant")};
  }

  double vertex_curvature() const { return curvature; }

  template <class T>
  T sag(const T& x, const T& y) const {
    using std::sqrt;
    const T c = curvature, r2 = x * x + y * y;
    return c * r2 / (T(1) + sqrt(T(1) - (T(1) + T(conic_constant)) * c * c * r2));  // (1); NaN beyond the equator
  }

  // dz/dr = c r / sqrt(1 - (1+K) c^2 r^2).
  template <class T>
  Gradient<T> gradient(const T& x, const T& y) const {
    using std::sqrt;
    const T c = curvature;
    const T root = sqrt(T(1) - (T(1) + T(conic_constant)) * c * c * (x * x + y * y));
    return {c * x / root, c * y / root};
  }

  template <class T>
  Crossing<T> meet(const Vec3<T>& start, const Vec3<T>& d) const {
    const T c = curvature, one_plus_K = T(1) + T(conic_constant);
    const NearestToVertex<T> from = nearest_to_vertex(start, d);
    const Vec3<T>& p = from.point;
    const T A = c * (d.x * d.x + d.y * d.y + one_plus_K * d.z * d.z);  // (3)
    const T B = d.z - c * (d.x * p.x + d.y * p.y + one_plus_K * d.z * p.z);
    const T C = c * (p.x * p.x + p.y * p.y + one_plus_K * p.z * p.z) - T(2) * p.z;
    return crossing_of_quadric(from, d, c, c, T(one_plus_K * c), A, B, C);
  }
};

}  // namespace sagitta::surface
