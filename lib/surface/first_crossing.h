// SPDX-License-Identifier: Apache-2.0
// The crossing of a line with a base conic and a departure z = conic(x, y) + p(x, y) that is continuous with the base conic's, wherever the
// surface folds under the line: no crossing on the way to it is stepped over.
//
//   f(t) = z(t) - conic - p = g(t) - p,   g = z(t) - conic,   t from the base conic's hit on, where g = 0            (1)
//
// While the departure grows from 0 to p, lambda p, the hit moves from t = 0 the way along which f goes to 0, lambda = g/p. It is there for
// all lambda up to 1 exactly if lambda(t) rises all the way, and then it comes to the first zero of f. Where lambda stops
// rising the hit ends at a fold: the ray has none (not_converged).
//
// That way is gone in steps that cannot pass a zero: with |f''| <= M, F = |f| and its slope F' along the way, F stays above 0 for
//   h = 2 F/(-F' + sqrt(F'^2 + 2 M F)),                                                                              (2)
// which near a simple zero is Newton's step less M F^2/(2 |F'|^3): it doubles the digits, from one side. M holds for the part of the
// line in the disc of a radius R, which the step does not leave,
//   M = sin^2 (b_conic(R) + b_p(R)),   b_conic = |c|/min(1, 1 - (1+K) c^2 R^2)^(3/2),   sin^2 = L^2 + M^2             (3)
// and b_p(R) the surface's own bound of the second derivatives of p.
//
// It ends as departure.h does: when F is at the rounding of its terms, or with a step that moves (x, y) by less than rounding.
//
// Source: steps within a bound of the second derivative are those of Kalra and Barr, Computer Graphics 23, 297 (1989) (LG-surfaces), which
// bound the first two there for the same end.
#pragma once

#include "lib/surface/departure.h"

namespace sagitta::surface {

inline constexpr int most_first_crossing_looks = 1000;
// Far outside of what a departure is given for, its heights and slopes grow as high powers do; up to here their squares are numbers.
inline constexpr double largest_departure = 1e100;

// A step (2) that F does not come to 0 within, from `at` along d. The surface bounds its second derivative along the line up to a distance h to
// either side,
//   T bend_on(at, d, h),
// or it departs from a conic, (3), and has
//   T reach_from(r): a radius R > r to bound p within;   T bend_within(R): b_p(R).
template <class T, class Surface>
T safe_step(const Surface& surface, const Vec3<T>& at, const Vec3<T>& d, const T& F, const T& falls) {
  using std::abs, std::sqrt;
  const auto safe_with = [&](const T& bend) { return T(T(2) * F / (falls + sqrt(falls * falls + T(2) * bend * F))); };
  if constexpr (requires { surface.bend_on(at, d, F); }) {
    const T most = F + abs(at.x) + abs(at.y) + abs(at.z), at_most = safe_with(surface.bend_on(at, d, T(0)));
    T h = at_most <= most ? at_most : most;
    for (int halving = 0; halving < 60; ++halving, h = h / T(2)) {
      const T safe = safe_with(surface.bend_on(at, d, h));
      if (safe >= h) return h;
      if (T(2) * safe >= h) return safe;
    }
    return T(0);
  } else {
    const T c(surface.base.curvature), one_plus_K = T(1) + T(surface.base.conic_constant);
    const T sine_squared = d.x * d.x + d.y * d.y, sine = sqrt(sine_squared);
    const T r = sqrt(at.x * at.x + at.y * at.y), radicand = T(1) - one_plus_K * c * c * r * r;
    T within = surface.reach_from(r);
    if (!(T(1) - one_plus_K * c * c * within * within >= radicand / T(2))) within = sqrt((T(1) - radicand / T(2)) / one_plus_K) / abs(c);
    const T least = T(1) - one_plus_K * c * c * within * within;
    const T bend = sine_squared * (abs(c) / (least < T(1) ? least * sqrt(least) : T(1)) + surface.bend_within(within));
    const T safe = safe_with(bend);
    const T farthest = sine > T(0) ? T((within - r) / sine) : safe;
    return safe <= farthest ? safe : farthest;
  }
}

// The surface has base, height(x, y), and what safe_step asks for.
template <class T, class Surface>
Crossing<T> first_crossing(const Surface& surface, const Crossing<T>& start, const Vec3<T>& d) {
  using std::abs;
  const T eps = std::numeric_limits<T>::epsilon();
  const Vec3<T>& origin = start.point;
  T t(0), sense(0), sign(0);
  for (int look = 0; look < most_first_crossing_looks; ++look) {
    const Vec3<T> at = origin + t * d;
    const Height<T> h = surface.height(at.x, at.y);
    const T f = at.z - h.z, slope = d.z - d.x * h.dz_dx - d.y * h.dz_dy;
    if (look == 0) {
      sign = f < T(0) ? T(-1) : T(1);
      sense = (f < T(0)) == (start.along > T(0)) ? T(1) : T(-1);
    }
    const T F = sign * f, falls = -sign * sense * slope;  // -F'
    if (!(F + abs(h.dz_dx) + abs(h.dz_dy) <= T(largest_departure))) break;
    const T scale = abs(origin.x) + abs(origin.y) + abs(origin.z) + abs(t);
    const bool at_rounding = F <= eps * (abs(at.z) + h.magnitude);
    const T newton = F / falls;
    const bool is_last = falls > T(0) && newton * (abs(d.x) + abs(d.y)) <= T(4) * eps * scale && newton <= scale;
    if (at_rounding || is_last) {
      if (!(falls > T(0))) break;  // it touches
      const T last = at_rounding ? t : t + sense * newton;
      return {start.path + last, origin + last * d, {-h.dz_dx, -h.dz_dy, T(1)}, slope, Status::ok};
    }

    // lambda = g/p rises: g' p - g p' > 0, with g' = d.z - conic', p' = g' - f'
    const T base_z = surface.base.sag(at.x, at.y), g = at.z - base_z, p = h.z - base_z;
    const Gradient<T> base_slope = surface.base.gradient(at.x, at.y);
    const T g_t = d.z - d.x * base_slope.x - d.y * base_slope.y, p_t = g_t - slope;
    if (!(sense * (g_t * p - g * p_t) > T(0))) break;

    const T step = safe_step(surface, at, d, F, falls);
    if (!(step > T(0)) || !(step - step == T(0)) || t + sense * step == t) break;
    t += sense * step;
  }
  return no_crossing<T>(Status::not_converged);
}

}  // namespace sagitta::surface
