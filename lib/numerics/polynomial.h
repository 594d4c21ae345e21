// SPDX-License-Identifier: Apache-2.0
// A polynomial in x and y, with its gradient, by Horner's rule in y of polynomials in x by Horner's rule:
//
//   p(x, y) = sum_{i+j<=N} c_ij x^i y^j = sum_j y^j p_j(x)                                                         (1)
//
// N(N+3) multiplications and additions for all three, against N(N+3)/2 for p alone. T may be a vector of the compiler:
// coefficients are the same for all its lanes.
//
// Errors: about 2 N eps of sum |c_ij| |x|^i |y|^j; for the gradient likewise.
#pragma once

#include <cstddef>

namespace sagitta::numerics {

struct Polynomial {
  int degree = -1;                       // N; -1: p = 0
  const double* coefficients = nullptr;  // c_0N; c_1(N-1), c_0(N-1); c_2(N-2), ...; the place of c_ij is place()

  static constexpr std::size_t count(int degree) { return static_cast<std::size_t>((degree + 1) * (degree + 2) / 2); }
  static constexpr std::size_t place(int degree, int i, int j) {
    const int row = degree - j;
    return static_cast<std::size_t>(row * (row + 1) / 2 + row - i);
  }

  template <class T>
  struct WithGradient {
    T value, along_x, along_y;
  };
  template <class T>
  [[gnu::always_inline]] WithGradient<T> evaluate(const T& x, const T& y) const {
    if (degree < 0) return {T{}, T{}, T{}};
    const double* c = coefficients;
    WithGradient<T> p{T{} + *c++, T{}, T{}};
    for (int row = 1; row <= degree; ++row) {
      T q = T{} + *c++, q_x = q;  // p_j(x), j = N - row, and its derivative
      q = q * x + *c++;
      for (int i = row - 2; i >= 0; --i) {
        q_x = q_x * x + q;
        q = q * x + *c++;
      }
      p.along_y = p.along_y * y + p.value;
      p.value = p.value * y + q;
      p.along_x = p.along_x * y + q_x;
    }
    return p;
  }
};

}  // namespace sagitta::numerics
