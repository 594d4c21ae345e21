// SPDX-License-Identifier: Apache-2.0
// What catalogues say of a medium besides its index. All are NaN where the medium has no index at a wavelength they need.
//   Vd = (nd - 1)/(nF - nC)                                                                                   (1)
//   Ve = (ne - 1)/(nF' - nC')                                                                                 (2)
//   N  = n - L dn/dL                                                                                          (3)
// L: wavelength; Vd, Ve: Abbe numbers; N: group index. A constant index has no Abbe number.
#pragma once

#include "lib/medium/medium.h"

namespace sagitta::medium {

double abbe_number_d(const Medium& medium);  // (1)
double abbe_number_e(const Medium& medium);  // (2)

// dn/dL in 1/um, by differences over five wavelengths within 0.2 % of L, all on one side where the range ends. NaN for tables,
// whose slope jumps. The error of the formula, h^4 |d^5 n/dL^5|/5 with h = L/2000, is below 1e-9 of n/L except near a pole.
double slope_per_um(const Medium& medium, double wavelength_um);
double group_index(const Medium& medium, double wavelength_um);  // (3)

}  // namespace sagitta::medium
