// SPDX-License-Identifier: Apache-2.0
// A sum of Zernike polynomials on a base conic:
//
//   z = conic(r; c, K) + sum_j C_j Z_j(x/r0, y/r0)                                                                 (1)
//
// r0   normalization_radius_mm        C_j  coefficients_um (stored in mm)        Z_j  numerics/zernike_basis.h
//
// Outside r0 the polynomials are evaluated like inside: r0 is a scale, not an aperture. The domain is the conic's.
//
// Evaluation. The terms are grouped by azimuthal order m; within a group the Jacobi polynomials P_k^(0,m)(u) run
// upwards, each with a cosine and a sine coefficient (norms included):
//   Z-sum = sum_m [ Re h_m  sum_k a_mk P_k + Im h_m  sum_k b_mk P_k ],   h_m = (X + iY)^m, X = x/r0, u = X^2 + Y^2     (2)
//   d h_m/dX = m h_(m-1),   d h_m/dY = i m h_(m-1),   d P_k/du by the derivative of the recurrence.                   (3)
// About 8 operations a term. Error of the sum: a few eps of sum |C_j|, times the order near the rim (tests: 1e-13 at
// order 40). Sums up to order 12 become one polynomial in X and Y when they are made, 2 operations a term, unless its terms cancel
// so that their rounding would show beside r0 and the heights themselves (a millimetre of order 12 on a disc of 1 mm would be off by 8e-13).
//
// Intersection: conic_departure.h. The bound of the sum's slopes there:
//   |D^k p| <= sum |C_j N_j| T_n^(k)(1) T_n(s)/(s r0)^k   for rho <= s, s >= 1                                       (4)
// (|Z_j/N_j| <= 1 in the unit disc, T_n(s) outside, T_n Chebyshev's polynomial, and a polynomial's derivatives along lines in the disc are
// below T_n^(k)(1) = prod_(i<k) (n^2 - i^2)/(2i + 1) of that).
//
// Source: Harris, J. Math. Anal. Appl. 368, 374 (2010), for (4) (V. A. Markov's inequality in a disc).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

#include "lib/numerics/key.h"
#include "lib/numerics/zernike_basis.h"
#include "lib/numerics/zernike_polynomial.h"
#include "lib/surface/conic_departure.h"

namespace sagitta::surface {

struct Zernike : ConicDeparture<Zernike> {
  static constexpr std::string_view kind = "zernike";
  static constexpr std::array keys{
      base_radius_key, base_conic_constant_key,
      numerics::Key{.name = "normalization_radius_mm", .meaning = "radius at which rho = 1", .required = true,
                    .range = {.low = 1e-15, .high = 1e15, .reason = "it is in mm; powers of the radius over it would leave the range of numbers"}},
      numerics::Key{.name = "indexing", .kind = numerics::ValueKind::text, .meaning = "order and normalisation of the terms",
                    .required = true, .choices = numerics::zernike_indexings},
      numerics::Key{.name = "coefficients_um", .kind = numerics::ValueKind::indexed,
                    .meaning = "coefficient of each term: {index: value} or a list from the first", .required = true,
                    .range = {.low = -1e18, .high = 1e18, .reason = "it is in um; the slopes of a larger one would leave the range of numbers"},
                    .indexed_by = "indexing", .indices = [](std::string_view name) {
                      const auto indexing = numerics::zernike_indexing(name);
                      return numerics::IndexRange{numerics::first_zernike_index(indexing), numerics::last_zernike_index(indexing)};
                    }}};

  // One step of the recurrence with the coefficients of its polynomial, in mm.
  struct Row {
    double a, b, c;
    double cosine, sine;
  };
  // The rows of one azimuthal order.
  struct Group {
    int m;
    int first_row, row_count;
  };

  double per_radius = 1;  // 1/r0
  const Group* groups = nullptr;
  int group_count = 0;
  const Row* rows = nullptr;
  bool is_polynomial = false;  // then the sum is this one, in X and Y
  numerics::Polynomial polynomial;
  double size_at_any_place = 0;  // sum |C_j norm_j|, the size of the terms inside r0
  const double* sizes = nullptr;  // the same by order, from 0 to `order`
  static constexpr double wider = 1.2;  // than r0: rays from there to here can still be told to pass no other crossing
  double steepest_squared[2] = {0, 0};  // of (4), k = 1, at s = 1 and `wider`
  int order = -1, given_order = -1;  // of the terms that are not zero, which alone are kept; of all that were given

