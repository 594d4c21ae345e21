// SPDX-License-Identifier: Apache-2.0
// The toroid: a curve in the y-z plane, turned about a line parallel to the y axis.
//
//   g(y) = c y^2/(1 + sqrt(1 - (1+K) c^2 y^2)) + sum_k a_k y^k,   k from 2 to 40                                       (1)
//   z = g + rho x^2/(V + W),   V = 1 - rho g,   W = sqrt(V^2 - rho^2 x^2)                                             (2)
//   dz/dx = rho x/W,   dz/dy = g' V/W                                                                              (3)
//
// rho   1/radius_rotation_mm: the line is at z = 1/rho, x = 0; 0 (.inf): a cylinder along x, which leaves directions along x as they are
// c, K  of the curve: 1/radius_mm, conic_constant          a_k   coefficients {k: a_k} of powers of y, mm^(1-k); Zemax's TOROIDAL has a_2, a_4, ...
//
// (2) is z = 1/rho -+ sqrt((1/rho - g)^2 - x^2) without its cancellation. Domain: the curve's, and V > 0, W > 0: the half of the ring that holds the vertex.
//
// The hit is the one continuous with that of the quadric of the vertex curvatures rho and c (quadric.h; for the reason see biconic.h), which like the base
// conic of an asphere leaves out the a_k. Bounds of the second derivatives, with G_i >= |g^(i)| and V, W bounded on the way:
//   |z_xx| <= |rho| V^2/W^3,   |z_xy| <= rho^2 |x| G_1 V/W^3,   |z_yy| <= G_2 V/W + |rho|^3 G_1^2 x^2/W^3                   (4)
//
// Source: Zemax OpticStudio's help, "Toroidal"; (2) to (4) follow from (R - z)^2 + x^2 = (R - g)^2.
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "lib/surface/asphere.h"
#include "lib/surface/quadric.h"

namespace sagitta::surface {

struct Toroid : QuadricDeparture<Toroid> {
  static constexpr std::string_view kind = "toroid";
  static constexpr std::array keys{
      numerics::Key{.name = "radius_rotation_mm", .meaning = "from the vertex to the line that the curve is turned about, + when it is at +z; .inf: a cylinder", .required = true,
                    .range = numerics::nonzero_or_infinite},
      numerics::Key{.name = "radius_mm", .meaning = "vertex radius of the curve in the y-z plane", .required = true, .range = numerics::nonzero_or_infinite},
      numerics::Key{.name = "conic_constant", .meaning = "K of the curve: 0 circle, -1 parabola", .range = conic_constants}, powers_key};

  double rotation = 0;  // rho, 1/mm
  Conic section;        // of the curve, without a_k
  int order = 1;        // the highest power
  const double* coefficients = nullptr;  // a_order, ..., a_2

  template <class Parameters, class Arena>
  static Toroid from(const Parameters& given, Arena& arena) {
    Toroid result;
    result.rotation = 1 / given.number("radius_rotation_mm");
    result.section = {1 / given.number("radius_mm"), given.number("conic_constant")};
    result.base = Quadric::of({result.rotation, 0}, result.section);
    for (const auto& [power, value] : given.list("coefficients"))
      if (value != 0) result.order = power;
    std::vector<double> falling(static_cast<std::size_t>(result.order - 1));
    for (const auto& [power, value] : given.list("coefficients"))
      if (value != 0) falling[static_cast<std::size_t>(result.order - power)] = value;
    result.coefficients = arena.keep(std::move(falling));
    return result;
  }

  std::size_t data_bytes() const { return sizeof *this + static_cast<std::size_t>(order - 1) * sizeof(double); }
  bool is_sphere() const { return order < 2 && section.curvature == rotation && section.conic_constant == 0; }
  double vertex_curvature() const { return section.curvature + (order < 2 ? 0 : 2 * coefficients[order - 2]); }
  double vertex_curvature_x() const { return rotation; }

  // The sum of a_k y^k and its derivatives; of the terms' sizes, instead of the terms.
  template <class T>
  struct Powers {
    T value{0}, first{0}, second{0};
  };
  template <bool of_sizes, class T>
  Powers<T> powers(const T& y) const {
    T q(0), q_1(0), q_2(0);  // sum = y^2 q(y); q_2 is half the second derivative
    for (int i = 0; i + 2 <= order; ++i) {
      q_2 = q_2 * y + q_1;
      q_1 = q_1 * y + q;
      q = q * y + T(of_sizes ? std::abs(coefficients[i]) : coefficients[i]);
    }
    return {y * y * q, y * (T(2) * q + y * q_1), T(2) * q + T(4) * y * q_1 + T(2) * y * y * q_2};
  }

