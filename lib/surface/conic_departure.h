// SPDX-License-Identifier: Apache-2.0
// What surfaces that depart from a base conic have in common:
//
//   z = conic(r; c, K) + p(x, y),   p a smooth sum (Zernike polynomials, powers)                                       (1)
//
// The domain is the conic's. The hit is the one continuous with the base conic's (first_crossing.h).
//
// Intersection. From the conic's hit on, Newton's method on the implicit form, in which no root appears:
//   g(t) = w - c/2 (x^2 + y^2 + (1+K) w^2) = 0,   w = z - p(x, y)                                                   (2)
//   g' = G (d_z - p_x d_x - p_y d_y) - c (x d_x + y d_y),   G = 1 - (1+K) c w > 0 on the sheet of the vertex.
// It ends when |g| is at its rounding, or with a step that moves (x, y) by less than rounding, so that p stays what it is, if
// what g'' adds is below rounding too. What it finds is the hit if no other crossing can be on the way: the slope of the conic along the
// line lies between those at both ends, for its sag is convex or concave, and with a bound |grad p| <= G,
//   d_z - L dz/dx - M dz/dy keeps its sign if at both ends that of the conic alone is beyond sqrt(L^2 + M^2) G.        (3)
// Where it does not end at once, or (3) does not hold, first_crossing.h goes the way in steps that pass no crossing.
//
// A shape is derived from ConicDeparture<Shape> and has
//   Sum<T> sum_of_polynomial(x, y)         p and its gradient, for T in lanes too; sum(x, y) besides, where that is not always it
//   T size_of_terms(x, y)                  sum of the |terms| of p, for its rounding
//   double size_at_any_place               the same where it is known without the place; else 0, and the iteration looks once more
//   T steepest_squared_within(r_squared)   G^2 within that radius; infinite where it is not known
//   bound_within(R, k), reach_from(r)      first_crossing.h
#pragma once

#include <limits>

#include "lib/numerics/polynomial.h"
#include "lib/surface/departure_block.h"
#include "lib/surface/first_crossing.h"

namespace sagitta::surface {

// The base's keys.
inline constexpr numerics::Key base_radius_key{.name = "radius_mm", .meaning = "vertex radius of the base conic",
                                               .range = numerics::nonzero_or_infinite, .fallback = std::numeric_limits<double>::infinity()};
inline constexpr numerics::Key base_conic_constant_key{.name = "conic_constant", .meaning = "K of the base conic: 0 sphere, -1 paraboloid", .range = conic_constants};

// The rounding of a sum and of its slopes, at most; the size of its terms.
struct SumRounding {
  double value = 0, slope = 0, terms = 0;
};

template <class Shape>
struct ConicDeparture {
  Conic base;

  // The sum and its gradient along x and y, in mm and 1.
  template <class T>
  using Sum = numerics::Polynomial::WithGradient<T>;

  const Shape& self() const { return static_cast<const Shape&>(*this); }
  template <class T>
  Sum<T> sum(const T& x, const T& y) const {
    return self().sum_of_polynomial(x, y);
  }

  template <class T>
  Height<T> height(const T& x, const T& y) const {
    using std::abs;
    const Sum<T> p = self().sum(x, y);
    const T base_z = base.sag(x, y);
    const Gradient<T> slope = base.gradient(x, y);
    return {base_z + p.value, slope.x + p.along_x, slope.y + p.along_y, abs(base_z) + abs(p.value) + self().size_of_terms(x, y)};
  }

  template <class T>
  T sag(const T& x, const T& y) const {
    return height(x, y).z;
  }
  template <class T>
  Gradient<T> gradient(const T& x, const T& y) const {
    const Height<T> h = height(x, y);
    return {h.dz_dx, h.dz_dy};
  }
  template <class T>
  Crossing<T> meet(const Vec3<T>& p, const Vec3<T>& d) const {
    const Crossing<T> start = base.meet(p, d);
    if (start.status != Status::ok) return start;
    Approach<T> approach;
    for (int look = 0; look < most_looks && approach.state == T(Approach<T>::going); ++look)
      approach = look_at(start.point, d, approach, self().sum(start.point.x + approach.t * d.x, start.point.y + approach.t * d.y), look == 0);
    if (approach.state != T(Approach<T>::arrived) || !passes_no_other(start.point, d, approach)) return first_crossing(self(), start, d);
    const Vec3<T> normal{-approach.slope_x, -approach.slope_y, T(1)};
    return {start.path + approach.t, start.point + approach.t * d, normal, dot(normal, d), Status::ok};
  }
  void meet_block(const BlockOfLines& lines, BlockOfCrossings& crossings) const { meet_departures(self(), lines, crossings); }