  template <class Parameters, class Arena>
  static Zernike from(const Parameters& given, Arena& arena) {
    const auto indexing = numerics::zernike_indexing(given.text("indexing"));
    std::map<int, std::vector<Row>> by_order;
    Zernike result;
    for (const auto& [index, micrometres] : given.list("coefficients_um")) {
      const int n = numerics::zernike_term(indexing, index).n;
      result.given_order = std::max(result.given_order, n);
      if (micrometres != 0) result.order = std::max(result.order, n);
    }
    const int order = result.order;
    result.is_polynomial = order <= numerics::highest_zernike_polynomial;
    std::vector<long double> expanded(result.is_polynomial ? numerics::Polynomial::count(order) : 0);
    std::vector<double> sizes(static_cast<std::size_t>(order + 1));
    for (const auto& [index, micrometres] : given.list("coefficients_um")) {
      if (micrometres == 0) continue;
      const numerics::ZernikeTerm term = numerics::zernike_term(indexing, index);
      const int m = std::abs(term.m);
      const auto k = static_cast<std::size_t>((term.n - m) / 2);
      auto& rows_of_m = by_order[m];
      while (rows_of_m.size() <= k) {
        const auto step = numerics::jacobi_step(static_cast<int>(rows_of_m.size()), m);
        rows_of_m.push_back(rows_of_m.empty() ? Row{} : Row{step.a, step.b, step.c, 0, 0});
      }
      const double scaled = micrometres * 1e-3 * numerics::zernike_norm(indexing, term);
      (term.m < 0 ? rows_of_m[k].sine : rows_of_m[k].cosine) += scaled;
      if (result.is_polynomial && scaled != 0) numerics::add_zernike_term<long double>(term, scaled, order, expanded);
      result.size_at_any_place += std::abs(scaled);
      sizes[static_cast<std::size_t>(numerics::zernike_term(indexing, index).n)] += std::abs(scaled);
    }
    std::vector<Group> all_groups;
    std::vector<Row> all_rows;
    for (const auto& [m, rows_of_m] : by_order) {
      all_groups.push_back({m, static_cast<int>(all_rows.size()), static_cast<int>(rows_of_m.size())});
      all_rows.insert(all_rows.end(), rows_of_m.begin(), rows_of_m.end());
    }
    result.base = {1 / given.number("radius_mm"), given.number("conic_constant")};
    result.per_radius = 1 / given.number("normalization_radius_mm");
    result.group_count = static_cast<int>(all_groups.size());
    result.groups = arena.keep(std::move(all_groups));
    result.rows = arena.keep(std::move(all_rows));
    result.sizes = arena.keep(std::move(sizes));
    for (const bool is_wider : {false, true}) {
      const double steepest = result.bound_within<double>((is_wider ? wider : 1) / result.per_radius, 1);
      result.steepest_squared[is_wider] = steepest * steepest;
    }
    double terms = 0;  // sum of the largest |c_ij X^i Y^j| of the disc
    for (int i = 0; i <= order && result.is_polynomial; ++i)
      for (int j = 0; i + j <= order; ++j) {
        const auto largest = [&](int power) { return power == 0 ? 1.0 : std::pow(static_cast<double>(power) / (i + j), 0.5 * power); };
        terms += std::abs(static_cast<double>(expanded[numerics::Polynomial::place(order, i, j)])) * largest(i) * largest(j);
      }
    const double heights = std::abs(result.base.curvature) / (2 * result.per_radius * result.per_radius) + result.size_at_any_place;
    result.is_polynomial = result.is_polynomial && terms <= most_cancellation * (1 / result.per_radius + heights);
    if (result.is_polynomial) result.polynomial = {order, arena.keep(std::vector<double>(expanded.begin(), expanded.end()))};
    return result;
  }

  std::string kernel() const {
    const std::string of = order < 0 ? "without terms" : "of order " + std::to_string(order);
    return (is_polynomial ? "Zernike polynomial " : "Zernike recurrence ") + of;
  }
  std::size_t data_bytes() const {
    std::size_t row_count = 0;
    for (int g = 0; g < group_count; ++g) row_count += static_cast<std::size_t>(groups[g].row_count);
    const std::size_t terms = is_polynomial ? numerics::Polynomial::count(order) * sizeof *polynomial.coefficients
                                            : static_cast<std::size_t>(group_count) * sizeof *groups + row_count * sizeof *rows;
    return sizeof *this + terms;
  }

