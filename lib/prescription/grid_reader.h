// SPDX-License-Identifier: Apache-2.0
// Reads heights on a regular grid. One function a format; the closed list of formats is in grid_reader.cc.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "lib/prescription/diagnostics.h"
#include "lib/prescription/sag_grid.h"

namespace sagitta::prescription {

struct GridRequest {
  std::string file;    // found already
  std::string format;  // one of grid_formats()
};

// "zemax|xyz": the choices of the key `format`.
std::string_view grid_formats();

// Null, and errors at places in the grid's file, where it cannot be read, or where no cell has data at all its corners. Notes tell of nodes without data.
std::shared_ptr<const SagGrid> read_grid(const GridRequest& request, Findings& findings);

}  // namespace sagitta::prescription
