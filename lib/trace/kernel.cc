// SPDX-License-Identifier: Apache-2.0
#include "lib/trace/kernel.h"

#include <algorithm>
#include <type_traits>

#include "lib/numerics/instruction_set.h"
#include "lib/numerics/lanes.h"
#include "lib/trace/step.h"

namespace sagitta::trace {
namespace {

using numerics::select;
template <int n>
using Several = numerics::TwiceLanes<n>;
using Transform = numerics::RigidTransform<double>;

// Shapes that meet a block at once, and those that meet ray by ray; the others have a closed form (shapes.h), in lanes.
template <class Shape>
concept MeetsBlocks = requires(const Shape& shape, surface::BlockOfLines& lines, surface::BlockOfCrossings& crossings) {
  shape.meet_block(lines, crossings);
};

// Crossings that are known already.
struct Met {
  const surface::BlockOfCrossings* crossings;

  template <class T>
  surface::Crossing<T> at(int i, const Vec3<T>& d) const {
    const surface::BlockOfCrossings& at = *crossings;
    return crossing_by_slopes<T>(T::load(at.path + i), {T::load(at.x + i), T::load(at.y + i), T::load(at.z + i)}, T::load(at.slope_x + i),
                                 T::load(at.slope_y + i), d, {T::load(at.status + i)});
  }
};

template <class T, bool has_opl>
Ray<T> load(const RayColumns& rays, int i) {
  return {{T::load(rays.x + i), T::load(rays.y + i), T::load(rays.z + i)}, {T::load(rays.l + i), T::load(rays.m + i), T::load(rays.n + i)},
          has_opl ? T::load(rays.opl + i) : T(0), T::load(rays.ended + i)};
}
template <bool has_opl, class T>
void store(const Ray<T>& ray, const RayColumns& rays, int i) {
  ray.position.x.store(rays.x + i), ray.position.y.store(rays.y + i), ray.position.z.store(rays.z + i);
  ray.direction.x.store(rays.l + i), ray.direction.y.store(rays.m + i), ray.direction.z.store(rays.n + i);
  if constexpr (has_opl) ray.opl.store(rays.opl + i);
  ray.ended.store(rays.ended + i);
}

// The last rays of a block, which do not fill a vector, in columns that do.
class Remainder {
 public:
  static constexpr int capacity = 16;

  [[gnu::noinline]] void take(const RayColumns& rays, int from, int count) {
    for (int i = 0; i < capacity; ++i) ended_[i] = 1;
    copy(rays, from, count, [](auto& ours, auto& theirs) { ours = theirs; });
  }
  [[gnu::noinline]] void put_back(const RayColumns& rays, int from, int count) {
    copy(rays, from, count, [](auto& ours, auto& theirs) { theirs = ours; });
  }
  RayColumns columns(bool with_opl) { return {of_[0], of_[1], of_[2], of_[3], of_[4], of_[5], with_opl ? of_[6] : nullptr, ended_}; }

 private:
  template <class CopyOne>
  void copy(const RayColumns& rays, int from, int count, const CopyOne& copy_one) {
    double* const theirs[]{rays.x, rays.y, rays.z, rays.l, rays.m, rays.n, rays.opl};
    for (int i = 0; i < count; ++i) {
      for (int k = 0; k < 7; ++k)
        if (theirs[k]) copy_one(of_[k][i], theirs[k][from + i]);
      copy_one(ended_[i], rays.ended[from + i]);
    }
  }

