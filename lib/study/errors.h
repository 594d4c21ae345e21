// SPDX-License-Identifier: Apache-2.0
// How far the rays of a variant are off the true ones, ray by ray.
//
//   distance = |p - p0|, um              p, p0   where the ray meets the surface
//   angle = atan2(|d x d0|, d.d0), arcmin   d, d0   its direction behind the surface                                 (1)
//
// in long double, over the rays that both find. The difference of the rms radii of the spots at the image is over the rays that arrive in
// both, each about its own centroid; in percent of the true one.
//
// Source: (1) is the measure of the founding paper's section 3 (Appl. Opt., 2009), without the floor of an arc cosine.
#pragma once

#include <cstdint>
#include <limits>

#include "lib/study/truth.h"
#include "lib/trace/ray_batch.h"

namespace sagitta::study {

// NaN of no ray.
struct Statistics {
  double mean = std::numeric_limits<double>::quiet_NaN();
  double rms = std::numeric_limits<double>::quiet_NaN();
  double max = std::numeric_limits<double>::quiet_NaN();
};

// Rays by who finds them.
struct Found {
  std::int64_t by_both = 0, by_truth_only = 0, by_variant_only = 0, by_neither = 0;
  std::int64_t by_one_only() const { return by_truth_only + by_variant_only; }
};

struct SurfaceErrors {
  Statistics distance_um, angle_arcmin;
  Found found;
};
// The rays of the variant are in the frame of the surface, behind it; `variant` holds the first of the true rays, or all.
SurfaceErrors surface_errors(const trace::RayBatch& variant, const std::vector<TrueRay>& truth);

struct SpotErrors {
  double rms_radius_um = std::numeric_limits<double>::quiet_NaN();       // the variant's
  double true_rms_radius_um = std::numeric_limits<double>::quiet_NaN();
  double rms_radius_percent = std::numeric_limits<double>::quiet_NaN();  // the variant's less the true one, of the true one
  Found found;
};
// Likewise, of rays in the frame of the image surface.
SpotErrors spot_errors(const trace::RayBatch& variant, const std::vector<TrueRay>& truth);

}  // namespace sagitta::study
