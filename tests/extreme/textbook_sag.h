// SPDX-License-Identifier: Apache-2.0
// Heights and slopes by the textbook, of surfaces that depart from a base, from what the user wrote and not from what is compiled: sums as they stand, the
// published closed forms.
//   zernike         powers of rho with factorials                                                                             (1)
//   asphere         sum of a_k r^k                                                                                            (2)
//   xy_polynomial   sum of C_j X^i Y^k                                                                                        (3)
//   biconic         (c_x x^2 + c_y y^2)/(1 + sqrt(1 - (1+K_x) c_x^2 x^2 - (1+K_y) c_y^2 y^2))                                   (4)
//   toroid          R -+ sqrt((R - g(y))^2 - x^2), g = conic + sum of a_k y^k                                                   (5)
//   grid            textbook_grid.h                                                                                            (6)
// The base: the conic; of the last two the quadric of the same vertex curvatures (lib/surface/quadric.h says which of them). Curvatures are the doubles next to
// 1/radius, as everywhere.
#pragma once

#include <cmath>
#include <limits>
#include <optional>

#include "lib/numerics/zernike_basis.h"
#include "lib/prescription/model.h"
#include "tests/extreme/textbook_grid.h"

namespace sagitta::test {

template <class T>
T textbook_power(const T& of, int exponent) {
  T product(1);
  for (int i = 0; i < exponent; ++i) product *= of;
  return product;
}

template <class T>
struct TextbookConic {
  T c, k1;  // curvature, 1 + K

  HeightAndSlopes<T> height(const T& x, const T& y) const {
    using std::sqrt;
    const T r2 = x * x + y * y, root = sqrt(T(1) - k1 * c * c * r2);
    return {c * r2 / (T(1) + root), c * x / root, c * y / root};
  }
};

// c_x x^2 + c_y y^2 + m z^2 = 2 z
template <class T>
struct TextbookQuadric {
  T c_x, c_y, m;

  HeightAndSlopes<T> height(const T& x, const T& y) const {
    using std::sqrt;
    const T N = c_x * x * x + c_y * y * y, root = sqrt(T(1) - m * N);
    return {N / (T(1) + root), c_x * x / root, c_y * y / root};
  }
};

// One Zernike polynomial, as sum over j of (-1)^j (n-j)!/(j! ((n+m)/2-j)! ((n-m)/2-j)!) rho^(n-2j) by rho^m e^(i m theta) = (X + i Y)^m.
template <class T>
HeightAndSlopes<T> textbook_zernike(numerics::ZernikeTerm term, const T& X, const T& Y) {
  const auto factorial = [](int of) {
    T product(1);
    for (int i = 2; i <= of; ++i) product *= T(i);
    return product;
  };
  const int n = term.n, m = std::abs(term.m);
  const T u = X * X + Y * Y;
  T radial(0), radial_u(0);
  for (int j = 0; 2 * j <= n - m; ++j) {
    const int exponent = (n - m) / 2 - j;
    const T coefficient = T(j % 2 == 0 ? 1 : -1) * factorial(n - j) / (factorial(j) * factorial((n + m) / 2 - j) * factorial(exponent));
    radial += coefficient * textbook_power(u, exponent);
    if (exponent > 0) radial_u += coefficient * T(exponent) * textbook_power(u, exponent - 1);
  }
  T re(1), im(0), re_before(0), im_before(0);
  for (int i = 0; i < m; ++i) {
    re_before = re, im_before = im;
    re = X * re_before - Y * im_before;
    im = X * im_before + Y * re_before;
  }
  const T h = term.m < 0 ? im : re, h_X = T(m) * (term.m < 0 ? im_before : re_before), h_Y = T(m) * (term.m < 0 ? re_before : T(-im_before));
  return {h * radial, h_X * radial + T(2) * X * h * radial_u, h_Y * radial + T(2) * Y * h * radial_u};
}

template <class T>
class TextbookSag {
 public:
  TextbookSag(const prescription::Shape& given) : given_(given.parameters) {
    const auto curvature = [&](const char* radius) { return T(1 / given_.number(radius)); };
    const auto conic = [&](const char* radius, const char* conic_constant) { return TextbookConic<T>{curvature(radius), T(1) + T(given_.number(conic_constant))}; };
    if (given.kind == "biconic") {
      x_ = conic("radius_x_mm", "conic_constant_x"), y_ = conic("radius_y_mm", "conic_constant_y"), height_ = &TextbookSag::biconic;
    } else {
      y_ = conic("radius_mm", "conic_constant"), x_ = y_;
      if (given.kind == "toroid") x_ = {curvature("radius_rotation_mm"), T(1)}, height_ = &TextbookSag::toroid;
      if (given.kind == "zernike") height_ = &TextbookSag::zernike;
      if (given.kind == "asphere") height_ = &TextbookSag::asphere;
      if (given.kind == "xy_polynomial") height_ = &TextbookSag::xy_polynomial;
      if (given.kind == "grid") grid_.emplace(*given.grid), height_ = &TextbookSag::grid;
    }
  }