  double of_[7][capacity]{};
  std::int32_t ended_[capacity];
};

// work(columns, i, k): on the n rays from columns[i] on, which are from k on in the block.
template <int in_vector, class Work>
void for_each_vector(const RayColumns& rays, int ray_count, const Work& work) {
  constexpr int n = 2 * in_vector;
  const int in_vectors = ray_count - ray_count % n;
  const int left = ray_count - in_vectors;
  Remainder remainder;
  if (left > 0) remainder.take(rays, in_vectors, left);
  for (const bool is_remainder : {false, true}) {  // in one loop, so that the work is there once
    const RayColumns columns = is_remainder ? remainder.columns(rays.opl) : rays;
    const int count = is_remainder ? left : in_vectors;
    for (int i = 0; i < count; i += n) work(columns, i, is_remainder ? in_vectors : i);
  }
  if (left > 0) remainder.put_back(rays, in_vectors, left);
}

template <StepKind kind, class Shape>
void advance_by(const Shape& given_shape, const StepSetting& given_setting, double shift, const RayColumns& columns, int ray_count) {
  numerics::with_chosen_instructions_flat([&]<int n>() {
    using T = Several<n>;
    const Shape shape = given_shape;  // copies, which no store to a column can change
    const StepSetting setting = given_setting;
    const double z_shift = shift;
    for_each_vector<n>(columns, ray_count, [&](const RayColumns& rays, int i, int k) {
      Ray<T> ray = load<T, kind.has_opl>(rays, i);
      shift_along_z(z_shift, ray);
      if constexpr (std::is_same_v<Shape, Met>)
        store<kind.has_opl>(step<kind, false>(setting, ray, shape.at(k, ray.direction)), rays, i);
      else
        store<kind.has_opl>(step<kind, surface::has_unit_normals<Shape>>(setting, ray, shape.meet(ray.position, ray.direction)), rays, i);
    });
  });
}

template <class Shape>
void choose_step(StepKind known_late, const Shape& shape, const StepSetting& setting, double shift, const RayColumns& rays, int ray_count) {
  with_kind(known_late, [&]<StepKind kind>() { advance_by<kind>(shape, setting, shift, rays, ray_count); });
}

// Into a frame that is turned, or moved across the axis.
void enter(const Transform& given, const RayColumns& columns, int ray_count) {
  numerics::with_chosen_instructions_flat([&]<int n>() {
    using T = Several<n>;
    const Transform transform = given;
    for_each_vector<n>(columns, ray_count, [&](const RayColumns& rays, int i, int) {
      store<false>(entered(transform, load<T, false>(rays, i)), rays, i);
    });
  });
}

template <class Shape>
void meet(const Shape& shape, double shift, const RayColumns& rays, int ray_count, surface::BlockOfCrossings& crossings) {
  surface::BlockOfLines lines;
  lines.count = ray_count;
  for (int i = 0; i < ray_count; ++i) {
    lines.x[i] = rays.x[i], lines.y[i] = rays.y[i], lines.z[i] = rays.z[i] + shift;
    lines.l[i] = rays.l[i], lines.m[i] = rays.m[i], lines.n[i] = rays.n[i];
    lines.travels[i] = rays.ended[i] == 0;
  }
  numerics::with_chosen_instructions([&]<int n>() __attribute__((always_inline)) {
    if constexpr (requires { shape.template meet_block<n>(lines, crossings); }) shape.template meet_block<n>(lines, crossings);
    else if constexpr (MeetsBlocks<Shape>) shape.meet_block(lines, crossings);
    else
      for (int i = 0; i < lines.count; ++i)
        if (lines.travels[i]) crossings.put(i, shape.meet(Vec3<double>{lines.x[i], lines.y[i], lines.z[i]}, Vec3<double>{lines.l[i], lines.m[i], lines.n[i]}));
  });
}

}  // namespace

void advance(const scene::Surface& surface, int surface_number, const Transform& local_from_previous, bool is_shift, double index_before,
             double index_after, const RayColumns& rays, int ray_count) {
  const StepSetting setting = StepSetting::of(surface, surface_number, index_before, index_after);
  const StepKind kind{deflection_at(surface, index_before, index_after), rays.opl != nullptr, surface.has_apertures()};
  if (!is_shift) enter(local_from_previous, rays, ray_count);
  const double shift = is_shift ? local_from_previous.translation.z : -0.0;
  std::visit(
      [&]<class Shape>(const Shape& shape) {
        if constexpr (surface::has_closed_form<Shape>) {
          choose_step(kind, shape, setting, shift, rays, ray_count);
        } else {
          surface::BlockOfCrossings crossings;
          meet(shape, shift, rays, ray_count, crossings);
          choose_step(kind, Met{&crossings}, setting, shift, rays, ray_count);
        }
      },
      surface.shape);
}

}  // namespace sagitta::trace
