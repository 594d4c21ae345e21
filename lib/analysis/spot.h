// SPDX-License-Identifier: Apache-2.0
// Spot diagram: where the rays of one field and wavelength meet the image surface, in its local x, y (mm).
//
//   centroid = mean (x, y);   rms radius = sqrt(mean |(x, y) - centroid|^2);   geometric radius = max |(x, y) - centroid|
//
// Sums run in the order of the rays with compensation: the same bits for any thread count.
#pragma once

#include <cstdint>
#include <vector>

#include "lib/trace/ray_batch.h"

namespace sagitta::analysis {

struct Spot {
  trace::StatusCounts rays;
  double centroid_x, centroid_y;  // NaN where no ray arrived
  double rms_radius, geometric_radius;
};

Spot spot(const trace::RayBatch& rays);

// Ray counts per pixel of a square image centred on (centre_x, centre_y); row 0 is the top (largest y). Rays beyond its
// edge are counted in `outside`.
struct SpotImage {
  int size = 0;
  double pixel_mm = 0, centre_x = 0, centre_y = 0;
  std::vector<std::uint32_t> counts;  // size x size
  std::int64_t outside = 0;
};

SpotImage spot_image(const trace::RayBatch& rays, int size, double pixel_mm, double centre_x, double centre_y);

}  // namespace sagitta::analysis
