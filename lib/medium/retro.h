// SPDX-License-Identifier: Apache-2.0
// Formula 8, retro: the Lorentz-Lorenz refractivity
//   (n^2 - 1)/(n^2 + 2) = C1 + C2 L^2/(L^2 - C3) + C4 L^2 = b,   so   n^2 = (1 + 2 b)/(1 - b)                 (1)
// L: wavelength in um; C1, C2: no unit; C3: um^2; C4: um^-2. A value where -1/2 < b < 1.
#pragma once

#include <cmath>

#include "lib/medium/formula.h"

namespace sagitta::medium {

inline double retro_index(std::span<const double> c, double wavelength_um) {
  const double square = wavelength_um * wavelength_um;
  const double refractivity = c[0] + c[1] * square / (square - c[2]) + c[3] * square;
  return std::sqrt((1 + 2 * refractivity) / (1 - refractivity));  // (1)
}

inline constexpr Formula retro{8, "retro", "4", [](std::size_t count) { return count == 4; }, retro_index};

}  // namespace sagitta::medium
