// SPDX-License-Identifier: Apache-2.0
// The triangulation of a cloud whose heights are smoothed first (smooth.h), as far as the user allows. Which facets there
// are does not change: that follows from (x, y), and from the holes.
#pragma once

#include <optional>

#include "lib/scene/smooth.h"
#include "lib/scene/triangulate.h"

namespace sagitta::scene {

struct SmoothedTriangulation {
  Triangulation triangulation;
  std::shared_ptr<const prescription::PointCloud> cloud;  // with the heights that are traced
  std::optional<Smoothing> smoothing;                     // none where none is asked for, or there is an error
};

// rms 0: no smoothing, and the cloud as it is. At most a million points can be smoothed.
SmoothedTriangulation triangulate_smoothed(std::shared_ptr<const prescription::PointCloud> cloud, double max_edge, double rms);

}  // namespace sagitta::scene
