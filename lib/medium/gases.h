// SPDX-License-Identifier: Apache-2.0
// Formula 6, gases:
//   n - 1 = C1 + C2/(C3 - L^-2) + C4/(C5 - L^-2) + ...                                                        (1)
// L: wavelength in um; C1: no unit; C2, C3, C4, ...: um^-2. Poles at L^-2 = C3, C5, ...; no value where n <= 0.
// The 1 is added last: n - 1 of a gas is about 3e-4 and keeps its digits up to there.
#pragma once

#include "lib/medium/formula.h"

namespace sagitta::medium {

inline double gases_index(std::span<const double> c, double wavelength_um) {
  const double wavenumber_squared = 1 / (wavelength_um * wavelength_um);
  double excess = c[0];
  for (std::size_t i = 1; i < c.size(); i += 2) excess += c[i] / (c[i + 1] - wavenumber_squared);  // (1)
  return 1 + excess;
}

inline constexpr Formula gases{6, "gases", constant_and_pairs_text, constant_and_pairs, gases_index};

}  // namespace sagitta::medium
