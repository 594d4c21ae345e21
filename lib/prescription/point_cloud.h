// SPDX-License-Identifier: Apache-2.0
// A measured surface as points (x, y, z) in mm, in the surface's local frame (z into the eye, x to the examiner's left:
// the readers convert), in the order of the file.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lib/numerics/vec3.h"
#include "lib/prescription/diagnostics.h"

namespace sagitta::prescription {

struct PointCloud {
  std::string file;
  std::vector<numerics::Vec3<double>> points;  // z NaN: an explicit hole at (x, y)
  std::vector<std::uint32_t> lines;            // the line of each point in the file (of its z for cso); empty: 1, 2, 3, ...
  bool has_lines = true;                       // false: the file is no text, and `lines` counts its points
};

}  // namespace sagitta::prescription
