// SPDX-License-Identifier: Apache-2.0
// The crossing of a line with a base conic and a departure z = conic(x, y) + p(x, y) that is continuous with the base conic's, wherever the
// surface folds under the line: no crossing on the way to it is stepped over.
//
//   f(t) = z(t) - conic - p = g(t) - p,   g = z(t) - conic,   t from the base conic's hit on, where g = 0            (1)
//
// While the departure grows from 0 to p, lambda p, the hit moves from t = 0 the way along which f goes to 0, lambda = g/p. It is there for
// all lambda up to 1 exactly if lambda(t) rises all the way, and then it comes to the first zero of f. Where lambda stops
// rising, W = g' p - g p' <= 0 (taken along the way), the hit ends at a fold: the ray has none (not_converged).
//
// That way is gone in steps that cannot pass a zero of f: with F = |f|, its slope F' along the way and |g''| <= g_2, |p''| <= p_2, F stays above 0 for
//   h = 2 F/(-F' + sqrt(F'^2 + 2 (g_2 + p_2) F)),                                                                    (2)
// which near a simple zero is Newton's step less (g_2 + p_2) F^2/(2 |F'|^3): it doubles the digits, from one side. Nor may a step pass a fold: with W at
// its two ends, W between them is at least the larger of
//   (W_a + W_b - h |W'|)/2,          W'  = g'' p - g p''
//   min(W_a, W_b) - h^2/8 |W''|,     W'' = g''' p + g'' p' - g' p'' - g p'''                                         (3)
// where g, g', p, p' are bounded by their values at the ends and a later derivative. If that is not above 0 the step is made again, half as long.
//
// The bounds hold for the part of the line in the disc of a radius R, which a step does not leave. Of a conic, with q = (1+K) c^2 and s^2 = L^2 + M^2,
//   g_2 = s^2 |c|/u^3,   g_3 = 3 s^3 |c| q R/u^5,   u^2 = 1 - q R^2;   for q < 0  u = 1, g_3 = 6/sqrt(27) s^3 |c| sqrt(-q)    (4)
//
// It ends as departure.h does: when F is at the rounding of its terms, or with a step that moves (x, y) by less than rounding.
//
// Source: steps within a bound of the second derivative are those of Kalra and Barr, Computer Graphics 23, 297 (1989) (LG-surfaces), which
// bound the first two there for the same end.
#pragma once

#include "lib/surface/departure.h"

