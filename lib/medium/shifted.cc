// SPDX-License-Identifier: Apache-2.0
#include "lib/medium/shifted.h"

#include <fmt/format.h>

#include <utility>

namespace sagitta::medium {
namespace {

class Shifted : public Dispersion {
 public:
  Shifted(Medium other, double index, double reference_um) : other_(std::move(other)), index_(index), at_reference_(other_.index(reference_um)) {}

  double index(double wavelength_um) const override { return index_ + (other_.index(wavelength_um) - at_reference_); }
  bool is_constant() const override { return other_.dispersion->is_constant(); }
  bool is_smooth() const override { return other_.dispersion->is_smooth(); }
  bool is_meant_for_visible_light() const override { return other_.dispersion->is_meant_for_visible_light(); }
  std::string kind() const override { return other_.dispersion->kind() + ", shifted"; }

 private:
  Medium other_;
  double index_, at_reference_;
};

}  // namespace

Medium shifted(const Medium& other, double index, double reference_um) {
  return {fmt::format("index {} dispersing as {}", index, other.name), std::make_shared<Shifted>(other, index, reference_um), other.shortest_um, other.longest_um};
}

}  // namespace sagitta::medium
