// SPDX-License-Identifier: Apache-2.0
// One triangle of a C1 piecewise cubic: the Clough-Tocher element on the centroid split, told as its departure from the
// flat facet between the same corners.
//
// The triangle (V0, V1, V2) is divided at its centroid C into three. Over each third the surface departs from the facet's
// plane by a cubic in Bernstein form,
//   D = sum_{a+b+c=3} b_abc 3!/(a! b! c!) l_i^a l_j^b l_c^c                                                        (1)
// in the barycentric coordinates of that third. The 19 coefficients follow from 12 data: value and gradient at the
// corners, and the slope across each edge at its midpoint. With z_i and gradient g_i at V_i, and edge k opposite to V_k
// between V_i and V_j, they are
//   at a corner           0, since the plane passes through it
//   from V_i to V_j       e_ij = (g_i.(V_j - V_i) - (z_j - z_i))/3                                                 (2)
//   from V_i to C         s_i = (e_ij + e_ik)/3
//   middle of third k     q_k, such that the derivative toward C at the edge's midpoint is what the slope there says
//   near C toward V_i     n_i = (s_i + q_j + q_k)/3                                                                (3)
//   at C                  the mean of the n_i
// (3) joins the thirds with one tangent plane. Across an edge, value and gradient depend on the edge's own data alone, so
// neighbouring triangles join likewise, to rounding. Only e and q are stored.
//
// Exact for cubics when the 12 data are; sag error O(h^4), slope O(h^3).
//
// A line meets a third where a cubic in one variable is zero. With l and v the coordinates of a point and of a direction,
// B(.,.,.) the polar form of (1) (linear in each argument, B(l,l,l) = D), and t counted from the line's point on the plane,
//   f(t) = along t - B(l,l,l) - 3 B(l,l,v) t - 3 B(l,v,v) t^2 - B(v,v,v) t^3 = 0,   along = d_z - slope . d       (4)
// No height enters (4), only departures from the plane: its root is as exact as the hit on the plane is.
//
// Source: R. W. Clough and J. L. Tocher, Proc. Conf. Matrix Methods in Structural Mechanics (1965), 515; in Bernstein form
// P. Alfeld, Computer Aided Geometric Design 1, 169 (1984). Polar forms: L. Ramshaw, Computer Aided Geometric Design 6, 323
// (1989).
#pragma once

#include <cmath>
#include <limits>

#include "lib/surface/crossing.h"
#include "lib/surface/mesh.h"

namespace sagitta::surface {

// Places this far outside a patch, in barycentric coordinates, count as inside: the same on both sides of an edge, and far
// above rounding.
inline constexpr double patch_slack = 1e-12;

struct alignas(64) CloughTocherPatch {
  double x, y, z;                       // C, mm, on the plane
  double m1_x, m1_y, m2_x, m2_y;        // gradients of the triangle's barycentric coordinates of V1 and V2, 1/mm
  double e01, e12, e20, e10, e21, e02;  // (2)
  double q0, q1, q2;

  struct Slope {
    double x, y;
  };

  // Barycentric coordinates in the triangle, of a place or of a direction.
  template <class T>
  struct Weights {
    T m0, m1, m2;
  };
  template <class T>
  [[gnu::always_inline]] Weights<T> locate(const T& at_x, const T& at_y) const {
    const T dx = at_x - T(x), dy = at_y - T(y), third = T(1) / T(3);
    const T m1 = third + T(m1_x) * dx + T(m1_y) * dy, m2 = third + T(m2_x) * dx + T(m2_y) * dy;
    return {T(1) - m1 - m2, m1, m2};
  }
  template <class T>
  [[gnu::always_inline]] Weights<T> toward(const T& dx, const T& dy) const {
    const T m1 = T(m1_x) * dx + T(m1_y) * dy, m2 = T(m2_x) * dx + T(m2_y) * dy;
    return {-m1 - m2, m1, m2};
  }

  // Height and gradient; beyond the triangle the cubic of the nearest third goes on.
  template <class T>
  struct Sheet {
    T z, dz_dx, dz_dy;
  };
  template <class T>
  Sheet<T> evaluate(const T& at_x, const T& at_y, const Facet& plane) const;

  // From the point (from_x, from_y) of the plane, with its slopes, along d: t of (4) and the gradient there. It is `sound` if t solves (4) to
  // its rounding, on the third that it started from, and the line crosses in its own sense. In select form, so that loops
  // over it become vectors.
  template <class T>
  struct Arrival {
    T t, dz_dx, dz_dy;
    bool is_sound;
  };
  template <class T>
  [[gnu::always_inline]] Arrival<T> arrive(const T& from_x, const T& from_y, const Vec3<T>& d, const T& plane_x, const T& plane_y) const;

  struct Corner {
    numerics::Vec3<double> vertex;
    Slope slope;
  };
  // `plane` is the facet between the corners, `at_midpoint[k]` a gradient at the midpoint of edge k of which the part across
  // the edge counts.
  static CloughTocherPatch of(const Corner (&corners)[3], const Facet& plane, const Slope (&at_midpoint)[3]);

