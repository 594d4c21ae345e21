// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "lib/numerics/key.h"
#include "lib/surface/crossing.h"

namespace sagitta::surface {

struct Facets {
  static constexpr std::string_view kind = "delaunay";
  static constexpr std::array keys{
      numerics::Key{"points", numerics::ValueKind::file, "file of the points", true},
      numerics::Key{.name = "format", .kind = numerics::ValueKind::text, .meaning = "format of the file", .choices = "xyz|cso"},
      numerics::Key{.name = "interpolation", .kind = numerics::ValueKind::text, .meaning = "surface between the points", .choices = "linear"},
      numerics::Key{.name = "axes", .kind = numerics::ValueKind::text, .meaning = "frame of xyz points: the surface's own, or OSA's (x to the examiner's right)", .choices = "local|osa"},
      numerics::Key{.name = "max_edge_mm", .kind = numerics::ValueKind::number, .meaning = "facets with a longer edge are holes",
                    .range = {0, std::numeric_limits<double>::infinity(), true, true, true}, .fallback = std::numeric_limits<double>::infinity()}};
};

}  // namespace sagitta::surface
