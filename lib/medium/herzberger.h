// SPDX-License-Identifier: Apache-2.0
// Formula 7, Herzberger:
//   n = C1 + C2/(L^2 - 0.028) + C3/(L^2 - 0.028)^2 + C4 L^2 + C5 L^4 + C6 L^6                                 (1)
// L: wavelength in um; C1: no unit; C2: um^2; C3: um^4; C4, C5, C6: um^-2, um^-4, um^-6. Pole at L^2 = 0.028 um^2
// (167.3 nm); no value where n <= 0. M. Herzberger, Opt. Acta 6, 197 (1959).
#pragma once

#include "lib/medium/formula.h"

namespace sagitta::medium {

inline double herzberger_index(std::span<const double> c, double wavelength_um) {
  const double square = wavelength_um * wavelength_um;
  const double fraction = 1 / (square - 0.028);
  double index = c[0] + c[1] * fraction + c[2] * fraction * fraction;
  double power = square;
  for (std::size_t i = 3; i < c.size(); ++i, power *= square) index += c[i] * power;  // (1)
  return index;
}

inline constexpr bool three_to_six(std::size_t coefficient_count) {
  return coefficient_count >= 3 && coefficient_count <= 6;
}

inline constexpr Formula herzberger{7, "Herzberger", "3 to 6", three_to_six, herzberger_index};

}  // namespace sagitta::medium
