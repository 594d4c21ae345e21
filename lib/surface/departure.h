// SPDX-License-Identifier: Apache-2.0
// Where a line meets a surface z = S(x, y) that departs little from one whose hit is known (flat facets, a smooth surface under
// roughness), the base below: Newton's method, safeguarded. (Zernike surfaces may fold: first_crossing.h.)
//
//   f(t) = z(t) - S(x(t), y(t)),     f' = N - L dS/dx - M dS/dy = d . n,   n = (-dS/dx, -dS/dy, 1)                 (1)
//
// The iteration starts at the base's hit, and t counts from there, so f carries no digits of the distance
// travelled. A step is halved until |f| falls (S may be undefined beyond the step: that counts as not falling). Once two
// points with opposite signs of f are known they bracket the root, and a step that would leave the bracket is replaced
// by bisection.
//
// It ends when |f| is at the rounding of its own terms, eps (|z| + sum of the |terms| of S), or when a step moves (x, y) by
// less than rounding, |step| (|L| + |M|) <= 4 eps (|x| + |y| + |z|): S and its gradient are the same there, so that step is
// the last one and needs no further look. (A ray along z ends so at once.) A point is returned only if the line crosses
// the surface in the same sense as it crosses the base (otherwise the iteration has slipped over a fold to another
// hit); else the status is not_converged. A line that misses the base misses the surface.
//
// Source: the safeguard is that of Dennis and Schnabel, Numerical Methods for Unconstrained Optimization (1983),
// sections 2.5 and 6.3, for one variable.
#pragma once

#include <cmath>
#include <limits>

#include "lib/surface/conic.h"

namespace sagitta::surface {

// Height, gradient and the size of the terms that make the height (for its rounding error).
template <class T>
struct Height {
  T z, dz_dx, dz_dy;
  T magnitude;
};

inline constexpr int max_departure_steps = 100;

// From the point `origin` on, at path start_path; `forward` tells the sense in which the line crosses there (d.n > 0).
// `surface.height(x, y)` gives Height<T>; NaN where S is undefined.
template <class T, class Surface>
Crossing<T> meet_from(const T& start_path, const Vec3<T>& origin, bool forward, Surface&& surface, const Vec3<T>& d) {
  using std::abs;
  const T eps = std::numeric_limits<T>::epsilon();

  T t(0);
  Height<T> h = surface.height(origin.x, origin.y);
  T f = origin.z - h.z;
  if (!(f - f == T(0))) return no_crossing<T>(Status::not_converged);
  T below(0), above(0);  // bracket: f(below) < 0 < f(above)
  bool has_below = false, has_above = false;

  for (int step_count = 0; step_count < max_departure_steps; ++step_count) {
    const T slope = d.z - d.x * h.dz_dx - d.y * h.dz_dy;  // (1)
    if (!(slope - slope == T(0))) break;  // at the base's equator: no step could be told from none
    const T rounding = eps * (abs(origin.z + t * d.z) + h.magnitude);
    T step = -f / slope;
    const T scale = abs(origin.x) + abs(origin.y) + abs(origin.z) + abs(t);
    const bool is_last = abs(step) * (abs(d.x) + abs(d.y)) <= T(4) * eps * scale && abs(step) <= scale;
    if (abs(f) <= rounding || is_last) {
      if ((slope > T(0)) != forward) break;
      const T last = abs(f) <= rounding ? t : t + step;
      return {start_path + last, origin + last * d, {-h.dz_dx, -h.dz_dy, T(1)}, slope, Status::ok};
    }
    if (f < T(0)) {
      below = t;
      has_below = true;
    } else {
      above = t;
      has_above = true;
    }
    T next = t + step;
    if (has_below && has_above) {
      const bool inside = (next > below && next < above) || (next < below && next > above);
      if (!inside) next = (below + above) / T(2);
    }
    // Halve until |f| falls; within a bracket a bisection may let |f| rise, but the bracket shrinks.
    bool moved = false;
    for (int halving = 0; halving < 60; ++halving) {
      const Height<T> trial = surface.height(origin.x + next * d.x, origin.y + next * d.y);
      const T trial_f = origin.z + next * d.z - trial.z;
      if (trial_f - trial_f == T(0) && (abs(trial_f) < abs(f) || (has_below && has_above))) {
        t = next;
        h = trial;
        f = trial_f;
        moved = true;
        break;
      }
      next = (t + next) / T(2);
    }
    if (!moved) break;
  }
  return no_crossing<T>(Status::not_converged);
}

}  // namespace sagitta::surface
