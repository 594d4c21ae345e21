// SPDX-License-Identifier: Apache-2.0
#include "lib/trace/trace.h"

#include <algorithm>
#include <cmath>

#include "lib/numerics/parallel.h"
#include "lib/trace/kernel.h"

namespace sagitta::trace {
namespace {

// Eight columns of 256 rays are 15 KB: they stay in the first-level cache from the first surface to the last.
constexpr std::size_t block_size = surface::block_capacity;

// The processor's own guesses end with each page of memory.
void ask_for(RayBatch& rays, std::size_t from) {
  if (from + block_size > rays.size()) return;
  const RayColumns block = rays.columns(from);
  constexpr std::size_t line = 64;  // bytes
  for (const double* column : {block.x, block.y, block.z, block.l, block.m, block.n, block.opl})
    for (std::size_t i = 0; column && i < block_size; i += line / sizeof *column) __builtin_prefetch(column + i, 1, 2);
  for (std::size_t i = 0; i < block_size; i += line / sizeof *block.ended) __builtin_prefetch(block.ended + i, 1, 2);
}

// The plane that is passed by ends one kind of ray: those parallel to it, or with a path there too long for a number. Each on
// its own, so that the others do not depend on it.
void end_parallel_rays(const numerics::RigidTransform<double>& local_from_rays, int surface_number, const RayColumns& rays, int ray_count) {
  const Vec3<double>& axis = local_from_rays.rotation.row_z;
  const auto is_parallel = [&](int i) {
    return (rays.ended[i] == 0) & (std::abs(axis.x * rays.l[i] + axis.y * rays.m[i] + axis.z * rays.n[i]) < 1e-200);
  };
  int count = 0;
  for (int i = 0; i < ray_count; ++i) count += is_parallel(i);
  for (int i = 0; count > 0 && i < ray_count; ++i) {
    if (!is_parallel(i)) continue;
    const Vec3<double> position = local_from_rays * Vec3<double>{rays.x[i], rays.y[i], rays.z[i]};
    const Vec3<double> direction = local_from_rays.rotation * Vec3<double>{rays.l[i], rays.m[i], rays.n[i]};
    rays.x[i] = position.x, rays.y[i] = position.y, rays.z[i] = position.z;
    rays.l[i] = direction.x, rays.m[i] = direction.y, rays.n[i] = direction.z;
    rays.ended[i] = ending(surface_number, Status::missed);
  }
}

void trace_block(const scene::Scene& scene, const scene::Wavelength& wavelength, RayBatch& batch, std::size_t from) {
  const int ray_count = static_cast<int>(std::min(block_size, batch.size() - from));
  const RayColumns rays = batch.columns(from);
  ask_for(batch, from + block_size);
  bool has_passed = false;  // by the surface before, which does nothing: the rays have not entered its frame, by this transform
  numerics::RigidTransform<double> local_from_rays;
  bool is_shift = true;
  for (int number = 1; number <= scene.surface_count(); ++number) {
    const scene::Surface& surface = scene.surface(number);
    const double index_before = wavelength.index[static_cast<std::size_t>(number - 1)], index_after = wavelength.index[static_cast<std::size_t>(number)];
    local_from_rays = has_passed ? surface.local_from_previous * local_from_rays : surface.local_from_previous;
    is_shift = surface.centred && (!has_passed || is_shift);
    has_passed = surface.does_nothing(index_before, index_after);
    if (has_passed) end_parallel_rays(local_from_rays, number, rays, ray_count);
    else advance(surface, number, local_from_rays, is_shift, index_before, index_after, rays, ray_count);
  }
}

}  // namespace

void trace(const scene::Scene& scene, const scene::Wavelength& wavelength, RayBatch& rays, int thread_count) {
  const std::size_t block_count = (rays.size() + block_size - 1) / block_size;
  numerics::share_blocks(block_count, thread_count,
                         [&] { return [&](std::size_t block) { trace_block(scene, wavelength, rays, block * block_size); }; });
}

void trace_surface(const scene::Scene& scene, const scene::Wavelength& wavelength, int surface_number, RayBatch& rays) {
  const auto gap = static_cast<std::size_t>(surface_number);
  const scene::Surface& surface = scene.surface(surface_number);
  for (std::size_t from = 0; from < rays.size(); from += block_size)
    advance(surface, surface_number, surface.local_from_previous, surface.centred, wavelength.index[gap - 1], wavelength.index[gap],
            rays.columns(from), static_cast<int>(std::min(block_size, rays.size() - from)));
}

Vec3<double> global_position(const scene::Scene& scene, int surface_number, const RayBatch& rays, std::size_t ray) {
  return scene.surface(surface_number).global_from_local * rays.position(ray);
}
Vec3<double> global_direction(const scene::Scene& scene, int surface_number, const RayBatch& rays, std::size_t ray) {
  return scene.surface(surface_number).global_from_local.rotation * rays.direction(ray);
}

}  // namespace sagitta::trace
