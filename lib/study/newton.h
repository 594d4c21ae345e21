// SPDX-License-Identifier: Apache-2.0
// Where a ray meets an analytic surface, by Newton's method without a safeguard, to a tolerance that is asked for: what a study of
// tolerances needs. (The tracer's own iterations end at rounding: surface/conic_departure.h, surface/departure.h.)
//
//   f(t) = z(t) - S(x(t), y(t)),   t -> t - f/f',   f' = N - L dS/dx - M dS/dy                                      (1)
//
// from the hit on the sphere of the vertex's curvature, or on the plane z = 0 where the ray passes by that sphere, until
// |f| <= tolerance, mm: the place that was last looked at is the hit, so its error is of the size of the tolerance or, as (1) doubles the digits,
// far below. A conic has a closed form; here it too is iterated, as an asphere is.
//
// missed: S is undefined where (1) leads, or there is no plane z = 0 along the ray. not_converged: not within 50 looks.
//
// Source: Newton's method for ray intersection is Spencer and Murty's, J. Opt. Soc. Am. 52, 672 (1962), section 3.
#pragma once

#include <cmath>

#include "lib/surface/plane.h"
#include "lib/surface/sphere.h"

namespace sagitta::study {

struct NewtonHit {
  surface::Crossing<double> crossing;
  int looks = 0;  // evaluations of S and its gradient
};

struct SagAndSlope {
  double sag;
  surface::Gradient<double> slope;
};
template <class Shape>
SagAndSlope sag_and_slope(const Shape& shape, double x, double y) {
  if constexpr (requires { shape.height(x, y); }) {  // both in one evaluation
    const auto height = shape.height(x, y);
    return {height.z, {height.dz_dx, height.dz_dy}};
  } else {
    return {shape.sag(x, y), shape.gradient(x, y)};
  }
}

template <class Shape>
NewtonHit meet_to_tolerance(const Shape& shape, const numerics::Vec3<double>& p, const numerics::Vec3<double>& d, double tolerance) {
  constexpr int most_looks = 50;
  surface::Crossing<double> start = surface::Sphere{shape.vertex_curvature()}.meet(p, d);
  if (start.status != surface::Status::ok) start = surface::Plane{}.meet(p, d);
  if (start.status != surface::Status::ok) return {start};
  double t = 0;
  for (int look = 1; look <= most_looks; ++look) {
    const numerics::Vec3<double> q = start.point + t * d;
    const auto [sag, slope] = sag_and_slope(shape, q.x, q.y);
    const double f = q.z - sag, along = d.z - d.x * slope.x - d.y * slope.y;
    if (!(f - f == 0)) return {surface::no_crossing<double>(surface::Status::missed), look};
    if (std::abs(f) <= tolerance) return {{start.path + t, q, {-slope.x, -slope.y, 1}, along, surface::Status::ok}, look};
    t -= f / along;
  }
  return {surface::no_crossing<double>(surface::Status::not_converged), most_looks};
}

}  // namespace sagitta::study
