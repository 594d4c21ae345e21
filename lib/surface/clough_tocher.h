// SPDX-License-Identifier: Apache-2.0
// One triangle of a C1 piecewise cubic: the Clough-Tocher element on the centroid split.
//
// The triangle (V0, V1, V2) is divided at its centroid C into three; on each lies a cubic in Bernstein form
//   S = sum_{i+j+k=3} b_ijk 3!/(i! j! k!) l1^i l2^j l3^k                                                           (1)
// in the barycentric coordinates of that third. The 19 coefficients follow from 12 data: value and gradient at the
// corners, and the slope across each edge at its midpoint. With zi, gi at Vi, edge i opposite to Vi:
//   along the edge from Vi to Vj    zi + gi.(Vj - Vi)/3                                                            (2)
//   from Vi to C (spoke)            zi + gi.(C - Vi)/3
//   middle of the third on edge k   such that the derivative at the edge's midpoint M is G.(C - M)
//   near C toward Vi (inner)        (spoke_i + middle_j + middle_k)/3                                              (3)
//   at C                            mean of the three inner ones
// (3) joins the thirds with one tangent plane. Across an edge, value and gradient depend on the edge's own data alone, so
// neighbouring triangles join likewise, and where they compute (2) in the same order they agree bit for bit.
//
// Exact for cubics when the 12 data are; sag error O(h^4), slope O(h^3).
//
// Source: R. W. Clough and J. L. Tocher, Proc. Conf. Matrix Methods in Structural Mechanics (1965), 515; in Bernstein form
// P. Alfeld, Computer Aided Geometric Design 1, 169 (1984).
#pragma once

#include "lib/surface/crossing.h"

namespace sagitta::surface {

struct CloughTocherPatch {
  double x = 0, y = 0;              // C, mm
  double m1_x, m1_y, m2_x, m2_y;    // gradients of the triangle's barycentric coordinates of V1 and V2, 1/mm
  double corner[3];
  double edge[3][2];                // on edge i: near V(i+1), near V(i+2)
  double spoke[3], middle[3], inner[3];
  double centre;

  template <class T>
  struct Place {
    T m[3];  // barycentric coordinates in the triangle
  };
  template <class T>
  Place<T> locate(const T& at_x, const T& at_y) const {
    return locate(at_x, at_y, T(x), T(y), T(m1_x), T(m1_y), T(m2_x), T(m2_y));
  }
  template <class T>
  [[gnu::always_inline]] static Place<T> locate(const T& at_x, const T& at_y, const T& x, const T& y, const T& m1_x, const T& m1_y,
                                                const T& m2_x, const T& m2_y) {
    const T dx = at_x - x, dy = at_y - y, third = T(1) / T(3);
    const T m1 = third + m1_x * dx + m1_y * dy, m2 = third + m2_x * dx + m2_y * dy;
    return {{T(1) - m1 - m2, m1, m2}};
  }

  // The coefficients (1) of the third on edge k.
  template <class T>
  struct Third {
    T b300, b030, b003, b210, b120, b201, b021, b111, b102, b012;
  };
  static constexpr int after(int k) { return k == 2 ? 0 : k + 1; }
  static constexpr int before(int k) { return k == 0 ? 2 : k - 1; }
  // Which third holds a place: the one on the edge whose opposite corner weighs least.
  template <class T>
  static int third_at(const Place<T>& place) {
    const T* m = place.m;
    return m[0] < m[1] ? (m[0] < m[2] ? 0 : 2) : (m[1] < m[2] ? 1 : 2);
  }
  template <class T>
  Third<T> third(int k) const {
    const int i = after(k), j = before(k);
    return {T(corner[i]), T(corner[j]), T(centre), T(edge[k][0]), T(edge[k][1]), T(spoke[i]), T(spoke[j]), T(middle[k]), T(inner[i]), T(inner[j])};
  }

