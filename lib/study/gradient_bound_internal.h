// SPDX-License-Identifier: Apache-2.0
// What is uncertain of a ray where it comes to a surface through a gradient-index medium: what its steps' tolerance leaves, what rounding does within them, and what it was
// uncertain by before, each carried to the hit by the ray's own variations.
//
// r, p, S of a ray at the optical parameter t (gradient_index/leap.h); M(t) = d(r, p)(t)/d(r, p)(end), along the ray back from its hit. M is symplectic: with
//   M = (A B; C D),   M^-1 = (D' -B'; -C' A')                                                                       (1)
// what (r, p) is off by at t is at the end
//   |dr_end| <= |D| |dr| + |B| |dp|,   |dp_end| <= |C| |dr| + |A| |dp|,   |dS_end| <= |dS| + |S_r| |dr_end| + |S_p| |dp_end|   (2)
// S_r, S_p the derivatives of the path between t and the end; sizes are Frobenius norms. One step is off by no more than
//   tolerance + 64 eps |its increment| + rounding                                                                   (3)
// of each of r, p, S: the larger of the first two is what the error estimate of the pair of order 12(10) is held to, which is that of its lower order; rounding is carried along in
// the same arithmetic (carried_internal.h), in steps of this analysis's own: short enough for the variations too. With N steps of the tracer and M of these, and 2 for the
// one that meets the surface and the straight rest there,
//   off at the end <= 2 ((N + 2) max over t of (2) with the tolerance + (M + 2) that with the rest of (3)) + (2) with what the ray was uncertain by at its start   (4)
// 2 for what the variations change by within a step.
//
// This is an estimate where the rest of rounding_bound_internal.h is a bound: that a step's error is not above its estimate, and that variations are enough (the error is
// small against what the gradient changes within), is known of smooth media and not proven. None where the ray does not arrive, takes more steps than the
// tracer allows, or comes to where rounding is without a bound.
#pragma once

#include <optional>

#include "lib/study/rounding_bound_internal.h"

namespace sagitta::study {

// A ray at its hit, in doubles, and what it is uncertain by there.
struct AtGradient {
  Vec3<double> arriving;              // its direction
  double line, turn, opl;             // of it
  double path;                        // the optical path in the gradient
  double index_before, index_behind;  // at the hit
  double slope_before, slope_behind;  // by which these change with the place, 1/mm
  double index_rounding;              // of their ratio
};

// Of a surface with a gradient before or behind it, the ray as it comes into its frame (`step`), with `given` already in it.
std::optional<AtGradient> at_gradient(const View& view, int number, const ExactStep& step, const Uncertainty& given);

}  // namespace sagitta::study