  template <class T>
  [[gnu::always_inline]] Sum<T> sum_of_polynomial(const T& x, const T& y) const {
    Sum<T> sum = polynomial.evaluate<T>(x * per_radius, y * per_radius);
    sum.along_x = sum.along_x * per_radius;
    sum.along_y = sum.along_y * per_radius;
    return sum;
  }
  template <class T>
  Sum<T> sum(const T& x, const T& y) const {
    return is_polynomial ? sum_of_polynomial(x, y) : sum_by_recurrence(x, y);
  }
  template <class T>
  Sum<T> sum_by_recurrence(const T& x, const T& y) const {
    const T X = x * T(per_radius), Y = y * T(per_radius), u = X * X + Y * Y;
    T z(0), z_X(0), z_Y(0);
    T re(1), im(0), re_before(0), im_before(0);  // h_m and h_(m-1)
    int m = 0;
    for (int g = 0; g < group_count; ++g) {
      const Group& group = groups[g];
      for (; m < group.m; ++m) {
        re_before = re;
        im_before = im;
        re = X * re_before - Y * im_before;
        im = X * im_before + Y * re_before;
      }
      const Row* row = rows + group.first_row;
      T p(1), p_before(0), q(0), q_before(0);  // P_k and dP_k/du
      T cosine(row->cosine), sine(row->sine), cosine_u(0), sine_u(0);
      for (int k = 1; k < group.row_count; ++k) {
        ++row;
        const T factor = T(row->a) * u + T(row->b);
        const T p_next = factor * p - T(row->c) * p_before;                      // (3) of zernike_basis.h
        const T q_next = factor * q + T(row->a) * p - T(row->c) * q_before;
        p_before = p;
        p = p_next;
        q_before = q;
        q = q_next;
        cosine += T(row->cosine) * p;
        sine += T(row->sine) * p;
        cosine_u += T(row->cosine) * q;
        sine_u += T(row->sine) * q;
      }
      const T radial_u = re * cosine_u + im * sine_u;
      z += re * cosine + im * sine;                                                          // (2)
      z_X += T(2) * X * radial_u + T(m) * (re_before * cosine + im_before * sine);           // (3)
      z_Y += T(2) * Y * radial_u + T(m) * (re_before * sine - im_before * cosine);
    }
    return {z, z_X * T(per_radius), z_Y * T(per_radius)};
  }

  void meet_block(const BlockOfLines& lines, BlockOfCrossings& crossings) const {
    if (is_polynomial) return ConicDeparture::meet_block(lines, crossings);
    for (int i = 0; i < lines.count; ++i)
      if (lines.travels[i]) crossings.put(i, meet(Vec3<double>{lines.x[i], lines.y[i], lines.z[i]}, Vec3<double>{lines.l[i], lines.m[i], lines.n[i]}));
  }

  double vertex_curvature() const { return curvature_along(-1); }
  double vertex_curvature_x() const { return curvature_along(1); }
  // c plus the y^2 or x^2 terms of the sum: only m = 0 (u = Y^2 or X^2: dP/du) and m = 2 cosine (Re h_2 = -Y^2 or X^2, its sign) have them.
  double curvature_along(int sign) const {
    double second = 0;
    for (int g = 0; g < group_count; ++g) {
      if (groups[g].m != 0 && groups[g].m != 2) continue;
      const Row* row = rows + groups[g].first_row;
      double p = 1, p_before = 0, q = 0, q_before = 0;  // at u = 0
      for (int k = 0; k < groups[g].row_count; ++k, ++row) {
        if (k > 0) {
          const double p_next = row->b * p - row->c * p_before;
          const double q_next = row->b * q + row->a * p - row->c * q_before;
          p_before = p, p = p_next, q_before = q, q = q_next;
        }
        second += row->cosine * (groups[g].m == 0 ? 2 * q : sign * 2 * p);
      }
    }
    return base.curvature + second * per_radius * per_radius;
  }

  // (4)
  template <class T>
  T bound_within(const T& radius, int derivatives) const {
    const T s = radius * T(per_radius) > T(1) ? T(radius * T(per_radius)) : T(1), per = T(per_radius) / s;
    T sum(0), chebyshev(1), before = s;  // T_n(s), T_(n-1)(s)
    for (int n = 0; n <= order; ++n) {
      double of_chebyshev = 1;  // T_n^(k)(1)
      for (int k = 0; k < derivatives; ++k) of_chebyshev *= (1.0 * n * n - 1.0 * k * k) / (2 * k + 1);
      sum += T(sizes[n] * of_chebyshev) * chebyshev;
      const T next = T(2) * s * chebyshev - before;
      before = chebyshev, chebyshev = next;
    }
    for (int k = 0; k < derivatives; ++k) sum *= per;
    return sum;
  }
  template <class T>
  T size_of_terms(const T&, const T&) const {
    return T(size_at_any_place);
  }
  template <class T>
  T steepest_squared_within(const T& r_squared) const {
    const T rho_squared = r_squared * T(per_radius * per_radius), unknown(std::numeric_limits<double>::infinity());
    return select<T>(rho_squared <= T(1), T(steepest_squared[0]), select<T>(rho_squared <= T(wider * wider), T(steepest_squared[1]), unknown));
  }
  // For first_crossing.h. Outside r0 the bound grows as T_n does: a step to 1 + n^(-3/2) of the radius keeps that below 10 for n up to 20.
  template <class T>
  T reach_from(const T& r) const {
    const T r0 = T(1) / T(per_radius), further = T(1) + T(1 / (order * std::sqrt(static_cast<double>(order))));
    return r * further < r0 ? r0 : T(r * further);
  }

  // The size of a polynomial's terms beside r0 and the heights. Their rounding adds up to 2 N eps of them at worst, and in fact to eps/30
  // (order 8 and 12): one ulp of the system's size, where the worst would cost two digits.
  static constexpr double most_cancellation = 32;
};

}  // namespace sagitta::surface
