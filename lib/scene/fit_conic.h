// SPDX-License-Identifier: Apache-2.0
// The sphere and the conic that fit scattered points best, centred on the z axis.
//
//   z = z0 + c u/(1 + sqrt(1 - q u)),   u = x^2 + y^2                                                              (1)
//
// z0  height of the vertex, mm    c  curvature, 1/mm    q = (1+K) c^2, 1/mm^2; for the sphere q = c^2
//
// min over (z0, c) or (z0, c, q) of the sum of squares of z - (1): differences along z, as topographers take them, with the
// vertex free along z and the centre on the axis ("float"). Gauss-Newton, each step by QR of the scaled Jacobian
//   d/dc = u/(1 + s) (sphere: u/(s (1 + s))),   d/dq = c u^2/(2 s (1 + s)^2),   s = sqrt(1 - q u)                  (2)
// and halved until the sum falls: the sphere from the parabola z0 + c u/2, the conic from the sphere. In q instead of K the
// conic is nearly linear in its parameters: steps are few, and a step too far puts points beyond the equator (NaN).
//
// A curvature that bends less than 1e-8 of the largest distance from the axis is 0: a plane. Where the points do not tell
// a conic constant (all at two distances from the axis, a plane, |K| > 100) the conic is the sphere.
//
// Source: J. Nocedal and S. Wright, Numerical Optimization (2nd ed., 2006), 10.3, for Gauss-Newton with shortened steps.
#pragma once

#include <optional>
#include <span>

#include "lib/numerics/vec3.h"
#include "lib/surface/conic.h"

namespace sagitta::scene {

struct FittedConic {
  double vertex_z = 0;
  surface::Conic conic;
  double rms = 0;  // mm, of z - (1)
};

struct BestFits {
  FittedConic sphere, conic;
  bool conic_is_sphere = true;  // the points do not tell a conic constant
};

// None where the points do not tell a curvature: fewer than 2, all at one distance from the axis, or not finite.
std::optional<BestFits> fit_sphere_and_conic(std::span<const numerics::Vec3<double>> points);

}  // namespace sagitta::scene
