// SPDX-License-Identifier: Apache-2.0
#include "lib/trace/gradient_step.h"
#include "lib/trace/kernel.h"

namespace sagitta::trace {

void advance_in_gradient(const scene::Surface& surface, int surface_number, const numerics::RigidTransform<double>& local_from_previous,
                         const scene::Wavelength& wavelength, const gradient_index::Tolerance& tolerance, const RayColumns& rays, int ray_count) {
  for (int i = 0; i < ray_count; ++i) {
    if (rays.ended[i] != 0) continue;
    const Ray<double> ray{{rays.x[i], rays.y[i], rays.z[i]}, {rays.l[i], rays.m[i], rays.n[i]}, rays.opl ? rays.opl[i] : 0, 0};
    const Ray<double> behind = step_in_gradient(surface, surface_number, wavelength, tolerance, entered(local_from_previous, ray)).behind;
    rays.x[i] = behind.position.x, rays.y[i] = behind.position.y, rays.z[i] = behind.position.z;
    rays.l[i] = behind.direction.x, rays.m[i] = behind.direction.y, rays.n[i] = behind.direction.z;
    if (rays.opl) rays.opl[i] = behind.opl;
    rays.ended[i] = static_cast<std::int32_t>(behind.ended);
  }
}

}  // namespace sagitta::trace
