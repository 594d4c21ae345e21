// SPDX-License-Identifier: Apache-2.0
// Formula 4, RefractiveIndex.INFO, the general one:
//   n^2 = C1 + C2 L^C3/(L^2 - C4^C5) + C6 L^C7/(L^2 - C8^C9) + C10 L^C11 + C12 L^C13 + ...                    (1)
// L: wavelength in um; C1: no unit; C3, C5, C7, C9, C11, C13, ...: exponents. Poles at L^2 = C4^C5, C8^C9; no value
// where n^2 <= 0. Files fill a fraction they do not need with zeros; 0^0 = 1 would put its pole at L = 1, so a
// fraction with a zero numerator is left out.
#pragma once

#include <cmath>

#include "lib/medium/formula.h"

namespace sagitta::medium {

inline double refractiveindex_info_index(std::span<const double> c, double wavelength_um) {
  const double square = wavelength_um * wavelength_um;
  double index_squared = c[0];
  std::size_t i = 1;
  for (; i < c.size() && i < 9; i += 4) {
    if (c[i] != 0) index_squared += c[i] * std::pow(wavelength_um, c[i + 1]) / (square - std::pow(c[i + 2], c[i + 3]));
  }
  for (; i < c.size(); i += 2) index_squared += c[i] * std::pow(wavelength_um, c[i + 1]);  // both loops: (1)
  return std::sqrt(index_squared);
}

inline constexpr bool constant_fractions_and_pairs(std::size_t coefficient_count) {
  return coefficient_count == 5 || (coefficient_count >= 9 && coefficient_count % 2 == 1);
}

inline constexpr Formula refractiveindex_info{4, "RefractiveIndex.INFO", "5, 9, 11, 13, ...",
                                              constant_fractions_and_pairs, refractiveindex_info_index};

}  // namespace sagitta::medium
