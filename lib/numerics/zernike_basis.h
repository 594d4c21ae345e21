// SPDX-License-Identifier: Apache-2.0
// Zernike circle polynomials: their indexings, normalisation, and an evaluation that keeps its digits at any order.
//
//   Z_n^m = N_n^m R_n^|m|(rho) { cos(m theta), m >= 0;  sin(|m| theta), m < 0 },   theta from +x, anticlockwise     (1)
//   R_n^m(rho) = rho^m P_k^(0,m)(2 rho^2 - 1),   k = (n - m)/2,   P the Jacobi polynomials                         (2)
//
// rho^m cos(m theta) and rho^m sin(m theta) are the real and imaginary parts h_m of (x + i y)^m: no angle is formed and
// the centre is a point like any other. With u = rho^2 the Jacobi polynomials follow
//   P_0 = 1,   P_k = (a_k u + b_k) P_(k-1) - c_k P_(k-2)                                                           (3)
//   a_k = (2k+m-1)(2k+m)/(k(k+m)),   b_k = -(2k+m-1)((2k+m)(2k+m-2) + m^2)/(2k(k+m)(2k+m-2)),
//   c_k = (k-1)(k+m-1)(2k+m)/(k(k+m)(2k+m-2));   a_1 = m+2, b_1 = -(m+1), c_1 = 0,
// which is stable forwards: 1e-13 at order 40, where the textbook's power series is wrong by 2e-4.
//
// Indexings: osa (ANSI Z80.28, from 0), noll (from 1; even index: cosine), both with N = sqrt(2(n+1)/(1 + delta_m0)),
// so that the mean of Z^2 over the disc is 1; fringe (1 to 37, N = 1, the last being the 12th order spherical term).
//
// Sources: ANSI Z80.28-2017; Noll, J. Opt. Soc. Am. 66, 207 (1976), eqs. 1 to 3; NIST Digital Library of Mathematical
// Functions, 18.9.2 and table 18.6.1.
#pragma once

#include <cmath>
#include <cstdlib>
#include <string_view>

#include "lib/numerics/key.h"

namespace sagitta::numerics {

enum class ZernikeIndexing { osa, noll, fringe };

inline constexpr std::string_view zernike_indexings = "osa|noll|fringe";

constexpr ZernikeIndexing zernike_indexing(std::string_view name) {
  return name == "noll" ? ZernikeIndexing::noll : name == "fringe" ? ZernikeIndexing::fringe : ZernikeIndexing::osa;
}
constexpr int first_zernike_index(ZernikeIndexing indexing) { return indexing == ZernikeIndexing::osa ? 0 : 1; }
// Orders up to 100: beyond it nobody has a use, and tables would grow without bound.
constexpr int last_zernike_index(ZernikeIndexing indexing) {
  return indexing == ZernikeIndexing::osa ? 5150 : indexing == ZernikeIndexing::noll ? 5151 : 37;
}
constexpr IndexRange zernike_index_range(std::string_view indexing) {
  return {first_zernike_index(zernike_indexing(indexing)), last_zernike_index(zernike_indexing(indexing))};
}

// A term of (1): radial order n, azimuthal order m (negative: sine).
struct ZernikeTerm {
  int n = 0, m = 0;
  friend constexpr bool operator==(ZernikeTerm, ZernikeTerm) = default;
};

constexpr ZernikeTerm osa_term(int index) {
  int n = 0;
  while ((n + 1) * (n + 2) / 2 <= index) ++n;
  return {n, 2 * index - n * (n + 2)};
}

// Within one order noll counts |m| upwards, the pair +-m such that the even index is the cosine.
constexpr ZernikeTerm noll_term(int index) {
  int n = 0;
  while ((n + 1) * (n + 2) / 2 < index) ++n;
  const int place = index - n * (n + 1) / 2;                     // 1 ... n + 1
  const int m = n % 2 == 0 ? 2 * (place / 2) : 2 * ((place - 1) / 2) + 1;
  return {n, index % 2 == 0 ? m : -m};
}

// index = (1 + (n+|m|)/2)^2 - 2|m| + (m < 0), and 37 is (12, 0).
constexpr ZernikeTerm fringe_term(int index) {
  if (index == 37) return {12, 0};
  int half_sum = 0;  // (n + |m|)/2
  while ((half_sum + 1) * (half_sum + 1) < index) ++half_sum;
  const int down = (half_sum + 1) * (half_sum + 1) - index;  // 2|m| or 2|m| - 1
  const int m = (down + 1) / 2;
  return {2 * half_sum - m, down % 2 == 0 ? m : -m};
}

constexpr ZernikeTerm zernike_term(ZernikeIndexing indexing, int index) {
  switch (indexing) {
    case ZernikeIndexing::osa: return osa_term(index);
    case ZernikeIndexing::noll: return noll_term(index);
    case ZernikeIndexing::fringe: return fringe_term(index);
  }
  return {};
}

inline double zernike_norm(ZernikeIndexing indexing, ZernikeTerm term) {
  if (indexing == ZernikeIndexing::fringe) return 1;
  return std::sqrt(term.m == 0 ? term.n + 1.0 : 2 * (term.n + 1.0));
}

// The coefficients of (3).
struct JacobiStep {
  double a, b, c;
};
constexpr JacobiStep jacobi_step(int k, int m) {
  if (k == 1) return {m + 2.0, -(m + 1.0), 0};
  const double kd = k, md = m, s = 2 * kd + md;  // exact: products stay far below 2^53
  return {(s - 1) * s / (kd * (kd + md)), -(s - 1) * (s * (s - 2) + md * md) / (2 * kd * (kd + md) * (s - 2)),
          (kd - 1) * (kd + md - 1) * s / (kd * (kd + md) * (s - 2))};
}

// The value of one term at (x, y) = rho (cos theta, sin theta), with its norm.
template <class T>
T zernike_value(ZernikeIndexing indexing, ZernikeTerm term, const T& x, const T& y) {
  const int m = std::abs(term.m);
  T cosine(1), sine(0);
  for (int i = 0; i < m; ++i) {
    const T next = x * cosine - y * sine;
    sine = x * sine + y * cosine;
    cosine = next;
  }
  const T u = x * x + y * y;
  T before(0), value(1);
  for (int k = 1; k <= (term.n - m) / 2; ++k) {
    const JacobiStep step = jacobi_step(k, m);
    const T next = (T(step.a) * u + T(step.b)) * value - T(step.c) * before;
    before = value;
    value = next;
  }
  return T(zernike_norm(indexing, term)) * value * (term.m < 0 ? sine : cosine);
}

}  // namespace sagitta::numerics
