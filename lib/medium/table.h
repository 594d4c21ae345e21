// SPDX-License-Identifier: Apache-2.0
// A medium measured at some wavelengths. Between two of them the index is interpolated linearly in the wavelength, at
// them it is exactly the measured one, and outside the first and the last there is none.
//   n = (1 - t) n_i + t n_{i+1},   t = (L - L_i)/(L_{i+1} - L_i)                                               (1)
// Why linear: it is what refractiveindex.info itself and the programs that read its tables do, so numbers can be
// compared; it never leaves the interval of its two neighbours, whatever the noise or the rounding of the table
// (water by Hale and Querry is printed to 3 decimals, in steps). The price is an index too high by up to h^2 n''/8, h the
// distance of two neighbours; with n'' about 6 B/L^4 and B = 0.0037 um^2, ocular media: 4e-6 for a table every 10 nm,
// 7e-5 every 46 nm, 5e-4 every 85 nm. For such coarse tables a formula fitted to them is better where it exists.
#pragma once

#include <string>
#include <vector>

#include "lib/medium/medium.h"

namespace sagitta::medium {

struct Sample {
  double wavelength_um = 0;
  double index = 0;
};

// `samples`: one or more, by strictly rising wavelength, indices positive and finite. A single sample is a medium for
// that wavelength only.
Medium from_table(std::string name, std::vector<Sample> samples);

}  // namespace sagitta::medium
