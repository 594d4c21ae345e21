// SPDX-License-Identifier: Apache-2.0
// Formula 1, Sellmeier, resonance wavelengths as they are:
//   n^2 = 1 + C1 + C2 L^2/(L^2 - C3^2) + C4 L^2/(L^2 - C5^2) + ...                                            (1)
// L: wavelength in um; C1, C2, C4, ...: no unit; C3, C5, ...: um. Poles at L = C3, C5, ...; no value where n^2 <= 0.
#pragma once

#include <cmath>

#include "lib/medium/formula.h"

namespace sagitta::medium {

inline double sellmeier_index(std::span<const double> c, double wavelength_um) {
  const double square = wavelength_um * wavelength_um;
  double index_squared = 1 + c[0];
  for (std::size_t i = 1; i < c.size(); i += 2) index_squared += c[i] * square / (square - c[i + 1] * c[i + 1]);  // (1)
  return std::sqrt(index_squared);
}

inline constexpr Formula sellmeier{1, "Sellmeier", constant_and_pairs_text, constant_and_pairs, sellmeier_index};

}  // namespace sagitta::medium
