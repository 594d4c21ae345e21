// SPDX-License-Identifier: Apache-2.0
// Zernike terms as polynomials in x and y (polynomial.h):
//
//   Z_n^m = N_n^m h_m sum_s (-1)^s (n-s)! / (s! ((n+m)/2-s)! ((n-m)/2-s)!) u^k,   k = (n-m)/2 - s,   m = |m|        (1)
//   u^k = (x^2 + y^2)^k and h_m, the real or (m < 0) imaginary part of (x + i y)^m, expanded by binomials.
//
// All factors are whole numbers below 2^53 up to the order 12. There cancellation in (1) costs some four digits of a
// term near the rim, 1e-12 of it: beyond, the recurrence of zernike_basis.h is needed.
//
// Source: Born and Wolf, Principles of Optics (7th ed., 1999), section 9.2.1, for the radial polynomials of (1).
#pragma once

#include <cstddef>
#include <cstdlib>
#include <vector>

#include "lib/numerics/polynomial.h"
#include "lib/numerics/zernike_basis.h"

namespace sagitta::numerics {

inline constexpr int highest_zernike_polynomial = 12;  // order

// Adds `factor` times the term, without its norm, to the coefficients of a polynomial of this degree (at least the order).
template <class Number>
void add_zernike_term(ZernikeTerm term, Number factor, int degree, std::vector<Number>& coefficients) {
  const auto binomial = [](int n, int k) {
    Number result = 1;
    for (int i = 1; i <= k; ++i) result = result * Number(n - k + i) / Number(i);  // exact: whole after each step
    return result;
  };
  const int n = term.n, m = std::abs(term.m), half = (n - m) / 2;
  for (int s = 0; s <= half; ++s) {
    const Number radial = (s % 2 == 0 ? 1 : -1) * binomial(n - s, s) * binomial(n - 2 * s, half - s);
    const int k = half - s;
    for (int a = 0; a <= k; ++a)                       // x^(2a) y^(2(k-a))
      for (int b = term.m < 0 ? 1 : 0; b <= m; b += 2) {  // i^b y^b x^(m-b), real or imaginary
        const Number sign = (b / 2) % 2 == 0 ? 1 : -1;
        coefficients[Polynomial::place(degree, 2 * a + m - b, 2 * (k - a) + b)] += factor * radial * binomial(k, a) * sign * binomial(m, b);
      }
  }
}

}  // namespace sagitta::numerics
