// SPDX-License-Identifier: Apache-2.0
// The readers of grids, one a format, listed in grid_reader.cc. What they give counts only where no error is told.
#pragma once

#include "lib/prescription/cloud_formats_internal.h"
#include "lib/prescription/grid_reader.h"

namespace sagitta::prescription {

// Of spacings and places, in mm, and of heights and slopes: squares of what is made of them are numbers.
inline constexpr double smallest_grid_length = 1e-15, largest_grid_length = 1e15, largest_grid_value = 1e100;

std::shared_ptr<SagGrid> read_zemax_grid(const GridRequest& request, CloudErrors& errors, Findings& findings);
std::shared_ptr<SagGrid> read_xyz_grid(const GridRequest& request, CloudErrors& errors, Findings& findings);

}  // namespace sagitta::prescription
