// SPDX-License-Identifier: Apache-2.0
// A homogeneous medium: its name, its dispersion, and the range of wavelengths in which it may be used.
#pragma once

#include <functional>
#include <memory>
#include <string>

namespace sagitta::medium {

// The refractive index as a function of the wavelength in um, valid in [shortest_um, longest_um]. Indices are relative
// to air, as glass catalogues give them.
class Dispersion {
 public:
  virtual ~Dispersion() = default;
  virtual double index(double wavelength_um) const = 0;
};

struct Medium {
  std::string name;
  std::shared_ptr<const Dispersion> dispersion;
  double shortest_um = 0;
  double longest_um = 0;

  bool covers(double wavelength_um) const { return wavelength_um >= shortest_um && wavelength_um <= longest_um; }
  double index(double wavelength_um) const { return dispersion->index(wavelength_um); }
};

Medium constant(std::string name, double index);
Medium air();  // index exactly 1 at every wavelength: the reference of catalogue indices

// Two-term Cauchy n = A + B/lambda^2 through nd (587.5618 nm) with nF - nC = (nd - 1)/vd (486.1327 and 656.2725 nm).
Medium from_nd_vd(double nd, double vd);

}  // namespace sagitta::medium
