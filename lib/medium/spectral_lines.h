// SPDX-License-Identifier: Apache-2.0
// The lines at which indices of glasses are given, wavelengths in um in standard air. Source: Schott AG, Technical
// Information TIE-29, "Refractive index and dispersion" (2016), table 1-1; ISO 7944.
#pragma once

#include <array>
#include <string_view>

namespace sagitta::medium {

namespace lines {
inline constexpr double F_prime_um = 0.4799914, F_um = 0.4861327, e_um = 0.546074, d_um = 0.5875618, C_prime_um = 0.6438469, C_um = 0.6562725;
}

struct SpectralLine {
  std::string_view name;
  double wavelength_um;
};

// Ascending.
inline constexpr std::array spectral_lines{
    SpectralLine{"i", 0.3650146}, SpectralLine{"h", 0.4046561},        SpectralLine{"g", 0.4358343}, SpectralLine{"F'", lines::F_prime_um}, SpectralLine{"F", lines::F_um},
    SpectralLine{"e", lines::e_um}, SpectralLine{"d", lines::d_um},    SpectralLine{"D", 0.5892938}, SpectralLine{"C'", lines::C_prime_um}, SpectralLine{"C", lines::C_um},
    SpectralLine{"r", 0.7065188}, SpectralLine{"s", 0.85211},          SpectralLine{"t", 1.01398}};

}  // namespace sagitta::medium
