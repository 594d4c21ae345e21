// SPDX-License-Identifier: Apache-2.0
// Formula 9, exotic:
//   n^2 = C1 + C2/(L^2 - C3) + C4 (L - C5)/((L - C5)^2 + C6)                                                  (1)
// L: wavelength in um; C1: no unit; C2, C3, C6: um^2; C4, C5: um. Pole at L^2 = C3; no value where n^2 <= 0.
#pragma once

#include <cmath>

#include "lib/medium/formula.h"

namespace sagitta::medium {

inline double exotic_index(std::span<const double> c, double wavelength_um) {
  const double distance = wavelength_um - c[4];
  return std::sqrt(c[0] + c[1] / (wavelength_um * wavelength_um - c[2]) +
                   c[3] * distance / (distance * distance + c[5]));  // (1)
}

inline constexpr Formula exotic{9, "exotic", "6", [](std::size_t count) { return count == 6; }, exotic_index};

}  // namespace sagitta::medium
