// SPDX-License-Identifier: Apache-2.0
// One step of a ray through a gradient-index medium, and what it is off by.
//
// With t the optical parameter, dt = ds/n, and p = n dr/ds the optical direction, |p| = n, the ray equation and the optical path are
//   r'' = n grad n,   p = r',   S' = n^2                                                                            (1)
// without a root or a division. A step h is made of j = 1, ..., K small ones by the leapfrog
//   p += (h/2j) r'',  r += (h/j) p,  p += (h/2j) r'';   S by the trapezoidal rule at its places                         (2)
// which is symmetric: its increments D_j have errors in even powers of h/j, and of them
//   D = D_K + sum_(j<K) w_j (D_j - D_K),   w_j = prod_(i != j) j^2/(j^2 - i^2)                                       (3)
// is of order 2K, the same without j = 1 of order 2K - 2, and the difference of the two
//   E = sum_(j<K) (w_j/j^2) (D_j - D_K)                                                                            (4)
// is the error of the latter. This is an embedded Runge-Kutta-Nystroem pair of order 2K(2K-2) with rational coefficients, in K(K+1)/2 + 1
// evaluations of the medium. K = 6 in double: the lens of an eye is one step of 22 evaluations to 1e-12 mm, where Dormand and Prince's 5(4) takes 220 and
// Fehlberg's 8(7) takes 65 (a rod of three pitches: 990, 7500 and 1700). Longer numbers take K = 14.
//
// Source: Sharma, Kumar and Ghatak, Appl. Opt. 21, 984 (1982), for (1); Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I (2nd ed.,
// 1993), sections II.9 (extrapolation of symmetric methods, harmonic sequence) and II.14 (second order equations).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "lib/gradient_index/field.h"

namespace sagitta::gradient_index {

template <class T>
struct State {
  Vec3<T> position, optical_direction;  // r, p
  T opl;                                // S
};

// What the error of a step is measured in.
inline constexpr double default_tolerance_mm = 1e-12;
struct Tolerance {
  double mm = default_tolerance_mm;  // of the place, of the optical path, and of the place a millimetre further on
};

template <class T>
struct Leap {
  State<T> behind;
  double error;  // in units of the tolerance, or of the increments' rounding where that is larger; NaN where there is no medium
};

template <class T>
inline constexpr int small_steps = std::numeric_limits<T>::digits > 64 ? 14 : 6;  // K

template <class T>
double size_of(const T& value) {
  using std::abs;
  return static_cast<double>(T(abs(value)));
}
template <class T>
double size_of(const Vec3<T>& v) {
  return std::sqrt(static_cast<double>(T(dot(v, v))));
}

// By how much the next step may be longer, or this one must be shorter. The error goes with a power of the step beyond the eighth; roots alone have the same bits in
// every library of mathematics.
inline double step_factor(double error) {
  const double eighth = std::sqrt(std::sqrt(std::sqrt(error)));
  return error <= 1 ? std::min(0.9 / std::sqrt(eighth), 4.0) : error > 1 ? std::clamp(0.9 / eighth, 0.1, 0.5) : 0.1;  // NaN last
}

template <class T, int K>
struct ExtrapolationWeights {
  std::array<T, K> of_sum, of_error;  // (3), (4)

  ExtrapolationWeights() {
    for (int j = 1; j <= K; ++j) {
      T product(1);
      for (int i = 1; i <= K; ++i)
        if (i != j) product = product * (T(j * j) / T(j * j - i * i));
      of_sum[static_cast<std::size_t>(j - 1)] = product;
      of_error[static_cast<std::size_t>(j - 1)] = product / T(j * j);
    }
  }
};

// From `from`, where the medium is `at`, by h, which may be negative.
template <class T, class Medium>
Leap<T> leap(const Medium& medium, const State<T>& from, const InMedium<T>& at, const T& h, const Tolerance& tolerance) {
  constexpr int K = small_steps<T>;
  static const ExtrapolationWeights<T, K> weights;
  std::array<State<T>, K> increments;
  for (int j = 1; j <= K; ++j) {
    const T small = h / T(j), half = T(0.5) * small;
    State<T> sum{{T(0), T(0), T(0)}, {T(0), T(0), T(0)}, T(0)};
    InMedium<T> here = at;
    for (int i = 0; i < j; ++i) {  // (2)
      sum.optical_direction = sum.optical_direction + half * here.pull;
      sum.position = sum.position + small * (from.optical_direction + sum.optical_direction);
      const T before = here.squared_index;
      here = medium.at(from.position + sum.position);
      sum.optical_direction = sum.optical_direction + half * here.pull;
      sum.opl = sum.opl + half * (before + here.squared_index);
    }
    increments[static_cast<std::size_t>(j - 1)] = sum;
  }
  const State<T>& finest = increments.back();
  State<T> increment = finest, error{{T(0), T(0), T(0)}, {T(0), T(0), T(0)}, T(0)};
  for (std::size_t j = 0; j + 1 < K; ++j) {
    const T &w = weights.of_sum[j], &e = weights.of_error[j];
    const Vec3<T> dr = increments[j].position - finest.position, dp = increments[j].optical_direction - finest.optical_direction;
    const T ds = increments[j].opl - finest.opl;
    increment = {increment.position + w * dr, increment.optical_direction + w * dp, increment.opl + w * ds};  // (3)
    error = {error.position + e * dr, error.optical_direction + e * dp, error.opl + e * ds};                  // (4)
  }
  const double rounding = 64 * static_cast<double>(std::numeric_limits<T>::epsilon());
  const auto in_units = [&](double off, double of) { return off / std::max(tolerance.mm, rounding * of); };
  const double worst[]{in_units(size_of(error.position), size_of(increment.position)),
                       in_units(size_of(error.optical_direction), size_of(from.optical_direction)), in_units(size_of(error.opl), size_of(increment.opl))};
  return {{from.position + increment.position, from.optical_direction + increment.optical_direction, from.opl + increment.opl},
          worst[0] + worst[1] + worst[2]};  // a sum, so that NaN stays
}

// The place a part of a step behind `from`, by the polynomial of fifth degree through places, directions and accelerations at both ends: off by some 1e-5 of what
// the ray turns by, to the sixth power. For looking where a surface is.
inline Vec3<double> place_within(const State<double>& from, const Vec3<double>& pull_from, const State<double>& to, const Vec3<double>& pull_to, double h, double part) {
  const double s = part, rest = 1 - s, s3 = s * s * s, rest3 = rest * rest * rest;
  const double p1 = s3 * (10 - s * (15 - 6 * s)), v0 = s * rest3 * (1 + 3 * s), v1 = -s3 * rest * (1 + 3 * rest), a0 = s * s * rest3 / 2, a1 = s3 * rest * rest / 2;
  return from.position + p1 * (to.position - from.position) + (h * v0) * from.optical_direction + (h * v1) * to.optical_direction + (h * h * a0) * pull_from +
         (h * h * a1) * pull_to;
}

}  // namespace sagitta::gradient_index
