// SPDX-License-Identifier: Apache-2.0
// The lines of rays as they come to a surface: what scene/footprint.h asks for.
#pragma once

#include <functional>
#include <vector>

#include "lib/scene/footprint.h"
#include "lib/trace/ray_batch.h"

namespace sagitta::trace {

// Rays as they are launched, in the global frame.
struct LaunchedRays {
  RayBatch rays;
  std::size_t field = 0, wavelength = 0;  // from 0
};
// Calls `take` with all the rays of a job, batch by batch.
using RaySource = std::function<void(const scene::Scene& scene, const std::function<void(const LaunchedRays&)>& take)>;

// The lines of the rays that travel up to the surface, traced through those before it. No aperture stops them: a sample
// that is clipped would say nothing of the rays beside it.
scene::Beam beam_of(RaySource source);

// Whether a ray ended as outside_data on a cloud of which a part was triangulated: then the scene is to be loaded and traced
// again, without a beam.
bool leaves_a_part(const std::vector<scene::CloudPart>& parts, const StatusCounts& rays);

}  // namespace sagitta::trace
