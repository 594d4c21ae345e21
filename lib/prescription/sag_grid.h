// SPDX-License-Identifier: Apache-2.0
// Heights on a regular grid, in mm, in the surface's local frame.
#pragma once

#include <string>
#include <vector>

namespace sagitta::prescription {

struct SagGrid {
  struct Node {
    double z, dz_dx, dz_dy, d2z_dxdy;  // mm, 1, 1, 1/mm; z NaN: no data
  };

  std::string file;
  int count_x = 0, count_y = 0;
  double first_x = 0, first_y = 0;  // the least x and y of nodes
  double spacing_x = 0, spacing_y = 0;
  std::vector<Node> nodes;       // in rows of rising y, each of rising x
  bool has_given_slopes = true;  // else slopes and twists are not in the file, and 0 here
};

}  // namespace sagitta::prescription
