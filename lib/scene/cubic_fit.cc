// SPDX-License-Identifier: Apache-2.0
#include "lib/scene/cubic_fit.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lib/numerics/instruction_set.h"

namespace sagitta::scene {
namespace {

constexpr auto cubic_terms = static_cast<std::size_t>(CubicFit::cubic_terms);
constexpr std::size_t height = cubic_terms;  // the column

constexpr double most_amplified = 64;  // the right side of (3)
constexpr double smallest_square = 1e-290;

// (1), from sums of X^2, XY and Y^2. Points that all lie on one line through V leave it zero, and nothing is determined.
CubicFit coordinates_of(double count, double xx, double xy, double yy) {
  const double shear = xy / xx, vv = yy - shear * xy;
  CubicFit fit{};
  // (Rounding may leave a line some vv, about eps yy, far above the true one: then v is small, and (3) refuses it.)
  if (!(xx > smallest_square && vv > smallest_square)) return fit;
  fit.u_per_x = std::sqrt(count / xx);
  fit.v_per_y = std::sqrt(count / vv);
  fit.shear = shear;
  return fit;
}

}  // namespace

void CubicFits::put(std::size_t lane, const numerics::Vec3<double>& V, const numerics::Vec3<double>* points, std::span<const std::uint32_t> around) {
  if (rows_.size() < around.size()) rows_.resize(around.size());
  counts_[lane] = around.size();
  for (std::size_t i = 0; i < around.size(); ++i) {
    const numerics::Vec3<double> q = points[around[i]] - V;
    rows_[i][0][lane] = q.x;
    rows_[i][1][lane] = q.y;
    rows_[i][height][lane] = q.z;
  }
}

// Column k, finished, is taken out of those behind it. `sums`, before: of its products with them; after: of the next one's.
template <std::size_t k>
[[gnu::always_inline]] inline void CubicFits::eliminate(std::size_t row_count, Row& sums, std::array<Row, CubicFit::cubic_terms>& F) {
  F[k][k] = sums[k];  // 1/D
  for (std::size_t j = k + 1; j <= height; ++j) F[k][j] = sums[j] / sums[k];
  if constexpr (k + 1 < cubic_terms) {
    const Row factors = F[k];
    Row next{};
    for (std::size_t i = 0; i < row_count; ++i) {
      Row& row = rows_[i];
      const Lanes p = row[k];
      for (std::size_t j = k + 1; j <= height; ++j) row[j] -= factors[j] * p;
      const Lanes q = row[k + 1];
      for (std::size_t j = k + 1; j <= height; ++j) next[j] += q * row[j];
    }
    sums = next;
    eliminate<k + 1>(row_count, sums, F);
  }
}

[[gnu::always_inline]] inline CubicFits::Fits CubicFits::solve_here() {
  const std::size_t row_count = *std::max_element(counts_.begin(), counts_.end());
  // Rows of zeros add nothing to any sum, to the bit.
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    for (std::size_t i = counts_[lane]; i < row_count; ++i) rows_[i][0][lane] = rows_[i][1][lane] = rows_[i][height][lane] = 0;
  }

  Lanes xx{}, xy{}, yy{};
  for (std::size_t i = 0; i < row_count; ++i) {
    const Lanes X = rows_[i][0], Y = rows_[i][1];
    xx += X * X, xy += X * Y, yy += Y * Y;
  }
  std::array<CubicFit, lanes> fits;
  Lanes count, u_per_x, v_per_y, shear;
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    count[lane] = static_cast<double>(std::exchange(counts_[lane], 0));
    fits[lane] = coordinates_of(count[lane], xx[lane], xy[lane], yy[lane]);
    u_per_x[lane] = fits[lane].u_per_x, v_per_y[lane] = fits[lane].v_per_y, shear[lane] = fits[lane].shear;
  }

  Row sums{};
  for (std::size_t i = 0; i < row_count; ++i) {
    Row& row = rows_[i];
    const Lanes u = u_per_x * row[0], v = v_per_y * (row[1] - shear * row[0]);
    row[0] = u, row[1] = v;
    row[2] = u * u, row[3] = u * v, row[4] = v * v;
    row[5] = u * row[2], row[6] = v * row[2], row[7] = u * row[4], row[8] = v * row[4];
    for (std::size_t j = 0; j <= height; ++j) sums[j] += u * row[j];
  }
  std::array<Row, cubic_terms> F;
  eliminate<0>(row_count, sums, F);

  // Column by column of F^-1.
  Row c{};
  Lanes amplified{};
  for (std::size_t j = 0; j < cubic_terms; ++j) {
    Row column;
    column[j] = Lanes{} + 1;
    Lanes squares = column[j];
    for (std::size_t i = j; i-- > 0;) {
      Lanes sum{};
      for (std::size_t m = i + 1; m <= j; ++m) sum -= F[i][m] * column[m];
      column[i] = sum;
      squares += sum * sum;
    }
    for (std::size_t i = 0; i <= j; ++i) c[i] += column[i] * F[j][height];
    amplified += squares / F[j][j];
    const int terms = static_cast<int>(j) + 1;
    if (terms != CubicFit::plane_terms && terms != CubicFit::quadratic_terms && terms != CubicFit::cubic_terms) continue;
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      if (!(amplified[lane] <= most_amplified)) continue;
      fits[lane].terms = terms;
      for (std::size_t i = 0; i <= j; ++i) fits[lane].c[i] = c[i][lane];
    }
  }
  return fits;
}

#if defined(__x86_64__)
[[gnu::target("arch=x86-64-v3")]] CubicFits::Fits CubicFits::solve_for_v3() { return solve_here(); }
#endif

std::array<CubicFit, CubicFits::lanes> CubicFits::solve() {
#if defined(__x86_64__)
  if (numerics::instruction_set() != numerics::InstructionSet::any) return solve_for_v3();
#endif
  return solve_here();
}

}  // namespace sagitta::scene