  template <class T>
  Height<T> height(const T& x, const T& y) const {
    using std::abs, std::sqrt;
    const T rho(rotation), bare = section.sag(T(0), y);
    const Powers<T> sum = powers<false>(y);
    const T g = bare + sum.value, g_1 = section.gradient(T(0), y).y + sum.first, V = T(1) - rho * g;
    if (!(V > T(0))) return {not_a_number<T>(), not_a_number<T>(), not_a_number<T>(), not_a_number<T>()};
    const T W = sqrt(V * V - rho * rho * x * x), turned = rho * x * x / (V + W);  // (2)
    return {g + turned, rho * x / W, g_1 * V / W, abs(bare) + powers<true>(T(abs(y))).value + abs(turned)};
  }

  // The middle of the line in an ellipse of about the domain: x to 1/rho, y to where the curve or V ends.
  template <class T>
  T deepest_on(const Vec3<T>& at, const Vec3<T>& d) const {
    const T rho(rotation), c(section.curvature), curve = (T(1) + T(section.conic_constant)) * c * c, ring = rho * c;
    const T a_x = rho * rho, a_y = curve > ring ? curve : ring;
    return -(a_x * at.x * d.x + a_y * at.y * d.y) / (a_x * d.x * d.x + a_y * d.y * d.y);
  }

  // (4)
  template <class T>
  T bend_on(const Vec3<T>& at, const Vec3<T>& d, const T& within) const {
    using std::abs, std::sqrt;
    const T infinite(std::numeric_limits<double>::infinity()), rho(rotation), size = abs(rho), c = abs(T(section.curvature));
    const T L = abs(d.x), M = abs(d.y), X = abs(at.x) + L * within, Y = abs(at.y) + M * within;
    const T w_squared = T(1) - (T(1) + T(section.conic_constant)) * c * c * Y * Y;
    if (!(w_squared > T(0))) return infinite;
    const T w = sqrt(w_squared), least_w = w < T(1) ? w : T(1);
    const Powers<T> sizes = powers<true>(Y);
    const T G_1 = c * Y / w + sizes.first, G_2 = c / (least_w * least_w * least_w) + sizes.second;
    const T V_at = T(1) - rho * (section.sag(T(0), at.y) + powers<false>(at.y).value), V_moves = size * G_1 * M * within;
    const T V = V_at + V_moves, least_V = V_at - V_moves, W_squared = least_V * least_V - size * size * X * X;
    if (!(least_V > T(0)) || !(W_squared > T(0))) return infinite;
    const T W = sqrt(W_squared), W_cubed = W * W_squared;
    return L * L * (size * V * V / W_cubed) + T(2) * L * M * (size * size * X * G_1 * V / W_cubed) + M * M * (G_2 * V / W + size * size * size * G_1 * G_1 * X * X / W_cubed);
  }

  // The curve's heights are off by 8 roundings of w^2 and by 4 (N + 3) of the sum's terms; V, W and what follows likewise.
  SagRounding rounding(double x, double y) const {
    const double u = std::numeric_limits<double>::epsilon() / 2, rho = rotation, c = std::abs(section.curvature), m = std::abs(1 + section.conic_constant);
    const Powers<double> sum = powers<false>(y), sizes = powers<true>(std::abs(y));
    const double bare = section.sag(0.0, y), w_squared = 1 - (1 + section.conic_constant) * c * c * y * y, w = std::sqrt(w_squared), of_w = (8 * m * c * c * y * y + 2) * u / w + u * w;
    const double of_g = std::abs(bare) * (6 * u + of_w / (1 + w)) + 4 * (order + 3) * u * sizes.value;
    const double g_1 = std::abs(c * y / w) + std::abs(sum.first), of_g_1 = c * std::abs(y) / w * (4 * u + of_w / w) + 4 * (order + 3) * u * sizes.first;
    const double g = bare + sum.value, V = 1 - rho * g, size = std::abs(rho), of_V = size * of_g + u * (1 + 2 * std::abs(rho * g)), W = std::sqrt(V * V - rho * rho * x * x);
    const double of_W = (2 * V * of_V + 4 * u * (V * V + rho * rho * x * x)) / W + u * W, turned = size * x * x / (V + W);
    const double height = of_g + turned * (6 * u + (of_V + of_W) / (V + W)) + u * (std::abs(g) + turned);
    const double slope_x = size * std::abs(x) / W * (4 * u + of_W / W), slope_y = V / W * (of_g_1 + g_1 * (of_V / V + of_W / W + 4 * u));
    return {height, slope_x + slope_y};
  }
};

}  // namespace sagitta::surface
