// SPDX-License-Identifier: Apache-2.0
// Formula 5, Cauchy, with exponents from the file:
//   n = C1 + C2 L^C3 + C4 L^C5 + ...                                                                          (1)
// L: wavelength in um; C1: no unit; C2, C4, ...: um^-exponent; C3, C5, ...: exponents. No value where n <= 0.
#pragma once

#include <cmath>

#include "lib/medium/formula.h"

namespace sagitta::medium {

inline double cauchy_index(std::span<const double> c, double wavelength_um) {
  double index = c[0];
  for (std::size_t i = 1; i < c.size(); i += 2) index += c[i] * std::pow(wavelength_um, c[i + 1]);  // (1)
  return index;
}

inline constexpr Formula cauchy{5, "Cauchy", constant_and_pairs_text, constant_and_pairs, cauchy_index};

}  // namespace sagitta::medium
