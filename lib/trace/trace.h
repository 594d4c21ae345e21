// SPDX-License-Identifier: Apache-2.0
// Sends a batch of rays through the surfaces of a scene.
#pragma once

#include <vector>

#include "lib/scene/scene.h"
#include "lib/trace/ray_batch.h"

namespace sagitta::trace {

// How the rays of a block come to the next surface: from their own frame, by those that were passed by on the way.
struct Way {
  bool has_passed = false;
  numerics::RigidTransform<double> local_from_rays{};  // if so: to the frame of the last one passed by
  bool is_shift = true;                                // along z only
};

// Rays in the global frame -> rays in the frame of the image surface (or of the surface that ended them). Each block of
// rays passes all surfaces while it stays in the processor's cache; blocks are shared among `thread_count` threads
// (0: as many as the machine runs). A ray's result depends on nothing but the ray: the same bits for any thread count.
void trace(const scene::Scene& scene, const scene::Wavelength& wavelength, RayBatch& rays, int thread_count = 1);

// The same for listings, surface by surface, with the same bits at every surface that trace() does not pass by. A dummy is met
// too, by rays that then go on from the surface before it, as there.
class SurfaceBySurface {
 public:
  SurfaceBySurface(const scene::Scene& scene, const scene::Wavelength& wavelength, RayBatch rays);
  // The rays at the next surface, from number 1 on, in its frame. Valid until the next call.
  const RayBatch& next();

 private:
  const scene::Scene& scene_;
  const scene::Wavelength& wavelength_;
  RayBatch rays_, met_;  // where they are; at a dummy
  std::vector<Way> ways_;  // of each block
  int number_ = 0;
};

// Through one surface only, on one thread, a dummy too.
void trace_surface(const scene::Scene& scene, const scene::Wavelength& wavelength, int surface_number, RayBatch& rays);

// The position or direction of a ray in the global frame; `surface_number` is the surface whose frame it is in.
Vec3<double> global_position(const scene::Scene& scene, int surface_number, const RayBatch& rays, std::size_t ray);
Vec3<double> global_direction(const scene::Scene& scene, int surface_number, const RayBatch& rays, std::size_t ray);

}  // namespace sagitta::trace
