// SPDX-License-Identifier: Apache-2.0
// Model corneas in exact form: what systems/measured-cornea.xyz and systems/keratoconic-cornea.xyz are samples of.
//
//   normal       z = b(x, y) + sum C_nm Z_nm(x/3, y/3),   Z_nm orthonormal (osa), C_nm below                         (1)
//                b = q/(1 + sqrt(1 - (1 + K)(x^2/Rx^2 + y^2/Ry^2))),  q = x^2/Rx + y^2/Ry                            (2)
//   keratoconus  (1) - A exp(-((x - x0)^2 + (y - y0)^2)/(2 s^2)): a cone that bulges out of the eye, inferior and to
//                the temporal side of a right eye                                                                   (3)
//
// Rx = 7.83 mm, Ry = 7.70 mm, K = -0.18: with-the-rule astigmatism of 0.7 D. A = 25 um, s = 1 mm, (x0, y0) = (-0.6, -1.1) mm:
// 8 D steeper at the cone. mm; OSA axes: x to the examiner's right, y up, z into the eye. Domain: |x|, |y| < 7 mm.
//
// Made for this project. The sizes are those of measured eyes: T. O. Salmon and C. van de Pol, J. Cataract Refract. Surg. 32,
// 2064 (2006), whole-eye wavefronts, divided by n - 1 = 0.376.
#pragma once

#include <array>
#include <cmath>

#include "lib/numerics/zernike_basis.h"

namespace sagitta::tools {

inline double normal_cornea(double x, double y) {
  constexpr double rx = 7.83, ry = 7.70, k = -0.18, radius = 3;
  struct Term {
    int n, m;
    double um;
  };
  constexpr std::array terms{Term{3, -3, -0.10}, Term{3, -1, -0.35}, Term{3, 1, 0.12}, Term{3, 3, 0.05},
                             Term{4, -4, 0.03},  Term{4, -2, -0.02}, Term{4, 2, -0.04}, Term{4, 4, 0.04},
                             Term{5, -1, 0.02},  Term{5, 1, -0.01},  Term{6, 0, 0.01}};
  const double q = x * x / rx + y * y / ry;
  double z = q / (1 + std::sqrt(1 - (1 + k) * (x * x / (rx * rx) + y * y / (ry * ry))));
  for (const Term& term : terms)
    z += 1e-3 * term.um * numerics::zernike_value(numerics::ZernikeIndexing::osa, {term.n, term.m}, x / radius, y / radius);
  return z;
}

inline double keratoconic_cornea(double x, double y) {
  constexpr double height = 0.025, width = 1, x0 = -0.6, y0 = -1.1;
  const double dx = x - x0, dy = y - y0;
  return normal_cornea(x, y) - height * std::exp(-(dx * dx + dy * dy) / (2 * width * width));
}

}  // namespace sagitta::tools
