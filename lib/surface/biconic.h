// SPDX-License-Identifier: Apache-2.0
// The biconic: a conic section each in the x-z and in the y-z plane, and between them
//
//   z = N/(1 + s),   N = c_x x^2 + c_y y^2,   s = sqrt(1 - Q),   Q = (1+K_x) c_x^2 x^2 + (1+K_y) c_y^2 y^2               (1)
//   dz/dx = x (2 c_x + (1+K_x) c_x^2 z/s)/(1 + s),   dz/dy likewise                                                   (2)
//
// c_x, c_y   1/radius_x_mm, 1/radius_y_mm, 1/mm; 0: straight           K_x, K_y   conic constants
//
// It is no sum of two profiles and, where K_x and K_y differ, no ellipsoid. With equal sections it is the conic, with c_x = 0 the cylinder, which
// leaves directions along x as they are. Domain: Q <= 1, the ellipse of its equator, where c^2 (1+K) is positive.
//
// The hit is the one continuous with that of the quadric of the same vertex curvatures (quadric.h), not of a conic: no conic is near both sections of a
// cylinder. The quadric reaches out at least as far as the biconic; a ray that meets it beyond the biconic's equator is followed inward from there.
// Only where Q, of a section with K < -1 and another with K > -1, comes below 1 on both sides of it, such a ray is not_converged.
//
// Bound of the second derivative along the line, with |x|, |y|, N, Q and their derivatives bounded on the way:
//   N''/(1+s) + 2 N' s'/(1+s)^2 + N s''/(1+s)^2 + 2 N s'^2/(1+s)^3,   s' = Q'/(2 s),   s'' = Q''/(2 s) + Q'^2/(4 s^3)       (3)
//
// Source: Zemax OpticStudio's help, "Biconic" (there the radius and conic constant of x are parameters 1 and 2, and radius 0 means c_x = 0).
#pragma once

#include <array>
#include <cmath>

#include "lib/surface/quadric.h"

namespace sagitta::surface {

struct Biconic : QuadricDeparture<Biconic> {
  static constexpr std::string_view kind = "biconic";
  static constexpr std::array keys{
      numerics::Key{.name = "radius_x_mm", .meaning = "vertex radius of the x-z section, + when the centre is at +z; .inf: straight", .required = true,
                    .range = numerics::nonzero_or_infinite},
      numerics::Key{.name = "radius_y_mm", .meaning = "vertex radius of the y-z section", .required = true, .range = numerics::nonzero_or_infinite},
      numerics::Key{.name = "conic_constant_x", .meaning = "K of the x-z section: 0 circle, -1 parabola", .range = conic_constants},
      numerics::Key{.name = "conic_constant_y", .meaning = "K of the y-z section", .range = conic_constants}};

  Conic x, y;  // the sections

  static Biconic of(const Conic& x, const Conic& y) {
    Biconic result;
    result.base = Quadric::of(x, y);
    result.x = x, result.y = y;
    return result;
  }
  template <class Parameters, class Arena>
  static Biconic from(const Parameters& given, Arena&) {
    return of({1 / given.number("radius_x_mm"), given.number("conic_constant_x")}, {1 / given.number("radius_y_mm"), given.number("conic_constant_y")});
  }

  bool is_conic() const { return x.curvature == y.curvature && (x.conic_constant == y.conic_constant || x.curvature == 0); }
  double vertex_curvature() const { return y.curvature; }
  double vertex_curvature_x() const { return x.curvature; }

  // c and (1+K) c^2 of a section.
  template <class T>
  struct Section {
    T c, a;
    explicit Section(const Conic& of) : c(of.curvature), a((T(1) + T(of.conic_constant)) * c * c) {}
  };

  template <class T>
  Height<T> height(const T& at_x, const T& at_y) const {
    using std::abs, std::sqrt;
    const Section<T> of_x(x), of_y(y);
    const T xx = at_x * at_x, yy = at_y * at_y, N = of_x.c * xx + of_y.c * yy;
    const T s = sqrt(T(1) - (of_x.a * xx + of_y.a * yy)), h = T(1) / (T(1) + s), z = N * h, per_s = z / s;
    return {z, at_x * h * (T(2) * of_x.c + of_x.a * per_s), at_y * h * (T(2) * of_y.c + of_y.a * per_s),
            (abs(of_x.c) * xx + abs(of_y.c) * yy) * h};
  }

  // Where Q is least; where it is nowhere below 1, no number.
  template <class T>
  T deepest_on(const Vec3<T>& at, const Vec3<T>& d) const {
    const Section<T> of_x(x), of_y(y);
    const T bends = of_x.a * d.x * d.x + of_y.a * d.y * d.y, t = -(of_x.a * at.x * d.x + of_y.a * at.y * d.y) / bends, at_x = at.x + t * d.x, at_y = at.y + t * d.y;
    return bends > T(0) && of_x.a * at_x * at_x + of_y.a * at_y * at_y >= T(1) ? not_a_number<T>() : t;
  }

  // (3)
  template <class T>
  T bend_on(const Vec3<T>& at, const Vec3<T>& d, const T& within) const {
    using std::abs, std::sqrt;
    const Section<T> of_x(x), of_y(y);
    const T L = abs(d.x), M = abs(d.y), X = abs(at.x) + L * within, Y = abs(at.y) + M * within;
    const T N = abs(of_x.c) * X * X + abs(of_y.c) * Y * Y, N_1 = T(2) * (abs(of_x.c) * L * X + abs(of_y.c) * M * Y), N_2 = T(2) * (abs(of_x.c) * L * L + abs(of_y.c) * M * M);
    const T Q_1 = T(2) * (abs(of_x.a) * L * X + abs(of_y.a) * M * Y), Q_2 = T(2) * (abs(of_x.a) * L * L + abs(of_y.a) * M * M);
    const T s_squared = T(1) - (of_x.a * at.x * at.x + of_y.a * at.y * at.y) - Q_1 * within;
    if (!(s_squared > T(0))) return T(std::numeric_limits<double>::infinity());
    const T s = sqrt(s_squared), s_1 = Q_1 / (T(2) * s), s_2 = Q_2 / (T(2) * s) + Q_1 * Q_1 / (T(4) * s * s_squared), h = T(1) / (T(1) + s);
    return h * (N_2 + h * (T(2) * N_1 * s_1 + N * s_2 + T(2) * h * N * s_1 * s_1));
  }

  // Of 1 - Q 8 roundings of its terms' sizes, of N 4.
  SagRounding rounding(double at_x, double at_y) const {
    const double u = std::numeric_limits<double>::epsilon() / 2;
    const Section<double> of_x(x), of_y(y);
    const double xx = at_x * at_x, yy = at_y * at_y, N = std::abs(of_x.c) * xx + std::abs(of_y.c) * yy, Q = std::abs(of_x.a) * xx + std::abs(of_y.a) * yy;
    const double s = std::sqrt(1 - (of_x.a * xx + of_y.a * yy)), h = 1 / (1 + s), z = N * h;
    const double of_s = (8 * Q + 2) * u / s + u * s, of_z = h * (4 * u * N + z * (of_s + 2 * u)) + 2 * u * z;
    const auto slope = [&](const Section<double>& of, double at) {
      const double terms = 2 * std::abs(of.c) + std::abs(of.a) * z / s;
      return std::abs(at) * h * (terms * (10 * u + of_s * h) + std::abs(of.a) * (of_z + z * of_s / s) / s);
    };
    return {of_z, slope(of_x, at_x) + slope(of_y, at_y)};
  }
};

}  // namespace sagitta::surface
