// SPDX-License-Identifier: Apache-2.0
// Sends a batch of rays through the surfaces of a scene.
#pragma once

#include "lib/scene/scene.h"
#include "lib/trace/ray_batch.h"

namespace sagitta::trace {

// Rays in the global frame -> rays in the frame of the image surface (or of the surface that ended them). Each block of
// rays passes all surfaces while it stays in the processor's cache; blocks are shared among `thread_count` threads
// (0: as many as the machine runs). A ray's result depends on nothing but the ray: the same bits for any thread count.
void trace(const scene::Scene& scene, const scene::Wavelength& wavelength, RayBatch& rays, int thread_count = 1);

// Through one surface only, on one thread: for listings, surface by surface from number 1 on.
void trace_surface(const scene::Scene& scene, const scene::Wavelength& wavelength, int surface_number, RayBatch& rays);

// The position or direction of a ray in the global frame; `surface_number` is the surface whose frame it is in.
Vec3<double> global_position(const scene::Scene& scene, int surface_number, const RayBatch& rays, std::size_t ray);
Vec3<double> global_direction(const scene::Scene& scene, int surface_number, const RayBatch& rays, std::size_t ray);

}  // namespace sagitta::trace
