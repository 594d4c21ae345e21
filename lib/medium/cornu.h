// SPDX-License-Identifier: Apache-2.0
// Formula "Cornu":
//   n = C1 + C2/(L - C3)                                                                                      (1)
// L: wavelength in um; C1: no unit; C2, C3: um. Pole at L = C3; no value where n <= 0. Le Grand's form for ocular media, with
// C3 = 0.130 um. No formula of refractiveindex.info's, so it has no number.
#pragma once

#include "lib/medium/formula.h"

namespace sagitta::medium {

inline double cornu_index(std::span<const double> c, double wavelength_um) {
  return c[0] + c[1] / (wavelength_um - c[2]);  // (1)
}

inline constexpr Formula cornu{0, "Cornu", "3", [](std::size_t count) { return count == 3; }, cornu_index};

}  // namespace sagitta::medium
