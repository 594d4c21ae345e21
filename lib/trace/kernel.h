// SPDX-License-Identifier: Apache-2.0
// One block of rays through one surface: into its frame, and a step (step.h) for as many rays at a time as the processor's
// vectors hold. Rays that have ended keep their columns.
#pragma once

#include "lib/scene/scene.h"
#include "lib/trace/ray_batch.h"

namespace sagitta::trace {

// `local_from_previous` takes the rays from the frame in which they are, `is_shift` along z only. Indices are positive, equal
// ones leave the direction as it is. OPL is left out where it has no column.
void advance(const scene::Surface& surface, int surface_number, const numerics::RigidTransform<double>& local_from_previous, bool is_shift,
             double index_before, double index_after, const RayColumns& rays, int ray_count);

// The same with a gradient-index medium before or behind the surface: ray by ray.
void advance_in_gradient(const scene::Surface& surface, int surface_number, const numerics::RigidTransform<double>& local_from_previous,
                         const scene::Wavelength& wavelength, const gradient_index::Tolerance& tolerance, const RayColumns& rays, int ray_count);

}  // namespace sagitta::trace
