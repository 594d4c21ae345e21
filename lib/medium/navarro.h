// SPDX-License-Identifier: Apache-2.0
// Formula "Navarro", for ocular media: an index from those at four wavelengths, by Herzberger's interpolation.
//   n = a1 C1 + a2 C2 + a3 C3 + a4 C4                                                                         (1)
//   a_i = A_i + B_i L^2 + P_i/(L^2 - L0^2) + R_i/(L^2 - L0^2)^2,   L0 = 0.1673 um                             (2)
// L: wavelength in um; C1 to C4: the indices at 365.0, 486.1, 656.3 and 1014.0 nm, no unit. Meant from 0.365 to 1.014 um; pole at
// L = L0. At those wavelengths it gives C1 to C4 to 1e-5, by the 8 printed decimals of the table.
// R. Navarro, J. Santamaria and J. Bescos, J. Opt. Soc. Am. A 2, 1273-1281 (1985), after M. Herzberger, Opt. Acta 6, 197 (1959).
// It is not formula 7, whose pole lies at L^2 = 0.028, not 0.1673^2 = 0.02798929. No formula of refractiveindex.info's, so it has no number.
#pragma once

#include "lib/medium/formula.h"

namespace sagitta::medium {

// A, B, P and R of (2), in 1, um^-2, um^2 and um^4.
inline constexpr double navarro_weights[4][4] = {
    {0.66147196, -0.40352796, -0.28046790, 0.03385979},  // C1, 365.0 nm
    {-4.20146383, 2.73508956, 1.50543784, -0.11593235},  // C2, 486.1 nm
    {6.29834237, -4.69409935, -1.57508650, 0.10293038},  // C3, 656.3 nm
    {-1.75835059, 2.36253794, 0.35011657, -0.02085782},  // C4, 1014.0 nm
};

inline double navarro_index(std::span<const double> c, double wavelength_um) {
  constexpr double pole_um = 0.1673;
  const double square = wavelength_um * wavelength_um;
  const double fraction = 1 / (square - pole_um * pole_um);
  double index = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto& [A, B, P, R] = navarro_weights[i];
    index += (A + B * square + P * fraction + R * fraction * fraction) * c[i];  // (1), (2)
  }
  return index;
}

inline constexpr Formula navarro{0, "Navarro", "4", [](std::size_t count) { return count == 4; }, navarro_index};

}  // namespace sagitta::medium