  // The iteration on (2): where the next look is; where the last one was, g there, and the slopes of the surface.
  static constexpr int most_looks = 5;
  template <class T>
  struct Approach {
    static constexpr double going = 0, arrived = 1, given_up = 2;
    T t{}, old_t{}, g{}, slope_x{}, slope_y{}, state{};
    T base_along{};  // d_z - L dz/dx - M dz/dy of the conic alone, there
  };
  // In select form, for T in lanes; what no longer goes on stays as it is.
  template <class T>
  Approach<T> look_at(const Vec3<T>& origin, const Vec3<T>& d, const Approach<T>& before, const Sum<T>& p, bool is_first) const {
    using std::abs;
    const T eps = std::numeric_limits<T>::epsilon();
    const T c(base.curvature), one_plus_K = T(1) + T(base.conic_constant), t = before.t;
    const T x = origin.x + t * d.x, y = origin.y + t * d.y, z = origin.z + t * d.z, w = z - p.value;
    const T G = T(1) - one_plus_K * c * w;
    const T g = w - T(0.5) * c * (x * x + y * y + one_plus_K * w * w);
    const T w_t = d.z - p.along_x * d.x - p.along_y * d.y;
    const T along = G * w_t - c * (x * d.x + y * d.y), forward = negate_where<T>(d.z < T(0), along);
    const T step = -g / along, next = t + step;
    const T scale = abs(origin.x) + abs(origin.y) + abs(origin.z) + abs(t);
    const T bend = T(0.5) * abs(c) * (d.x * d.x + d.y * d.y + abs(one_plus_K) * w_t * w_t);  // the conic's part of -g''/2
    const auto is_last = (abs(step) * (abs(d.x) + abs(d.y)) <= T(4) * eps * scale) & (bend * step * step <= eps * scale * abs(along));
    const auto at_rounding = abs(g) <= eps * G * (abs(z) + abs(p.value) + T(self().size_at_any_place));
    const auto ends = at_rounding | is_last;
    const auto is_on_sheet = (G > T(0)) & (forward > T(0));  // false for NaN
    const T per_G = T(1) / (G - one_plus_K * c * (w_t * step));  // behind the step: the last one may be long along z
    const auto goes = before.state == T(Approach<T>::going);
    auto sound = is_on_sheet, in_bracket = is_on_sheet;
    if (!is_first) {
      sound = sound & (abs(g) < abs(before.g));
      in_bracket = (g * before.g > T(0)) | ((next - before.old_t) * (next - t) < T(0));
    }
    const T arrived(Approach<T>::arrived), given_up(Approach<T>::given_up), going(Approach<T>::going);
    const T after = select<T>(sound & ends, arrived, select<T>(sound & in_bracket, going, given_up));
    return {select<T>(goes & !at_rounding, next, t), t, g, select<T>(goes, c * x * per_G + p.along_x, before.slope_x),
            select<T>(goes, c * y * per_G + p.along_y, before.slope_y), select<T>(goes, after, before.state),
            select<T>(goes, d.z - c * (x * d.x + y * d.y) * per_G, before.base_along)};
  }
  // (3), with room for its own rounding.
  template <class T>
  auto passes_no_other(const Vec3<T>& origin, const Vec3<T>& d, const Approach<T>& end) const {
    const T c(base.curvature), n_z = T(1) - (T(1) + T(base.conic_constant)) * c * origin.z;
    const T along = n_z * d.z - c * (origin.x * d.x + origin.y * d.y), x = origin.x + end.t * d.x, y = origin.y + end.t * d.y;
    const T r_squared = origin.x * origin.x + origin.y * origin.y, end_r_squared = x * x + y * y;
    const T slopes = T(1 + 1e-9) * (d.x * d.x + d.y * d.y) * self().steepest_squared_within(select<T>(r_squared > end_r_squared, r_squared, end_r_squared));
    return (along * end.base_along > T(0)) & (along * along > n_z * n_z * slopes) & (end.base_along * end.base_along > slopes);
  }
};

}  // namespace sagitta::surface
