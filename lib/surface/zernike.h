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
// Intersection. From the conic's hit on, Newton's method on the implicit form, in which no root appears: with p the sum,
//   g(t) = w - c/2 (x^2 + y^2 + (1+K) w^2) = 0,   w = z - p(x, y)                                                 (4)
//   g' = G (d_z - p_x d_x - p_y d_y) - c (x d_x + y d_y),   G = 1 - (1+K) c w > 0 on the sheet of the vertex.
// It ends when |g| is at its rounding, or with a step that moves (x, y) by less than rounding, so that p stays what it is, if
// what g'' adds is below rounding too. What it finds is the hit if no other crossing can be on the way: the slope of the conic along the
// line lies between those at both ends, for its sag is convex or concave, and
//   |D^k p| <= sum |C_j N_j| T_n^(k)(1) T_n(s)/(s r0)^k   for rho <= s, s >= 1;   G, of the gradient, for k = 1           (5)
// (|Z_j/N_j| <= 1 in the unit disc, T_n(s) outside, T_n Chebyshev's polynomial, and a polynomial's derivatives along lines in the disc are
// below T_n^(k)(1) = prod_(i<k) (n^2 - i^2)/(2i + 1) of that), so
//   d_z - L dz/dx - M dz/dy keeps its sign if at both ends that of the conic alone is beyond sqrt(L^2 + M^2) G.        (6)
// Where it does not end at once, or (6) does not hold, first_crossing.h goes the way in steps that pass neither crossing nor fold, by (5) for k = 2, 3.
//
// Source: Harris, J. Math. Anal. Appl. 368, 374 (2010), for (5) (V. A. Markov's inequality in a disc).
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
#include "lib/surface/departure_block.h"
#include "lib/surface/first_crossing.h"

namespace sagitta::surface {

struct Zernike {
  static constexpr std::string_view kind = "zernike";
  static constexpr std::array keys{
      numerics::Key{.name = "radius_mm", .meaning = "vertex radius of the base conic",
                    .range = numerics::nonzero_or_infinite, .fallback = std::numeric_limits<double>::infinity()},
      numerics::Key{.name = "conic_constant", .meaning = "K of the base conic: 0 sphere, -1 paraboloid", .range = conic_constants},
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

  Conic base;
  double per_radius = 1;  // 1/r0
  const Group* groups = nullptr;
  int group_count = 0;
  const Row* rows = nullptr;
  bool is_polynomial = false;  // then the sum is this one, in X and Y
  numerics::Polynomial polynomial;
  double coefficient_sum = 0;  // sum |C_j norm_j|, the size of the terms inside r0
  const double* sizes = nullptr;  // the same by order, from 0 to `order`
  static constexpr double wider = 1.2;  // than r0: rays from there to here can still be told to pass no other crossing
  double steepest_squared[2] = {0, 0};  // G^2 of (5) at s = 1 and `wider`
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
      result.coefficient_sum += std::abs(scaled);
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
    const double heights = std::abs(result.base.curvature) / (2 * result.per_radius * result.per_radius) + result.coefficient_sum;
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

  // The sum and its gradient along x and y, in mm and 1.
  template <class T>
  using Sum = numerics::Polynomial::WithGradient<T>;

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

  template <class T>
  Height<T> height(const T& x, const T& y) const {
    using std::abs;
    const Sum<T> p = sum(x, y);
    const T base_z = base.sag(x, y);
    const Gradient<T> slope = base.gradient(x, y);
    return {base_z + p.value, slope.x + p.along_x, slope.y + p.along_y, abs(base_z) + abs(p.value) + T(coefficient_sum)};
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
      approach = look_at(start.point, d, approach, sum(start.point.x + approach.t * d.x, start.point.y + approach.t * d.y), look == 0);
    if (approach.state != T(Approach<T>::arrived) || !passes_no_other(start.point, d, approach)) return first_crossing(*this, start, d);
    const Vec3<T> normal{-approach.slope_x, -approach.slope_y, T(1)};
    return {start.path + approach.t, start.point + approach.t * d, normal, dot(normal, d), Status::ok};
  }

  void meet_block(const BlockOfLines& lines, BlockOfCrossings& crossings) const {
    if (is_polynomial) return meet_departures(*this, lines, crossings);
    for (int i = 0; i < lines.count; ++i)
      if (lines.travels[i]) crossings.put(i, meet(Vec3<double>{lines.x[i], lines.y[i], lines.z[i]}, Vec3<double>{lines.l[i], lines.m[i], lines.n[i]}));
  }

  // c plus the y^2 terms of the sum: only m = 0 (u = Y^2: dP/du) and m = 2 cosine (Re h_2 = -Y^2) have them.
  double vertex_curvature() const {
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
        second += row->cosine * (groups[g].m == 0 ? 2 * q : -2 * p);
      }
    }
    return base.curvature + second * per_radius * per_radius;
  }

  // (5)
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
  // For first_crossing.h. Outside r0 the bound grows as T_n does: a step to 1 + n^(-3/2) of the radius keeps that below 10 for n up to 20.
  template <class T>
  T reach_from(const T& r) const {
    const T r0 = T(1) / T(per_radius), further = T(1) + T(1 / (order * std::sqrt(static_cast<double>(order))));
    return r * further < r0 ? r0 : T(r * further);
  }

  // The iteration on (4): where the next look is; where the last one was, g there, and the slopes of the surface.
  static constexpr int most_looks = 5;
  // The size of a polynomial's terms beside r0 and the heights. Their rounding adds up to 2 N eps of them at worst, and in fact to eps/30
  // (order 8 and 12): one ulp of the system's size, where the worst would cost two digits.
  static constexpr double most_cancellation = 32;
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
    const auto at_rounding = abs(g) <= eps * G * (abs(z) + abs(p.value) + T(coefficient_sum));
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
  // (6), with room for its own rounding.
  template <class T>
  auto passes_no_other(const Vec3<T>& origin, const Vec3<T>& d, const Approach<T>& end) const {
    const T c(base.curvature), n_z = T(1) - (T(1) + T(base.conic_constant)) * c * origin.z;
    const T along = n_z * d.z - c * (origin.x * d.x + origin.y * d.y), x = origin.x + end.t * d.x, y = origin.y + end.t * d.y;
    const T r_squared = origin.x * origin.x + origin.y * origin.y, end_r_squared = x * x + y * y;
    const T rho_squared = select<T>(r_squared > end_r_squared, r_squared, end_r_squared) * T(per_radius * per_radius);
    const T slopes = T(1 + 1e-9) * (d.x * d.x + d.y * d.y) * select<T>(rho_squared <= T(1), T(steepest_squared[0]), T(steepest_squared[1]));
    return (rho_squared <= T(wider * wider)) & (along * end.base_along > T(0)) & (along * along > n_z * n_z * slopes) & (end.base_along * end.base_along > slopes);
  }
};

}  // namespace sagitta::surface
