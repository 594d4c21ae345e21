// SPDX-License-Identifier: Apache-2.0
// The quadric of two vertex curvatures, the base of surfaces whose sections in x and y differ (biconic.h, toroid.h):
//
//   F = c_x x^2 + c_y y^2 + m z^2 - 2 z = 0,   z = N/(1 + sqrt(1 - m N)),   N = c_x x^2 + c_y y^2                      (1)
//
// A conic is the one of c_x = c_y = c, m = (1+K) c; a cylinder of conic section that of c_x = 0, m = (1+K) c_y. The line is met as conic.h's,
// (3) to (5), with c x^2 + c y^2 split up: the crossing in the line's own sense of travel, on the vertex's side of the equator.
//
// What departs from a quadric, z = S(x, y), is met by Newton's method on f = z - S from the quadric's hit at t = 0 on, to the end that first_crossing.h
// tells. It is the hit continuous with the quadric's if on the way, from 0 to t, no other crossing can be:
//   |f'(t)| > B |t|,   B >= |f''| on the way,   and the quadric's d_z - L z_x - M z_y has one sign at both ends             (2)
// (along a line its sag is convex or concave). Otherwise first_crossing.h goes the way in steps that pass no crossing.
//
// The quadric reaches out further than S. Where a line meets it beyond the equator of S, the hit comes over that equator while S grows out of the quadric:
// the way begins where the line, going towards the middle of the domain of S, passes the equator (found by halving, so the last 1e-9 of the way beside it
// are lost), and f must fall from there on; else the hit is still beyond, and the line misses S.                                                  (3)
#pragma once

#include "lib/surface/first_crossing.h"

namespace sagitta::surface {

// The rounding of a height and of its slopes, at most.
struct SagRounding {
  double height = 0, slope = 0;
};

struct Quadric {
  double curvature_x = 0, curvature_y = 0;
  double axial = 0;  // m

  // m of the quadric with the sections' curvatures and (1+K) c: that of the two m with which it reaches out as far as both sections; 0, a
  // paraboloid, of a saddle. A section that is straight has no say.
  static Quadric of(const Conic& x, const Conic& y) {
    const double m_x = (1 + x.conic_constant) * x.curvature, m_y = (1 + y.conic_constant) * y.curvature;
    const bool is_up = x.curvature > 0, is_saddle = is_up != (y.curvature > 0);
    const double m = x.curvature == 0 ? m_y : y.curvature == 0 ? m_x : is_saddle ? 0 : (m_x < m_y) == is_up ? m_x : m_y;
    return {x.curvature, y.curvature, m};
  }

  template <class T>
  T sag(const T& x, const T& y) const {
    using std::sqrt;
    const T N = T(curvature_x) * x * x + T(curvature_y) * y * y;
    return N / (T(1) + sqrt(T(1) - T(axial) * N));  // (1)
  }
  template <class T>
  Gradient<T> gradient(const T& x, const T& y) const {
    using std::sqrt;
    const T root = sqrt(T(1) - T(axial) * (T(curvature_x) * x * x + T(curvature_y) * y * y));
    return {T(curvature_x) * x / root, T(curvature_y) * y / root};
  }
  // Of N 3 roundings of its terms' sizes, of 1 - m N one more and its own.
  SagRounding rounding(double x, double y) const {
    const double u = std::numeric_limits<double>::epsilon() / 2, N = std::abs(curvature_x) * x * x + std::abs(curvature_y) * y * y;
    const double s = std::sqrt(1 - axial * (curvature_x * x * x + curvature_y * y * y)), of_s = (3 * std::abs(axial) * N + 1) * u / s + u * s, z = N / (1 + s);
    const auto slope = [&](double c, double at) { return std::abs(c * at) / s * (3 * u + of_s / s); };
    return {z * (6 * u + of_s / (1 + s)), slope(curvature_x, x) + slope(curvature_y, y)};
  }
  // Of the second derivative along the line up to a distance h to either side: with s = sqrt(1 - m N), z'' = N''/(2 s) + m N'^2/(4 s^3).
  template <class T>
  T bend_on(const Vec3<T>& at, const Vec3<T>& d, const T& within) const {
    using std::abs, std::sqrt;
    const T c_x = abs(T(curvature_x)), c_y = abs(T(curvature_y)), m(axial), L = abs(d.x), M = abs(d.y), X = abs(at.x) + L * within, Y = abs(at.y) + M * within;
    const T N_1 = T(2) * (c_x * L * X + c_y * M * Y), N_2 = T(2) * (c_x * L * L + c_y * M * M);
    const T s_squared = T(1) - m * (T(curvature_x) * at.x * at.x + T(curvature_y) * at.y * at.y) - abs(m) * N_1 * within;
    if (!(s_squared > T(0))) return T(std::numeric_limits<double>::infinity());
    const T s = sqrt(s_squared);
    return N_2 / (T(2) * s) + abs(m) * N_1 * N_1 / (T(4) * s * s_squared);
  }
  template <class T>
  Crossing<T> meet(const Vec3<T>& start, const Vec3<T>& d) const {
    const T c_x(curvature_x), c_y(curvature_y), m(axial);
    const NearestToVertex<T> from = nearest_to_vertex(start, d);
    const Vec3<T>& p = from.point;
    const T A = c_x * d.x * d.x + c_y * d.y * d.y + m * d.z * d.z;
    const T B = d.z - (c_x * d.x * p.x + c_y * d.y * p.y + m * d.z * p.z);
    const T C = c_x * p.x * p.x + c_y * p.y * p.y + m * p.z * p.z - T(2) * p.z;
    return crossing_of_quadric(from, d, c_x, c_y, m, A, B, C);
  }
};

// The shape has height(x, y), NaN outside its domain; T bend_on(at, d, h), infinite where there is no bound (first_crossing.h); and, for (3), T deepest_on(at, d), the
// t of a place on the line that is within its domain: NaN if there is none, anything if the shape cannot tell (then a line of (3) is not_converged).
template <class Shape>
struct QuadricDeparture {
  static constexpr int most_looks = 8;
  static constexpr int equator_halvings = 30;  // to 1e-9 of the way
  Quadric base;

