// SPDX-License-Identifier: Apache-2.0
// sagitta check SYSTEM.yaml: reads and compiles, and says what it is.
#include <fmt/core.h>

#include <cmath>

#include "tools/commands.h"
#include "tools/load.h"

namespace sagitta::tools {

int check_command(const CheckOptions& options) {
  const auto model = load_model(options.system);
  if (!model) return 1;
  const auto compiled = load_scene(*model);
  if (!compiled) return 1;
  const scene::FirstOrder& paraxial = compiled->first_order;
  fmt::print("{}: no error\n{}: {} surfaces, {} fields, {} wavelengths, {} at {:g} nm\n",
             options.system, model->name.empty() ? "unnamed system" : model->name, model->surfaces.size(),
             model->fields.points.size(), model->wavelengths_nm.size(),
             std::isfinite(paraxial.effective_focal_length) ? fmt::format("effective focal length {:.6g} mm", paraxial.effective_focal_length) : "afocal",
             model->primary_wavelength_nm());
  return 0;
}

}  // namespace sagitta::tools
