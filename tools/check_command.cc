// SPDX-License-Identifier: Apache-2.0
// sagitta check SYSTEM.yaml: reads and compiles, and says what it is.
#include <fmt/core.h>

#include "tools/commands.h"
#include "tools/load.h"

namespace sagitta::tools {

int check_command(const CheckOptions& options) {
  const auto model = load_model(options.system);
  if (!model) return 1;
  const auto compiled = load_scene(*model);
  if (!compiled) return 1;
  const scene::FirstOrder& paraxial = compiled->first_order;
  fmt::print("{}: no error\n{}: {} surfaces, {} fields, {} wavelengths, effective focal length {:.6g} mm at {:g} nm\n",
             options.system, model->name.empty() ? "unnamed system" : model->name, model->surfaces.size(),
             model->fields.points.size(), model->wavelengths_nm.size(), paraxial.effective_focal_length,
             model->primary_wavelength_nm());
  return 0;
}

}  // namespace sagitta::tools