 private:
  // A third's own coordinates: with m of the triangle, k its edge, and i, j, k anticlockwise,
  //   l_i = m_i - m_k,  l_j = m_j - m_k,  l_c = 3 m_k                                                                (5)
  template <class T>
  struct Local {
    T i, j, c;
  };
  // One argument of B given, then the second.
  template <class T>
  struct Quadratic {
    T b200, b020, b002, b110, b101, b011;
    [[gnu::always_inline]] Local<T> polar(const Local<T>& l) const {
      return {l.i * b200 + l.j * b110 + l.c * b101, l.i * b110 + l.j * b020 + l.c * b011, l.i * b101 + l.j * b011 + l.c * b002};
    }
  };
  template <class T>
  struct Third {
    T k;                                              // 0, 1 or 2; a number as those that are selected by it
    T b210, b120, b201, b021, b111, b102, b012, b003;  // b300 = b030 = 0

    template <class U>
    [[gnu::always_inline]] U pick(const U& of_0, const U& of_1, const U& of_2) const {
      const U not_0 = k == T(1) ? of_1 : of_2;
      return k == T(0) ? of_0 : not_0;
    }
    [[gnu::always_inline]] Local<T> local(const Weights<T>& w) const {
      const T m_k = pick(w.m0, w.m1, w.m2);
      return {pick(w.m1, w.m2, w.m0) - m_k, pick(w.m2, w.m0, w.m1) - m_k, T(3) * m_k};
    }
    [[gnu::always_inline]] Quadratic<T> polar(const Local<T>& l) const {
      return {l.j * b210 + l.c * b201,
              l.i * b120 + l.c * b021,
              l.i * b102 + l.j * b012 + l.c * b003,
              l.i * b210 + l.j * b120 + l.c * b111,
              l.i * b201 + l.j * b111 + l.c * b102,
              l.i * b111 + l.j * b021 + l.c * b012};
    }
  };
  // The third that holds a place: on the edge whose opposite corner weighs least.
  template <class T>
  [[gnu::always_inline]] Third<T> third_at(const Weights<T>& w) const {
    const T per_3 = T(1) / T(3);
    const T s0 = (T(e01) + T(e02)) * per_3, s1 = (T(e12) + T(e10)) * per_3, s2 = (T(e20) + T(e21)) * per_3;
    const T n0 = (s0 + (T(q1) + T(q2))) * per_3, n1 = (s1 + (T(q2) + T(q0))) * per_3, n2 = (s2 + (T(q0) + T(q1))) * per_3;
    Third<T> b;
    const T low_01 = w.m0 < w.m1 ? T(0) : T(1), least_01 = w.m0 < w.m1 ? w.m0 : w.m1;
    b.k = least_01 < w.m2 ? low_01 : T(2);
    b.b210 = b.pick(T(e12), T(e20), T(e01)), b.b120 = b.pick(T(e21), T(e02), T(e10));
    b.b201 = b.pick(s1, s2, s0), b.b021 = b.pick(s2, s0, s1);
    b.b111 = b.pick(T(q0), T(q1), T(q2));
    b.b102 = b.pick(n1, n2, n0), b.b012 = b.pick(n2, n0, n1);
    b.b003 = (n0 + n1 + n2) * per_3;
    return b;
  }
  // The gradient from that along l, a third of it.
  template <class T>
  struct Gradient {
    T x, y;
  };
  template <class T>
  [[gnu::always_inline]] Gradient<T> gradient(const Third<T>& third, const Local<T>& along) const {
    const T along_k = T(3) * along.c - along.i - along.j;  // m_k enters all three of (5)
    const T to_0 = third.pick(along_k, along.j, along.i), to_1 = third.pick(along.i, along_k, along.j) - to_0,
            to_2 = third.pick(along.j, along.i, along_k) - to_0;
    return {T(3) * (to_1 * T(m1_x) + to_2 * T(m2_x)), T(3) * (to_1 * T(m1_y) + to_2 * T(m2_y))};
  }
  template <class T>
  [[gnu::always_inline]] static T product(const Local<T>& a, const Local<T>& b) {
    return a.i * b.i + a.j * b.j + a.c * b.c;
  }
};
static_assert(sizeof(CloughTocherPatch) == 128);

template <class T>
CloughTocherPatch::Sheet<T> CloughTocherPatch::evaluate(const T& at_x, const T& at_y, const Facet& plane) const {
  const auto weights = locate(at_x, at_y);
  const Third<T> third = third_at(weights);
  const Local<T> l = third.local(weights), per_l = third.polar(l).polar(l);
  const Gradient<T> g = gradient(third, per_l);
  const T slope_x(plane.slope_x), slope_y(plane.slope_y);
  return {T(z) + (slope_x * (at_x - T(x)) + slope_y * (at_y - T(y)) + product(l, per_l)), slope_x + g.x, slope_y + g.y};
}

template <class T>
[[gnu::always_inline]] inline CloughTocherPatch::Arrival<T> CloughTocherPatch::arrive(const T& from_x, const T& from_y, const Vec3<T>& d,
                                                                                      const T& plane_x, const T& plane_y) const {
  using std::abs;
  const auto weights = locate(from_x, from_y);
  const Third<T> third = third_at(weights);
  const Local<T> l = third.local(weights), v = third.local(toward(d.x, d.y));
  const Quadratic<T> by_l = third.polar(l), by_v = third.polar(v);
  const Local<T> by_ll = by_l.polar(l), by_lv = by_l.polar(v), by_vv = by_v.polar(v);
  const T along = d.z - plane_x * d.x - plane_y * d.y;
  const T f0 = product(l, by_ll), f1 = T(3) * product(v, by_ll), f2 = T(3) * product(v, by_lv), f3 = product(v, by_vv);
  const auto f = [&](const T& t) __attribute__((always_inline)) { return along * t - (f0 + t * (f1 + t * (f2 + t * f3))); };
  const auto slope = [&](const T& t) __attribute__((always_inline)) { return along - (f1 + t * (T(2) * f2 + T(3) * (t * f3))); };
  // Newton's method: on so short a path f is nearly straight.
  T t = f0 / (along - f1);
  t = t - f(t) / slope(t);
  t = t - f(t) / slope(t);

  const Local<T> end{l.i + t * v.i, l.j + t * v.j, l.c + t * v.c};
  const auto at_end = [&](const T& ll, const T& lv, const T& vv) __attribute__((always_inline)) { return ll + t * (T(2) * lv + t * vv); };
  const Gradient<T> g = gradient(third, Local<T>{at_end(by_ll.i, by_lv.i, by_vv.i), at_end(by_ll.j, by_lv.j, by_vv.j), at_end(by_ll.c, by_lv.c, by_vv.c)});
  const T dz_dx = plane_x + g.x, dz_dy = plane_y + g.y;
  const T crossing = d.z - dz_dx * d.x - dz_dy * d.y, forward = d.z < T(0) ? -crossing : crossing;
  const T rounding = T(4) * std::numeric_limits<T>::epsilon() * (abs(along * t) + abs(f0)), slack(-patch_slack);
  const bool is_sound = (abs(f(t)) <= rounding) & (end.i >= slack) & (end.j >= slack) & (end.c >= slack) & (forward > T(0));
  return {t, dz_dx, dz_dy, is_sound};
}

inline CloughTocherPatch CloughTocherPatch::of(const Corner (&corners)[3], const Facet& plane, const Slope (&at_midpoint)[3]) {
  constexpr double third = 1.0 / 3;
  CloughTocherPatch p{};
  const auto &v0 = corners[0].vertex, &v1 = corners[1].vertex, &v2 = corners[2].vertex;
  p.x = (v0.x + v1.x + v2.x) * third;
  p.y = (v0.y + v1.y + v2.y) * third;
  p.z = (v0.z + v1.z + v2.z) * third;
  const double per_area = 1 / ((v1.x - v0.x) * (v2.y - v0.y) - (v1.y - v0.y) * (v2.x - v0.x));
  p.m1_x = (v2.y - v0.y) * per_area, p.m1_y = (v0.x - v2.x) * per_area;
  p.m2_x = (v0.y - v1.y) * per_area, p.m2_y = (v1.x - v0.x) * per_area;
  const auto toward = [&](int from, int to) {  // (2)
    const Corner &a = corners[from], &b = corners[to];
    return (a.slope.x * (b.vertex.x - a.vertex.x) + a.slope.y * (b.vertex.y - a.vertex.y) - (b.vertex.z - a.vertex.z)) * third;
  };
  p.e01 = toward(0, 1), p.e12 = toward(1, 2), p.e20 = toward(2, 0);
  p.e10 = toward(1, 0), p.e21 = toward(2, 1), p.e02 = toward(0, 2);
  // On edge k from Vi to Vj, at M: the derivative along the edge is 3/4 (e_ji - e_ij); with that and the part across of
  // the gradient given there, toward C it is 3 [-3/8 (e_ij + e_ji) + (s_i + 2 q_k + s_j)/4].
  const auto middle = [&](int k, double e_ij, double e_ji, double s_i, double s_j) {
    const auto &a = corners[(k + 1) % 3].vertex, &b = corners[(k + 2) % 3].vertex;
    const double ex = b.x - a.x, ey = b.y - a.y;
    const double gx = at_midpoint[k].x - plane.slope_x, gy = at_midpoint[k].y - plane.slope_y;
    const double excess = (0.75 * (e_ji - e_ij) - gx * ex - gy * ey) / (ex * ex + ey * ey);
    const double inward = (gx + excess * ex) * (p.x - (a.x + b.x) / 2) + (gy + excess * ey) * (p.y - (a.y + b.y) / 2);
    return 2 * third * inward + 0.75 * (e_ij + e_ji) - (s_i + s_j) / 2;
  };
  const double s0 = (p.e01 + p.e02) * third, s1 = (p.e12 + p.e10) * third, s2 = (p.e20 + p.e21) * third;
  p.q0 = middle(0, p.e12, p.e21, s1, s2);
  p.q1 = middle(1, p.e20, p.e02, s2, s0);
  p.q2 = middle(2, p.e01, p.e10, s0, s1);
  return p;
}

}  // namespace sagitta::surface
