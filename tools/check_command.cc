// SPDX-License-Identifier: Apache-2.0
// sagitta check SYSTEM.yaml: reads and compiles, and says what it is.
#include <fmt/core.h>

#include <cmath>

#include "tools/commands.h"
#include "tools/load.h"

namespace sagitta::tools {

int check_command(const CheckOptions& options) {
  const auto model = load_model(options.system, options.settings);
  if (!model) return model.status;
  const auto compiled = load_scene(*model);
  if (!compiled) return 1;
  const scene::FirstOrder& paraxial = compiled->first_order;
  const auto count = [](std::size_t number, const char* what) { return fmt::format("{} {}{}", number, what, number == 1 ? "" : "s"); };
  fmt::print("{}: no error\n{}: {}, {}, {}, {} at {:g} nm\n",
             options.system, model->name.empty() ? "unnamed system" : model->name, count(model->surfaces.size(), "surface"),
             count(model->fields.points.size(), "field"), count(model->wavelengths_nm.size(), "wavelength"),
             std::isfinite(paraxial.effective_focal_length) ? fmt::format("effective focal length {:.6g} mm", paraxial.effective_focal_length) : "afocal",
             model->primary_wavelength_nm());
  return 0;
}

}  // namespace sagitta::tools
