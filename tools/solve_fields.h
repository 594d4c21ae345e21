// SPDX-License-Identifier: Apache-2.0
// Fields given by visual angles or by heights of images become what compile() takes: angles, or object heights.
#pragma once

#include "lib/prescription/diagnostics.h"
#include "lib/prescription/model.h"

namespace sagitta::tools {

// Where there is an error among the findings, the model is as it was.
prescription::Findings solve_fields(prescription::Model& model);

}  // namespace sagitta::tools
