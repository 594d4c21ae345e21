// SPDX-License-Identifier: Apache-2.0
// How a ray ends. A lost ray is data: it keeps its status and the number of the surface that ended it.
#pragma once

#include <array>
#include <string_view>

namespace sagitta::surface {

enum class Status : int {
  ok = 0,
  missed = 1,            // no hit on the sheet of the surface that holds its vertex
  clipped = 2,           // beyond semi_diameter, or inside inner_semi_diameter
  total_reflection = 3,  // no refracted direction
  outside_data = 4,      // beyond the points of a measured surface, or in a hole of it
  not_converged = 5      // the iteration found no point it could vouch for
};

inline constexpr int status_count = 6;
inline constexpr std::array<std::string_view, status_count> status_names{
    "ok", "missed", "clipped", "total_reflection", "outside_data", "not_converged"};

}  // namespace sagitta::surface
