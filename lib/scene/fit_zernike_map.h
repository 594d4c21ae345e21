// SPDX-License-Identifier: Apache-2.0
// What a fitted surface leaves of the measured points, as a map over its circle.
//
// Scattered points become a map by their Delaunay triangulation, the one that traces them (scene/triangulate.h): inside a
// facet the residual, measured z minus fitted z, is the linear interpolation between its corners. So the map shows every
// residual at its point and nothing that was not measured: NaN outside the points, in holes, and beyond the circle.
#pragma once

#include <optional>
#include <vector>

#include "lib/prescription/diagnostics.h"
#include "lib/scene/fit_zernike.h"

namespace sagitta::scene {

// Samples at ((i - h) pixel_mm, (h - j) pixel_mm), h = (size - 1)/2, of column i and row j: x to the right, y up, the rim
// of the circle on the outermost samples.
struct ResidualMap {
  int size = 257;
  double pixel_mm = 0;
  std::vector<float> residual_um;  // size x size, row by row from the largest y
  double coverage = 0;             // share of the samples in the circle that lie inside the points
};

struct ResidualMapResult {
  std::optional<ResidualMap> map;   // none where there is an error among the findings, or no triangulation in this build
  prescription::Findings findings;  // of the triangulation
};

ResidualMapResult residual_map(const ZernikeSurface& surface);

}  // namespace sagitta::scene