  HeightAndSlopes<T> height(const T& x, const T& y) const { return (this->*height_)(x, y); }
  // Where there is none, there is no hit.
  bool has_data(const T& x, const T& y) const { return !grid_ || grid_->has_data(x, y); }
  // Of two sections the quadric that reaches out as far as both: the smaller |m|; that of the one which is not straight; none of a saddle.
  TextbookQuadric<T> base() const {
    using std::abs;
    const T of_x = x_.k1 * x_.c, of_y = y_.k1 * y_.c;
    const auto m = [&]() -> T {
      if (x_.c == T(0)) return of_y;
      if (y_.c == T(0)) return of_x;
      if (x_.c * y_.c < T(0)) return T(0);
      return (of_x < of_y) == (x_.c > T(0)) ? of_x : of_y;
    };
    return {x_.c, y_.c, m()};
  }

 private:
  HeightAndSlopes<T> zernike(const T& x, const T& y) const {  // (1)
    using std::sqrt;
    const auto indexing = numerics::zernike_indexing(given_.text("indexing"));
    const T r0(given_.number("normalization_radius_mm"));
    HeightAndSlopes<T> sum = y_.height(x, y);
    for (const auto& [index, micrometres] : given_.list("coefficients_um")) {
      if (micrometres == 0) continue;
      const numerics::ZernikeTerm term = numerics::zernike_term(indexing, index);
      const T norm = indexing == numerics::ZernikeIndexing::fringe ? T(1) : T(sqrt(T(term.n + 1) * T(term.m == 0 ? 1 : 2)));
      const T size = T(micrometres) / T(1000) * norm;
      const HeightAndSlopes<T> one = textbook_zernike<T>(term, x / r0, y / r0);
      sum = sum + HeightAndSlopes<T>{size * one.z, size * one.dz_dx / r0, size * one.dz_dy / r0};
    }
    return sum;
  }
  HeightAndSlopes<T> asphere(const T& x, const T& y) const {  // (2)
    using std::sqrt;
    const T r = sqrt(x * x + y * y);
    HeightAndSlopes<T> sum = y_.height(x, y);
    for (const auto& [k, a] : given_.list("coefficients")) {
      const T slope_over_r = T(k) * T(a) * textbook_power(r, k - 2);
      sum = sum + HeightAndSlopes<T>{T(a) * textbook_power(r, k), slope_over_r * x, slope_over_r * y};
    }
    return sum;
  }
  HeightAndSlopes<T> grid(const T& x, const T& y) const { return y_.height(x, y) + grid_->height(x, y); }  // (6)
  HeightAndSlopes<T> xy_polynomial(const T& x, const T& y) const {  // (3)
    const T r0(given_.number("normalization_radius_mm")), X = x / r0, Y = y / r0;
    HeightAndSlopes<T> sum = y_.height(x, y);
    const auto& terms = given_.list("coefficients");
    int j = 0;
    for (int degree = 1; degree <= 20; ++degree)
      for (int k = 0; k <= degree; ++k) {
        ++j;
        for (const auto& [index, C] : terms) {
          if (index != j) continue;
          const int i = degree - k;
          const T of_x = textbook_power(X, i), of_y = textbook_power(Y, k);
          sum = sum + T(C) * HeightAndSlopes<T>{of_x * of_y, i == 0 ? T(0) : T(T(i) * textbook_power(X, i - 1) * of_y / r0), k == 0 ? T(0) : T(T(k) * textbook_power(Y, k - 1) * of_x / r0)};
        }
      }
    return sum;
  }
  HeightAndSlopes<T> biconic(const T& x, const T& y) const {  // (4)
    using std::sqrt;
    const T a_x = x_.k1 * x_.c * x_.c, a_y = y_.k1 * y_.c * y_.c, N = x_.c * x * x + y_.c * y * y, s = sqrt(T(1) - a_x * x * x - a_y * y * y), below = T(1) + s;
    const auto slope = [&](const T& c, const T& a, const T& at) { return T(at * (T(2) * c * below + N * a / s) / (below * below)); };
    return {N / below, slope(x_.c, a_x, x), slope(y_.c, a_y, y)};
  }
  HeightAndSlopes<T> toroid(const T& x, const T& y) const {  // (5)
    using std::sqrt;
    HeightAndSlopes<T> g = y_.height(T(0), y);
    for (const auto& [k, a] : given_.list("coefficients")) g = g + HeightAndSlopes<T>{T(a) * textbook_power(y, k), T(0), T(k) * T(a) * textbook_power(y, k - 1)};
    if (x_.c == T(0)) return g;
    const T R = T(1) / x_.c, of_curve = R - g.z, root = sqrt(of_curve * of_curve - x * x), of_z = R < T(0) ? T(-root) : root;  // R - z
    if (!(of_curve / R > T(0))) return {T(std::numeric_limits<double>::quiet_NaN()), T(0), T(0)};  // beyond the line
    return {R - of_z, x / of_z, g.dz_dy * of_curve / of_z};
  }

  const prescription::Parameters& given_;
  std::optional<TextbookGrid<T>> grid_;
  TextbookConic<T> x_{}, y_{};  // the sections, or twice the base conic
  HeightAndSlopes<T> (TextbookSag::*height_)(const T&, const T&) const = nullptr;
};

}  // namespace sagitta::test
