// SPDX-License-Identifier: Apache-2.0
// A homogeneous medium: its name, its dispersion, and the range of wavelengths in which it may be used.
// Wavelengths are in um; from nm divide by 1000 (not times 1e-3: the quotient is the correctly rounded one).
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace sagitta::medium {

// The refractive index as a function of the wavelength in um. Indices are relative to air, as glass catalogues give them.
// Asked through Medium::index only, which knows the range and takes away what is no index.
class Dispersion {
 public:
  virtual ~Dispersion() = default;
  virtual double index(double wavelength_um) const = 0;
  virtual bool is_constant() const { return false; }
  virtual bool is_smooth() const { return true; }  // false: the slope jumps from one measured wavelength to the next
  virtual std::vector<double> measured_um() const { return {}; }  // the wavelengths of a table
  virtual bool is_meant_for_visible_light() const { return false; }  // and goes on beyond it, by a formula that nothing holds there
  virtual std::string kind() const = 0;            // for people: "formula 2 (Sellmeier-2)", "table of 4"
};

// What may be an index: wider than any medium is, and narrow enough that a direction keeps its digits from one medium to the next.
inline constexpr double least_index = 1e-3, largest_index = 1e3;
// Wavelengths at which a medium without a range of its own may be used: an optical path is a number of them that can be squared.
inline constexpr double least_wavelength_um = 1e-9, largest_wavelength_um = 1e9;

// Visible light, as media of the eye have it that have no range of their own.
inline constexpr double shortest_visible_um = .38, longest_visible_um = .78;

struct Medium {
  std::string name;
  std::shared_ptr<const Dispersion> dispersion;
  double shortest_um = 0;
  double longest_um = 0;

  // The ends belong to the range, with a slack of 1e-12 of the wavelength: 600.1 nm / 1000 is not the double 0.6001.
  bool covers(double wavelength_um) const {
    return wavelength_um >= shortest_um * (1 - 1e-12) && wavelength_um <= longest_um * (1 + 1e-12);
  }

  // Whether the index there is made by a formula for visible light, beyond that.
  bool is_extrapolated(double wavelength_um) const {
    return dispersion->is_meant_for_visible_light() && covers(wavelength_um) && !(wavelength_um >= shortest_visible_um && wavelength_um <= longest_visible_um);
  }

  // NaN outside the range, and where the dispersion gives no index (n^2 <= 0, a pole). A caller that
  // wants to trace must look at it once.
  double index(double wavelength_um) const;
};

// The first wavelength in um, of 1001 that divide the range evenly on a logarithmic scale, at which the medium has no
// index although its range (positive and finite) says so; none where all is well. A pole narrower than that can go
// unseen here, but not in index().
std::optional<double> wavelength_without_index(const Medium& medium);

Medium constant(std::string name, double index);
Medium air();  // index exactly 1 at every wavelength: the reference of catalogue indices

// Two-term Cauchy n = A + B/lambda^2 through nd (587.5618 nm) with nF - nC = (nd - 1)/vd (486.1327 and 656.2725 nm).
// A model that the user asks for, meant for visible light; no range is known for it, so none is enforced, but is_extrapolated tells.
Medium from_nd_vd(double nd, double vd);

}  // namespace sagitta::medium