namespace sagitta::surface {

inline constexpr int most_first_crossing_looks = 1000;
inline constexpr int most_looks_from_an_edge = 10000;  // where slopes are infinite, and steps therefore short
// Far outside of what a departure is given for, its heights and slopes grow as high powers do; up to here their squares are numbers.
inline constexpr double largest_departure = 1e100;

// A step and what bounds the second and third derivatives of g and p on it.
template <class T>
struct BoundedStep {
  T length, g_2, p_2, g_3, p_3;
};

// By (2). The surface has base, height(x, y), and departs from a conic with
//   T reach_from(r): a radius R > r to bound p within;   T bound_within(R, k): of the k-th derivatives of p along lines, k = 2 and 3;
// or else it bounds its second derivative along the line up to a distance h to either side, and so does its base,
//   T bend_on(at, d, h).
template <class T, class Surface>
BoundedStep<T> bounded_step(const Surface& surface, const Vec3<T>& at, const Vec3<T>& d, const T& F, const T& falls) {
  using std::abs, std::sqrt;
  const auto safe_with = [&](const T& bend) { return T(T(2) * F / (falls + sqrt(falls * falls + T(2) * bend * F))); };
  if constexpr (requires { surface.bend_on(at, d, F); }) {
    const T most = F + abs(at.x) + abs(at.y) + abs(at.z), at_most = safe_with(surface.bend_on(at, d, T(0))), unknown(std::numeric_limits<double>::infinity());
    T h = at_most <= most ? at_most : most, bend(0);
    for (int halving = 0; halving < 60; ++halving, h = h / T(2)) {
      bend = surface.bend_on(at, d, h);
      const T safe = safe_with(bend);
      if (T(2) * safe >= h) {
        h = safe <= h ? safe : h;
        break;
      }
    }
    const T g_2 = surface.base.bend_on(at, d, h);
    return {h, g_2, bend + g_2, unknown, unknown};
  } else {
    const T c(surface.base.curvature), q = (T(1) + T(surface.base.conic_constant)) * c * c;
    const T s_squared = d.x * d.x + d.y * d.y, s = sqrt(s_squared);
    const T r = sqrt(at.x * at.x + at.y * at.y), radicand = T(1) - q * r * r;
    T R = surface.reach_from(r);
    if (!(T(1) - q * R * R >= radicand / T(2))) R = sqrt((T(1) - radicand / T(2)) / q);
    const T u_squared = q < T(0) ? T(1) : T(T(1) - q * R * R), u_cubed = u_squared * sqrt(u_squared), g_2 = s_squared * abs(c) / u_cubed;
    const T per_g_2 = q < T(0) ? T(T(1.16) * sqrt(-q)) : T(T(3) * q * R / u_squared);  // 6/sqrt(27) < 1.16
    const T p_2 = s_squared * surface.bound_within(R, 2), p_3 = s * s_squared * surface.bound_within(R, 3);
    const T safe = safe_with(T(g_2 + p_2)), farthest = s > T(0) ? T((R - r) / s) : safe;
    return {safe <= farthest ? safe : farthest, g_2, p_2, s * g_2 * per_g_2, p_3};
  }
}

// A place on the way.
template <class T>
struct OnTheWay {
  T t, F, falls;  // falls = -F'
  T g, g_t, p, p_t, W;
};

// Whether W stays above 0 between two places, (3).
template <class T>
bool rises_between(const OnTheWay<T>& a, const OnTheWay<T>& b, const BoundedStep<T>& step) {
  using std::abs;
  const auto most = [](const T& x, const T& y) { return abs(x) > abs(y) ? T(abs(x)) : T(abs(y)); };
  const T h = step.length, eighth = h * h / T(8), g = most(a.g, b.g) + step.g_2 * eighth, p = most(a.p, b.p) + step.p_2 * eighth;
  if (a.W + b.W > h * (step.g_2 * p + g * step.p_2)) return true;
  const T g_t = most(a.g_t, b.g_t) + step.g_3 * eighth, p_t = most(a.p_t, b.p_t) + step.p_3 * eighth;
  return (a.W < b.W ? a.W : b.W) > eighth * (step.g_3 * p + step.g_2 * p_t + g_t * step.p_2 + g * step.p_3);
}

// The surface has what bounded_step asks for. The way begins at t = first, where the base's hit lies outside the surface's domain (quadric.h).
template <class T, class Surface>
Crossing<T> first_crossing(const Surface& surface, const Crossing<T>& start, const Vec3<T>& d, const T& first = T(0)) {
  using std::abs;
  const T eps = std::numeric_limits<T>::epsilon();
  const Vec3<T>& origin = start.point;
  T sense(0), sign(0);  // of the way, and of f on it
  BoundedStep<T> step{};
  OnTheWay<T> here{};
  here.t = first;
  bool is_halved = false;  // the step: then the next one is at most twice as long
  const int most_looks = first == T(0) ? most_first_crossing_looks : most_looks_from_an_edge;
  for (int look = 0; look < most_looks; ++look) {
    const T t = here.t + sense * step.length;
    if (look > 0 && !(sense * (t - here.t) > T(0))) break;  // NaN too
    const Vec3<T> at = origin + t * d;
    const Height<T> h = surface.height(at.x, at.y);
    const Gradient<T> base_slope = surface.base.gradient(at.x, at.y);
    const T base_z = surface.base.sag(at.x, at.y), g = at.z - base_z, p = h.z - base_z, f = at.z - h.z;
    const T slope = d.z - d.x * h.dz_dx - d.y * h.dz_dy, g_t = d.z - d.x * base_slope.x - d.y * base_slope.y, p_t = g_t - slope;
    if (look == 0) {
      sign = f < T(0) ? T(-1) : T(1);
      sense = (f < T(0)) == (start.along > T(0)) ? T(1) : T(-1);
    }
    const OnTheWay<T> there{t, sign * f, -sign * sense * slope, g, g_t, p, p_t, sense * (g_t * p - g * p_t)};
    if (!(there.F + abs(h.dz_dx) + abs(h.dz_dy) <= T(largest_departure))) break;

    const T scale = abs(origin.x) + abs(origin.y) + abs(origin.z) + abs(t), newton = there.F / there.falls;
    const bool at_rounding = there.F <= eps * (abs(at.z) + h.magnitude);
    const bool is_last = there.falls > T(0) && newton * (abs(d.x) + abs(d.y)) <= T(4) * eps * scale && newton <= scale;
    if (!at_rounding && !(there.W > T(0))) break;
    const bool is_same_place = step.length * (abs(d.x) + abs(d.y)) <= T(4) * eps * scale;
    if (!is_same_place && !rises_between(here, there, step)) {
      step.length = step.length / T(2);
      is_halved = true;
      continue;
    }
    if (at_rounding || is_last) {
      if (!(there.falls > T(0))) break;  // it touches
      const T last = at_rounding ? t : t + sense * newton;
      return {start.path + last, origin + last * d, {-h.dz_dx, -h.dz_dy, T(1)}, slope, Status::ok};
    }
    const T longest = is_halved ? T(T(2) * step.length) : T(std::numeric_limits<double>::infinity());
    here = there;
    step = bounded_step<T>(surface, at, d, here.F, here.falls);
    is_halved = step.length > longest;
    if (is_halved) step.length = longest;
  }
  return no_crossing<T>(Status::not_converged);
}

}  // namespace sagitta::surface
