// SPDX-License-Identifier: Apache-2.0
#include "lib/medium/table.h"

#include <algorithm>
#include <utility>

namespace sagitta::medium {
namespace {

class Table : public Dispersion {
 public:
  explicit Table(std::vector<Sample> samples) : samples_(std::move(samples)) {}

  double index(double wavelength_um) const override {
    const auto after = std::upper_bound(samples_.begin(), samples_.end(), wavelength_um,
                                        [](double wavelength, const Sample& s) { return wavelength < s.wavelength_um; });
    // Within the slack of Medium::covers beyond an end, the end's index holds.
    if (after == samples_.begin()) return samples_.front().index;
    if (after == samples_.end()) return samples_.back().index;
    const Sample& low = *(after - 1);
    const double t = (wavelength_um - low.wavelength_um) / (after->wavelength_um - low.wavelength_um);
    return (1 - t) * low.index + t * after->index;  // (1)
  }
  bool is_smooth() const override { return false; }
  std::vector<double> measured_um() const override {
    std::vector<double> wavelengths;
    for (const Sample& sample : samples_) wavelengths.push_back(sample.wavelength_um);
    return wavelengths;
  }
  std::string kind() const override { return "table of " + std::to_string(samples_.size()); }

 private:
  std::vector<Sample> samples_;
};

}  // namespace

Medium from_table(std::string name, std::vector<Sample> samples) {
  const double shortest_um = samples.front().wavelength_um, longest_um = samples.back().wavelength_um;
  return {std::move(name), std::make_shared<Table>(std::move(samples)), shortest_um, longest_um};
}

}  // namespace sagitta::medium
