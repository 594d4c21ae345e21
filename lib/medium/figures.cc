// SPDX-License-Identifier: Apache-2.0
#include "lib/medium/figures.h"

#include <cmath>
#include <limits>

#include "lib/medium/spectral_lines.h"

namespace sagitta::medium {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

double abbe_number(const Medium& medium, double middle_um, double short_um, double long_um) {
  const double dispersion = medium.index(short_um) - medium.index(long_um);
  return dispersion != 0 ? (medium.index(middle_um) - 1) / dispersion : nan;
}

}  // namespace

double abbe_number_d(const Medium& medium) { return abbe_number(medium, lines::d_um, lines::F_um, lines::C_um); }

double abbe_number_e(const Medium& medium) { return abbe_number(medium, lines::e_um, lines::F_prime_um, lines::C_prime_um); }

double slope_per_um(const Medium& medium, double wavelength_um) {
  if (!medium.dispersion->is_smooth()) return nan;
  const auto index = [&](double steps, double h) { return medium.index(wavelength_um + steps * h); };
  const double h = wavelength_um / 2000;
  // Central differences; where a neighbour has no index, those of the one side, then of the other.
  const double central = (8 * (index(1, h) - index(-1, h)) - (index(2, h) - index(-2, h))) / (12 * h);
  if (!std::isnan(central)) return central;
  for (const double side : {h, -h}) {
    const double one_sided =
        (-25 * index(0, side) + 48 * index(1, side) - 36 * index(2, side) + 16 * index(3, side) - 3 * index(4, side)) / (12 * side);
    if (!std::isnan(one_sided)) return one_sided;
  }
  return nan;
}

double group_index(const Medium& medium, double wavelength_um) { return medium.index(wavelength_um) - wavelength_um * slope_per_um(medium, wavelength_um); }

}  // namespace sagitta::medium
