// SPDX-License-Identifier: Apache-2.0
#include "lib/medium/medium.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <utility>

#include "lib/medium/spectral_lines.h"

namespace sagitta::medium {
namespace {

// n = nd + B (1/L^2 - 1/Ld^2): the constant at the d line is the index itself, so nd comes back to the last bit.
class TwoTermCauchy : public Dispersion {
 public:
  TwoTermCauchy(double index_d, double slope_um2) : index_d_(index_d), slope_um2_(slope_um2) {}

  double index(double wavelength_um) const override {
    return index_d_ + slope_um2_ * (1 / (wavelength_um * wavelength_um) - 1 / (lines::d_um * lines::d_um));
  }
  bool is_meant_for_visible_light() const override { return true; }
  std::string kind() const override { return "from nd and Vd"; }

 private:
  double index_d_, slope_um2_;
};

class Constant : public Dispersion {
 public:
  explicit Constant(double index) : index_(index) {}
  double index(double) const override { return index_; }
  bool is_constant() const override { return true; }
  std::string kind() const override { return "constant"; }

 private:
  double index_;
};

}  // namespace

double Medium::index(double wavelength_um) const {
  if (!covers(wavelength_um)) return std::numeric_limits<double>::quiet_NaN();
  const double index = dispersion->index(wavelength_um);
  return index >= least_index && index <= largest_index ? index : std::numeric_limits<double>::quiet_NaN();
}

std::optional<double> wavelength_without_index(const Medium& medium) {
  constexpr int steps = 1000;
  const double ratio = medium.longest_um / medium.shortest_um;
  for (int i = 0; i <= steps; ++i) {
    const double wavelength_um = medium.shortest_um * std::pow(ratio, double(i) / steps);
    if (!(medium.index(wavelength_um) > 0)) return wavelength_um;
  }
  return std::nullopt;
}

Medium constant(std::string name, double index) {
  return {std::move(name), std::make_shared<Constant>(index), least_wavelength_um, largest_wavelength_um};
}

Medium air() { return constant("air", 1); }

Medium from_nd_vd(double nd, double vd) {
  const double slope_um2 = (nd - 1) / vd / (1 / (lines::F_um * lines::F_um) - 1 / (lines::C_um * lines::C_um));
  return {fmt::format("nd {} vd {}", nd, vd), std::make_shared<TwoTermCauchy>(nd, slope_um2), least_wavelength_um, largest_wavelength_um};
}

}  // namespace sagitta::medium
