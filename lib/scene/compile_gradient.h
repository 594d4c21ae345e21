// SPDX-License-Identifier: Apache-2.0
// The gradient-index media of a model, at every wavelength of its scene.
#pragma once

#include "lib/prescription/diagnostics.h"
#include "lib/prescription/model.h"
#include "lib/scene/scene.h"

namespace sagitta::scene {

// Surfaces have their frames, wavelengths their indices. An error where there is no index along the axis.
void compile_gradients(const prescription::Model& model, Scene& scene, prescription::Findings& findings);

}  // namespace sagitta::scene
