// SPDX-License-Identifier: Apache-2.0
// A cubic through one point V, fitted to the points around it by least squares.
//
// With X = x - x_V, Y = y - y_V, the coordinates of the fit are sheared and scaled to the points themselves,
//   u = X / s_u,  v = (Y - t X) / s_v                                                                              (1)
// so that sum u v = 0 and the means of u^2 and v^2 are 1: then it does not matter how long, narrow or slanted the
// neighbourhood is. The model is
//   z - z_V = c_0 u + c_1 v + c_2 u^2 + c_3 u v + c_4 v^2 + c_5 u^3 + c_6 u^2 v + c_7 u v^2 + c_8 v^3              (2)
// The matrix of its terms at the m points becomes Q D F by the modified Gram-Schmidt process, columns of Q orthogonal
// with squares D^-1, F unit upper triangular; the heights are one more column, and c = F^-1 y. That is as stable as
// Householder's process. The first k coefficients are determined where
//   sum_{i<=j<k} (F^-1)_ij^2 / D_j <= 64                                                                           (3)
// so that none takes up more than 8 times the noise of a height: it stays of its size in the surface, on the
// rim and between rings far apart too, where the points lie on one side or in few directions. F's leading blocks serve the
// quadratic (5 terms) and the plane (2 terms), one of which takes the cubic's place where it is not determined.
//
// Source: A. Bjorck, BIT 7, 1 (1967): least squares by the modified Gram-Schmidt process.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "lib/numerics/vec3.h"
#include "lib/surface/clough_tocher.h"

namespace sagitta::scene {

struct CubicFit {
  static constexpr int cubic_terms = 9, quadratic_terms = 5, plane_terms = 2;

  std::array<double, cubic_terms> c;    // (2); zero where not determined
  double u_per_x, v_per_y, shear;       // 1/s_u, 1/s_v and t of (1)
  int terms;                            // determined: 9, 5, 2 or none

  using Slope = surface::CloughTocherPatch::Slope;
  Slope gradient() const { return {u_per_x * c[0] - shear * v_per_y * c[1], v_per_y * c[1]}; }  // at V
  Slope gradient(double X, double Y) const {
    const double u = u_per_x * X, v = v_per_y * (Y - shear * X);
    const double along_u = c[0] + 2 * c[2] * u + c[3] * v + 3 * c[5] * u * u + 2 * c[6] * u * v + c[7] * v * v;
    const double along_v = c[1] + c[3] * u + 2 * c[4] * v + c[6] * u * u + 2 * c[7] * u * v + 3 * c[8] * v * v;
    return {u_per_x * along_u - shear * v_per_y * along_v, v_per_y * along_v};
  }
};

// Fits several cubics at once, one in each lane of the processor's vectors. The bits of a fit depend on its own points
// and their order alone.
class CubicFits {
 public:
  static constexpr std::size_t lanes = 4;

  // Next in this lane: V and the points around it.
  void put(std::size_t lane, const numerics::Vec3<double>& V, const numerics::Vec3<double>* points, std::span<const std::uint32_t> around);
  // What has been put, fitted; nothing is determined in a lane without points.
  std::array<CubicFit, lanes> solve();

 private:
  using Lanes [[gnu::vector_size(lanes * sizeof(double))]] = double;
  // The terms of (2), and the height. Aligned as processors with vectors of this size want it: the compiler aligns such
  // vectors for the machine that it compiles this header for.
  struct alignas(lanes * sizeof(double)) Row {
    Lanes of[CubicFit::cubic_terms + 1];
    Lanes& operator[](std::size_t term) { return of[term]; }
    const Lanes& operator[](std::size_t term) const { return of[term]; }
  };
  using Fits = std::array<CubicFit, lanes>;

  // The same body for each instruction set, with the same bits.
  Fits solve_here();
  Fits solve_for_v3();
  template <std::size_t k>
  void eliminate(std::size_t row_count, Row& sums, std::array<Row, CubicFit::cubic_terms>& F);

  std::vector<Row> rows_;
  std::array<std::size_t, lanes> counts_{};
};

}  // namespace sagitta::scene