  template <class T>
  struct Sheet {
    T z, dz_dx, dz_dy;
  };
  // (1) and its gradient by de Casteljau's algorithm, in the third that holds the place; beyond the triangle the cubic of
  // the nearest third goes on.
  template <class T>
  Sheet<T> evaluate(const Place<T>& place) const {
    const int k = third_at(place);
    return evaluate(third<T>(k), k, place, T(m1_x), T(m1_y), T(m2_x), T(m2_y));
  }
  // In select form, so that loops over it become vectors.
  template <class T>
  [[gnu::always_inline]] static Sheet<T> evaluate(const Third<T>& b, int k, const Place<T>& place, const T& m1_x, const T& m1_y, const T& m2_x,
                                                  const T& m2_y) {
    const auto turned = [k](const T& v0, const T& v1, const T& v2) {  // those of corners i, j and k
      struct {
        T i, j, k;
      } of{k == 0 ? v1 : k == 1 ? v2 : v0, k == 0 ? v2 : k == 1 ? v0 : v1, k == 0 ? v0 : k == 1 ? v1 : v2};
      return of;
    };
    const auto m = turned(place.m[0], place.m[1], place.m[2]);
    const T li = m.i - m.k, lj = m.j - m.k, lc = T(3) * m.k;
    const T q200 = li * b.b300 + lj * b.b210 + lc * b.b201, q020 = li * b.b120 + lj * b.b030 + lc * b.b021;
    const T q002 = li * b.b102 + lj * b.b012 + lc * b.b003, q110 = li * b.b210 + lj * b.b120 + lc * b.b111;
    const T q101 = li * b.b201 + lj * b.b111 + lc * b.b102, q011 = li * b.b111 + lj * b.b021 + lc * b.b012;
    const T li1 = li * q200 + lj * q110 + lc * q101;  // dS/dl = 3 times these
    const T lj1 = li * q110 + lj * q020 + lc * q011;
    const T lc1 = li * q101 + lj * q011 + lc * q002;
    const auto mx = turned(-m1_x - m2_x, m1_x, m2_x), my = turned(-m1_y - m2_y, m1_y, m2_y);
    const T to_k = T(3) * lc1 - li1 - lj1;  // derivative along m[k], which enters all three
    return {li * li1 + lj * lj1 + lc * lc1, T(3) * (li1 * mx.i + lj1 * mx.j + to_k * mx.k),
            T(3) * (li1 * my.i + lj1 * my.j + to_k * my.k)};
  }

  struct Corner {
    numerics::Vec3<double> vertex;
    double slope_x, slope_y;
  };
  struct Slope {
    double x, y;
  };
  // `at_midpoint[i]` is a gradient at the midpoint of edge i of which the part across the edge counts.
  static CloughTocherPatch of(const Corner (&corners)[3], const Slope (&at_midpoint)[3]);
};

inline CloughTocherPatch CloughTocherPatch::of(const Corner (&corners)[3], const Slope (&at_midpoint)[3]) {
  CloughTocherPatch p{};
  const auto &v0 = corners[0].vertex, &v1 = corners[1].vertex, &v2 = corners[2].vertex;
  p.x = (v0.x + v1.x + v2.x) / 3;
  p.y = (v0.y + v1.y + v2.y) / 3;
  const double area = (v1.x - v0.x) * (v2.y - v0.y) - (v1.y - v0.y) * (v2.x - v0.x);
  p.m1_x = (v2.y - v0.y) / area, p.m1_y = (v0.x - v2.x) / area;
  p.m2_x = (v0.y - v1.y) / area, p.m2_y = (v1.x - v0.x) / area;
  const auto toward = [](const Corner& from, double to_x, double to_y) {  // (2)
    return from.vertex.z + (from.slope_x * (to_x - from.vertex.x) + from.slope_y * (to_y - from.vertex.y)) / 3;
  };
  for (int k = 0; k < 3; ++k) {
    const Corner &a = corners[(k + 1) % 3], &b = corners[(k + 2) % 3];
    p.corner[k] = corners[k].vertex.z;
    p.edge[k][0] = toward(a, b.vertex.x, b.vertex.y);
    p.edge[k][1] = toward(b, a.vertex.x, a.vertex.y);
    p.spoke[k] = toward(corners[k], p.x, p.y);
  }
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    const auto &a = corners[i].vertex, &b = corners[j].vertex;
    const double ex = b.x - a.x, ey = b.y - a.y;
    const double near_a = p.edge[k][0], near_b = p.edge[k][1];
    const double along = 0.75 * ((b.z - a.z) + (near_b - near_a));                    // derivative along (ex, ey) at M
    const double excess = (along - at_midpoint[k].x * ex - at_midpoint[k].y * ey) / (ex * ex + ey * ey);
    const double gx = at_midpoint[k].x + excess * ex, gy = at_midpoint[k].y + excess * ey;  // G
    const double inward = gx * (p.x - (a.x + b.x) / 2) + gy * (p.y - (a.y + b.y) / 2);
    // inward = 3 [-(a + 3 near_a + 3 near_b + b)/8 + (spoke_i + 2 middle + spoke_j)/4]
    p.middle[k] = 2 * (inward / 3 + (a.z + b.z + 3 * (near_a + near_b)) / 8) - (p.spoke[i] + p.spoke[j]) / 2;
  }
  for (int i = 0; i < 3; ++i) p.inner[i] = (p.spoke[i] + p.middle[(i + 1) % 3] + p.middle[(i + 2) % 3]) / 3;  // (3)
  p.centre = (p.inner[0] + p.inner[1] + p.inner[2]) / 3;
  return p;
}

}  // namespace sagitta::surface
