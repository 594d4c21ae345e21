// SPDX-License-Identifier: Apache-2.0
// Formula 3, polynomial of the squared index, with exponents from the file:
//   n^2 = C1 + C2 L^C3 + C4 L^C5 + ...                                                                        (1)
// L: wavelength in um; C1: no unit; C2, C4, ...: um^-exponent; C3, C5, ...: exponents. No value where n^2 <= 0.
#pragma once

#include <cmath>

#include "lib/medium/formula.h"

namespace sagitta::medium {

inline double polynomial_index(std::span<const double> c, double wavelength_um) {
  double index_squared = c[0];
  for (std::size_t i = 1; i < c.size(); i += 2) index_squared += c[i] * std::pow(wavelength_um, c[i + 1]);  // (1)
  return std::sqrt(index_squared);
}

inline constexpr Formula polynomial{3, "polynomial", constant_and_pairs_text, constant_and_pairs, polynomial_index};

}  // namespace sagitta::medium
