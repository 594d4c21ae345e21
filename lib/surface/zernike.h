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
// order 40).
#pragma once

#include <array>
#include <cmath>
#include <cstdlib>
#include <map>
#include <vector>

#include "lib/numerics/key.h"
#include "lib/numerics/zernike_basis.h"
#include "lib/surface/departure.h"

namespace sagitta::surface {

struct Zernike {
  static constexpr std::string_view kind = "zernike";
  static constexpr std::array keys{
      numerics::Key{.name = "radius_mm", .meaning = "vertex radius of the base conic",
                    .range = numerics::nonzero_or_infinite, .fallback = std::numeric_limits<double>::infinity()},
      numerics::Key{.name = "conic_constant", .meaning = "K of the base conic: 0 sphere, -1 paraboloid"},
      numerics::Key{.name = "normalization_radius_mm", .meaning = "radius at which rho = 1", .required = true,
                    .range = numerics::positive},
      numerics::Key{.name = "indexing", .kind = numerics::ValueKind::text, .meaning = "order and normalisation of the terms",
                    .required = true, .choices = numerics::zernike_indexings},
      numerics::Key{.name = "coefficients_um", .kind = numerics::ValueKind::indexed,
                    .meaning = "coefficient of each term: {index: value} or a list from the first", .required = true,
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
  double coefficient_sum = 0;  // sum |C_j norm_j|, the size of the terms inside r0

  template <class Parameters, class Arena>
  static Zernike from(const Parameters& given, Arena& arena) {
    const auto indexing = numerics::zernike_indexing(given.text("indexing"));
    std::map<int, std::vector<Row>> by_order;
    Zernike result;
    for (const auto& [index, micrometres] : given.list("coefficients_um")) {
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
      result.coefficient_sum += std::abs(scaled);
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
    return result;
  }

  template <class T>
  Height<T> height(const T& x, const T& y) const {
    using std::abs;
    const T X = x * T(per_radius), Y = y * T(per_radius), u = X * X + Y * Y;
    T z(0), z_X(0), z_Y(0), size(coefficient_sum);
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
      size += abs(re * cosine) + abs(im * sine);
      z_X += T(2) * X * radial_u + T(m) * (re_before * cosine + im_before * sine);           // (3)
      z_Y += T(2) * Y * radial_u + T(m) * (re_before * sine - im_before * cosine);
    }
    const T base_z = base.sag(x, y);
    const Gradient<T> slope = base.gradient(x, y);
    return {base_z + z, slope.x + z_X * T(per_radius), slope.y + z_Y * T(per_radius),
            abs(base_z) + size};
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
    return meet_departure(base, *this, p, d);
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
};

}  // namespace sagitta::surface
