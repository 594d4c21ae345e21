// SPDX-License-Identifier: Apache-2.0
// The only bridge from the model (what the user wrote) to the scene (flat numbers).
#pragma once

#include <map>
#include <optional>

#include "lib/prescription/diagnostics.h"
#include "lib/prescription/model.h"
#include "lib/scene/first_order.h"
#include "lib/scene/scene.h"
#include "lib/scene/smooth.h"

namespace sagitta::scene {

struct CompileResult {
  std::optional<Scene> scene;     // present exactly when there is no error among the findings
  FirstOrder first_order{};       // at the primary wavelength
  std::map<int, Smoothing> smoothing;  // by the number of the surface; of those whose points were smoothed
  prescription::Findings findings;
};

CompileResult compile(const prescription::Model& model);

}  // namespace sagitta::scene
