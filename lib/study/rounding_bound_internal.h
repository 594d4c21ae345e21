// SPDX-License-Identifier: Apache-2.0
// What rounding can do to a ray at one surface at most, by the formulas that the tracer evaluates: a forward error analysis, ray by ray.
//
// u = 2^-53. Counts of roundings are those of the code; a sum or product of k factors is off by at most k u of its terms' sizes (k u for
// gamma_k = k u/(1 - k u)). d, p' and t', P, n: direction, the line's point nearest the vertex and the path from there (of closed forms), hit, normal (not
// normalised); q the ray's place in the frame that it comes from, T what the frames on the way are shifted by, L the distance of
// that place from the surface's vertex, t the path, s = |d.n|, sigma = |n|/s = 1/cos I.
//
//   line      16 u f (|q| + |T|) + 2 u L + tau |t|       f frames that turn the ray (else 1/16: one sum); tau = 16 u f               (1)
//   hit       2 sigma line + e/s + 2 u (|P| + |t'|)      e what the surface's equation is off by at its root                        (2)
//             A t^2 - 2 B t + C moved by e has its root moved by (sqrt(s^2 + A e) - s)/A <= e/s, however small s is: no first order here
//   normal    |second derivatives| hit + its own rounding                                                                           (3)
//   s^2       by the discriminant (closed forms), or by d.n at the hit                                                             (4)
//   cosine behind   w^2 = (1 - mu^2) |n|^2 + mu^2 s^2:  dw <= d(w^2)/w, likewise for all w                                           (5)
//   direction behind   mu (tau + l) + |gamma| dn + |n| dgamma + rounding,  gamma of surface/refraction.h, l = 8 u of the length of d          (6)
//   path      hit + 16 u f (|q| + |T|) + (6 u + l) |t|;  OPL: index times that, and the sum's own rounding                         (7)
//
// e of (2):
//   conic     12 u (|A| t'^2 + 2 |B| |t'| + |C|), each of them with its terms' sizes: 7 roundings each, 5 of discriminant, root and quotient
//   plane     2 u |t| of the path
//   Zernike   2 eps (|z| + |p| + V), where the iteration ends, and what the sum is off by:  2 (N + 3) u sum |c_ij X^i Y^j| of a polynomial,
//             8 (N + 1) u V of the recurrence, V = sum |C_j N_j| T_n(max(1, rho)) (surface/zernike.h, (4))
//   sums of powers likewise, with 4 (N + 3) u of the terms' sizes; biconic, toroid, grid   2 eps (|z| + its terms) and surface/'s rounding()
//   points    8 u of the coordinates, 64 u of the largest coefficient of a patch, (nodes + 16) u of the terms of a radial interpolant; what a step over an edge
//             within `hit` changes
//
// Behind a gradient-index medium the line and the direction are off by what gradient_bound_internal.h estimates; at either side of one mu is off by what the indices change by within
// the hit and by their rounding, which adds to (5) and (6).
//
// Infinite: the analysis says nothing, because the hit may be off by a tenth of what the normal turns within, or by more.
//
// Source: Higham, Accuracy and Stability of Numerical Algorithms (2nd ed., 2002), lemmas 3.1 to 3.3; section 3.3 for bounds that go along with
// each number.
#pragma once

#include "lib/study/exact_steps_internal.h"

namespace sagitta::study {

struct RoundingBound {
  double position, direction, opl;  // of the ray behind
  double normal;                    // by which the unit normal is turned
  double turn = 0;                  // of the direction before
};

// What a ray is uncertain by as it comes: its line, where it is nearest the hit, and its direction.
struct Uncertainty {
  double line = 0, turn = 0;
};

// Of the step from `before`, in the frame of surface `from` (0: global), past dummies alone to surface `number`; `step` is the exact one.
RoundingBound rounding_bound(const View& view, int from, int number, const ExactRay& before, const ExactStep& step, const Uncertainty& given = {});

}  // namespace sagitta::study
