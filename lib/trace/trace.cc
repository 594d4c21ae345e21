// SPDX-License-Identifier: Apache-2.0
#include "lib/trace/trace.h"

#include <algorithm>
#include <cmath>
#include <utility>

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

double index_of(const scene::Wavelength& wavelength, int gap) { return wavelength.index[static_cast<std::size_t>(gap)]; }

bool is_dummy(const scene::Scene& scene, const scene::Wavelength& wavelength, int number) {
  return scene.surface(number).does_nothing(index_of(wavelength, number - 1), index_of(wavelength, number));
}

// The rays of a block to surface `number` and through it.
void pass(const scene::Scene& scene, const scene::Wavelength& wavelength, int number, const numerics::RigidTransform<double>& local_from_rays, bool is_shift,
          const RayColumns& rays, int ray_count) {
  const scene::Surface& surface = scene.surface(number);
  if (wavelength.has_gradient_at(number)) advance_in_gradient(surface, number, local_from_rays, wavelength, scene.tolerance, rays, ray_count);
  else advance(surface, number, local_from_rays, is_shift, index_of(wavelength, number - 1), index_of(wavelength, number), rays, ray_count);
}

// Or by it: then the way is longer.
void go_on(const scene::Scene& scene, const scene::Wavelength& wavelength, int number, const RayColumns& rays, int ray_count, Way& way) {
  const scene::Surface& surface = scene.surface(number);
  way.local_from_rays = way.has_passed ? surface.local_from_previous * way.local_from_rays : surface.local_from_previous;
  way.is_shift = surface.centred && (!way.has_passed || way.is_shift);
  way.has_passed = is_dummy(scene, wavelength, number);
  if (way.has_passed) end_parallel_rays(way.local_from_rays, number, rays, ray_count);
  else pass(scene, wavelength, number, way.local_from_rays, way.is_shift, rays, ray_count);
}

int block_at(std::size_t from, const RayBatch& rays) { return static_cast<int>(std::min(block_size, rays.size() - from)); }

void trace_block(const scene::Scene& scene, const scene::Wavelength& wavelength, RayBatch& rays, std::size_t from) {
  ask_for(rays, from + block_size);
  Way way;
  for (int number = 1; number <= scene.surface_count(); ++number) go_on(scene, wavelength, number, rays.columns(from), block_at(from, rays), way);
}

}  // namespace

void trace(const scene::Scene& scene, const scene::Wavelength& wavelength, RayBatch& rays, int thread_count) {
  const std::size_t block_count = (rays.size() + block_size - 1) / block_size;
  numerics::share_blocks(block_count, thread_count,
                         [&] { return [&](std::size_t block) { trace_block(scene, wavelength, rays, block * block_size); }; });
}

SurfaceBySurface::SurfaceBySurface(const scene::Scene& scene, const scene::Wavelength& wavelength, RayBatch rays)
    : scene_(scene), wavelength_(wavelength), rays_(std::move(rays)), ways_((rays_.size() + block_size - 1) / block_size) {}

const RayBatch& SurfaceBySurface::next() {
  ++number_;
  const bool passes_by = is_dummy(scene_, wavelength_, number_);
  if (passes_by) met_ = rays_;
  for (std::size_t block = 0; block < ways_.size(); ++block) {
    const std::size_t from = block * block_size;
    Way& way = ways_[block];
    go_on(scene_, wavelength_, number_, rays_.columns(from), block_at(from, rays_), way);
    if (passes_by) pass(scene_, wavelength_, number_, way.local_from_rays, way.is_shift, met_.columns(from), block_at(from, rays_));
  }
  return passes_by ? met_ : rays_;
}

void trace_surface(const scene::Scene& scene, const scene::Wavelength& wavelength, int surface_number, RayBatch& rays) {
  const scene::Surface& surface = scene.surface(surface_number);
  for (std::size_t from = 0; from < rays.size(); from += block_size)
    pass(scene, wavelength, surface_number, surface.local_from_previous, surface.centred, rays.columns(from), block_at(from, rays));
}

Vec3<double> global_position(const scene::Scene& scene, int surface_number, const RayBatch& rays, std::size_t ray) {
  return scene.surface(surface_number).global_from_local * rays.position(ray);
}
Vec3<double> global_direction(const scene::Scene& scene, int surface_number, const RayBatch& rays, std::size_t ray) {
  return scene.surface(surface_number).global_from_local.rotation * rays.direction(ray);
}

}  // namespace sagitta::trace
