// SPDX-License-Identifier: Apache-2.0
// The corneas behind ../shared/data/synthetic, by their formulas, in long double: mm, OSA axes (x to the examiner's right), sag
// into the eye.
//
//   normal       biconic, Rx 7.83, Ry 7.70, K -0.18 for both sections, and 11 OSA Zernike terms over a radius of 3 mm
//   keratoconus  minus a Gaussian of 25 um, sigma 1 mm, about (-0.6, -1.1)
//   post-LASIK   Munnerlyn's ablation of -4 D inside 3 mm (R1 7.77, n 1.376), and a cubic to 4 mm with its slope
//
// The first two are what references.md section 5.2 prints; R1 and the cubic are what its files hold, to their last digit. Beyond
// 3 mm the files flatten the Zernike terms in a way that is not printed: there these formulas are surfaces of their own.
#pragma once

#include <array>
#include <cmath>

namespace sagitta::tests {

enum class Cornea { normal, keratoconus, post_lasik };

class SyntheticCornea {
 public:
  using Real = long double;
  explicit SyntheticCornea(Cornea kind) : kind_(kind) {}

  Real sag(Real x, Real y) const {
    const Real cx = 1 / 7.83L, cy = 1 / 7.70L, one_plus_K = 1 - 0.18L;
    Real z = (cx * x * x + cy * y * y) / (1 + std::sqrt(1 - one_plus_K * (cx * cx * x * x + cy * cy * y * y)));
    for (const Term& term : terms) z += term.um * 1e-3L * zernike(term.order, term.m, x / 3, y / 3);
    if (kind_ == Cornea::keratoconus) z -= 0.025L * std::exp(-((x + 0.6L) * (x + 0.6L) + (y + 1.1L) * (y + 1.1L)) / 2);
    if (kind_ == Cornea::post_lasik) z += ablation(std::hypot(x, y));
    return z;
  }
  // By central differences: h^2/6 of the third derivative, and 1e-19/h of rounding, 1e-13 both.
  std::array<Real, 2> gradient(Real x, Real y) const {
    constexpr Real h = 1e-6L;
    return {(sag(x + h, y) - sag(x - h, y)) / (2 * h), (sag(x, y + h) - sag(x, y - h)) / (2 * h)};
  }

 private:
  struct Term {
    int order, m;
    Real um;
  };
  static constexpr Term terms[] = {{3, -3, -.10L}, {3, -1, -.35L}, {3, 1, .12L},  {3, 3, .05L},  {4, -4, .03L}, {4, -2, -.02L},
                                   {4, 2, -.04L},  {4, 4, .04L},   {5, -1, .02L}, {5, 1, -.01L}, {6, 0, .01L}};

  // The textbook's power series, orthonormal.
  static Real zernike(int order, int m, Real x, Real y) {
    const int k = m < 0 ? -m : m;
    const Real r = std::hypot(x, y), angle = std::atan2(y, x);
    const auto factorial = [](int i) { return std::tgamma(static_cast<Real>(i) + 1); };
    Real sum = 0;
    for (int s = 0; s <= (order - k) / 2; ++s)
      sum += (s % 2 == 0 ? 1 : -1) * factorial(order - s) / (factorial(s) * factorial((order + k) / 2 - s) * factorial((order - k) / 2 - s)) *
             std::pow(r, static_cast<Real>(order - 2 * s));
    return std::sqrt(static_cast<Real>((m == 0 ? 1 : 2) * (order + 1))) * sum * (m < 0 ? std::sin(k * angle) : std::cos(k * angle));
  }

  static Real ablation(Real r) {
    const Real before = 7.77L, after = 1 / (1 / before - 4 / (1000 * 0.376L)), zone = 3, blend = 1;
    const auto sphere = [](Real R, Real at) { return R - std::sqrt(R * R - at * at); };
    const auto slope = [](Real R, Real at) { return at / std::sqrt(R * R - at * at); };
    if (r <= zone) return sphere(after, r) - sphere(before, r) - (sphere(after, zone) - sphere(before, zone));
    const Real u = (r - zone) / blend;
    return u < 1 ? (slope(after, zone) - slope(before, zone)) * blend * u * (1 - u) * (1 - u) : 0;
  }

  Cornea kind_;
};

}  // namespace sagitta::tests