  const Shape& self() const { return static_cast<const Shape&>(*this); }
  template <class T>
  T sag(const T& x, const T& y) const {
    return self().height(x, y).z;
  }
  template <class T>
  Gradient<T> gradient(const T& x, const T& y) const {
    const Height<T> h = self().height(x, y);
    return {h.dz_dx, h.dz_dy};
  }

  template <class T>
  Crossing<T> meet(const Vec3<T>& p, const Vec3<T>& d) const {
    using std::abs;
    const Crossing<T> start = base.meet(p, d);
    if (start.status != Status::ok) return start;
    const T eps = std::numeric_limits<T>::epsilon();
    const Vec3<T>& origin = start.point;
    const bool is_forward = start.along > T(0);
    T t(0);
    for (int look = 0; look < most_looks; ++look) {
      const Vec3<T> at = origin + t * d;
      const Height<T> h = self().height(at.x, at.y);
      const T f = at.z - h.z, slope = d.z - d.x * h.dz_dx - d.y * h.dz_dy, step = -f / slope;
      if constexpr (requires { self().deepest_on(origin, d); })
        if (look == 0 && !(f - f == T(0))) return meet_from_equator(start, d);
      if (!(step - step == T(0))) break;
      const T scale = abs(origin.x) + abs(origin.y) + abs(origin.z) + abs(t);
      const bool at_rounding = abs(f) <= eps * (abs(at.z) + h.magnitude);
      if (at_rounding || (abs(step) * (abs(d.x) + abs(d.y)) <= T(4) * eps * scale && abs(step) <= scale)) {
        const Gradient<T> of_base = base.gradient(at.x, at.y);
        const T base_along = d.z - d.x * of_base.x - d.y * of_base.y;
        const bool has_one_sense = is_forward ? slope > T(0) && base_along > T(0) : slope < T(0) && base_along < T(0);
        if (!has_one_sense || !(abs(slope) > T(1 + 1e-9) * self().bend_on(at, d, T(abs(t))) * abs(t))) break;  // (2)
        const T last = at_rounding ? t : t + step;
        return {start.path + last, origin + last * d, {-h.dz_dx, -h.dz_dy, T(1)}, slope, Status::ok};
      }
      t += step;
    }
    return first_crossing(self(), start, d);
  }

  // (3)
  template <class T>
  Crossing<T> meet_from_equator(const Crossing<T>& start, const Vec3<T>& d) const {
    const Vec3<T>& origin = start.point;
    const auto height = [&](const T& t) { return self().height(T(origin.x + t * d.x), T(origin.y + t * d.y)); };
    const auto is_defined = [](const Height<T>& h) { return h.z - h.z == T(0) && h.dz_dx - h.dz_dx == T(0) && h.dz_dy - h.dz_dy == T(0); };
    T outside(0), inside = self().deepest_on(origin, d);
    if (!is_defined(height(inside))) return no_crossing<T>(inside - inside == T(0) ? Status::not_converged : Status::missed);
    for (int halving = 0; halving < equator_halvings; ++halving) {
      const T middle = (outside + inside) / T(2);
      (is_defined(height(middle)) ? inside : outside) = middle;
    }
    const T f = origin.z + inside * d.z - height(inside).z;
    const bool leads_inward = ((f < T(0)) == (start.along > T(0))) == (inside > T(0));
    return leads_inward ? first_crossing(self(), start, d, inside) : no_crossing<T>(Status::missed);
  }
};

}  // namespace sagitta::surface
