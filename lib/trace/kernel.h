// SPDX-License-Identifier: Apache-2.0
// One block of rays through one surface: into its frame, to the hit, past its apertures, and on in the new direction.
// Plain loops over columns in select form, one instance per shape, so that the compiler makes vectors of them; rays that
// have ended keep their columns.
#pragma once

#include "lib/scene/scene.h"
#include "lib/trace/ray_batch.h"

namespace sagitta::trace {

// Indices are positive; equal ones leave the direction as it is.
void advance(const scene::Surface& surface, int surface_number, double index_before, double index_after,
             const RayColumns& rays, int ray_count);

}  // namespace sagitta::trace
