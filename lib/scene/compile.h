// SPDX-License-Identifier: Apache-2.0
// The only bridge from the model (what the user wrote) to the scene (flat numbers).
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "lib/prescription/diagnostics.h"
#include "lib/prescription/model.h"
#include "lib/scene/first_order.h"
#include "lib/scene/footprint.h"
#include "lib/scene/scene.h"
#include "lib/scene/smooth.h"

namespace sagitta::scene {

struct CompileResult {
  std::optional<Scene> scene;     // present exactly when there is no error among the findings
  FirstOrder first_order{};       // at the primary wavelength
  std::optional<FirstOrder> first_order_x;  // the same of the x-z section, where that is another
  std::map<int, Smoothing> smoothing;  // by the number of the surface; of those whose points were smoothed
  std::vector<CloudPart> parts;   // in the order of the surfaces
  std::map<int, surface::Shape> given;  // by the number of the surface: its shape as prescribed, where another one is the same
                                        // surface with fewer operations
  int dispersive_gaps = 0;        // whose media disperse: the scene knows their indices at its wavelengths alone
  prescription::Findings findings;
};

// Of a surface made of points all are triangulated, or, for a known beam, as many as its footprint needs. A ray gets the
// same bits either way, unless it ends as outside_data on one of `parts`: then that says nothing, and all must be compiled.
// What is wrong with points that are not needed is not found.
CompileResult compile(const prescription::Model& model, const Beam& beam = {});

}  // namespace sagitta::scene
