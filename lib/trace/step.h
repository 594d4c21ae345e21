// SPDX-License-Identifier: Apache-2.0
// One ray through one surface, in the surface's frame: to the hit, past its apertures, and on in the new direction. T is a
// double, or several in lanes (numerics/lanes.h), and everything in it is in select form. What a surface does not have is
// left out when the step is compiled: OPL, apertures, a deflection.
#pragma once

#include "lib/scene/scene.h"
#include "lib/surface/refraction.h"
#include "lib/trace/ray_batch.h"

namespace sagitta::trace {

enum class Deflection { none, refract, reflect };

struct StepKind {
  Deflection deflection;
  bool has_opl, has_apertures;
};

inline Deflection deflection_at(const scene::Surface& surface, double index_before, double index_after) {
  if (surface.image) return Deflection::none;
  if (surface.mirror) return Deflection::reflect;
  return index_before == index_after ? Deflection::none : Deflection::refract;
}

// Calls work.operator()<kind>() with a kind that is known only when the program runs.
template <class Work>
void with_kind(StepKind kind, const Work& work) {
  const auto with_deflection = [&]<bool opl, bool apertures>() {
    switch (kind.deflection) {
      case Deflection::none: return work.template operator()<StepKind{Deflection::none, opl, apertures}>();
      case Deflection::refract: return work.template operator()<StepKind{Deflection::refract, opl, apertures}>();
      case Deflection::reflect: return work.template operator()<StepKind{Deflection::reflect, opl, apertures}>();
    }
  };
  if (kind.has_opl)
    kind.has_apertures ? with_deflection.template operator()<true, true>() : with_deflection.template operator()<true, false>();
  else
    kind.has_apertures ? with_deflection.template operator()<false, true>() : with_deflection.template operator()<false, false>();
}

// The surface's plain numbers.
template <class Number>
struct StepSettingOf {
  Number index_before;
  surface::IndexRatio<Number> ratio;
  Number outer_squared, inner_squared;  // of the semi-diameters
  int surface_number;

  static StepSettingOf of(const scene::Surface& surface, int surface_number, const Number& index_before, const Number& index_after) {
    const Number outer(surface.semi_diameter), inner(surface.inner_semi_diameter);
    return {index_before, surface::IndexRatio<Number>::of(index_before, index_after), outer * outer, inner * inner, surface_number};
  }
};
using StepSetting = StepSettingOf<double>;

template <class T>
struct Ray {
  Vec3<T> position, direction;
  T opl, ended;  // as in RayBatch
};

// The crossing that a block of crossings holds (surface/block.h).
template <class T>
surface::Crossing<T> crossing_by_slopes(const T& path, const Vec3<T>& point, const T& slope_x, const T& slope_y, const Vec3<T>& d,
                                        const typename surface::StatusIn<T>::Type& status) {
  return {path, point, {-slope_x, -slope_y, T(1)}, d.z - slope_x * d.x - slope_y * d.y, status};
}

// Into a frame that is turned, or moved across the axis; or one that is moved along it alone. Rays that have ended stay in
// theirs. (z + -0 is z, -0 too.)
template <class T>
Ray<T> entered(const numerics::RigidTransform<double>& transform, const Ray<T>& ray) {
  using numerics::select;
  const auto cast = [](const Vec3<double>& v) { return numerics::vec3_cast<T>(v); };
  const numerics::RigidTransform<T> in_lanes{{cast(transform.rotation.row_x), cast(transform.rotation.row_y), cast(transform.rotation.row_z)},
                                             cast(transform.translation)};
  const Vec3<T> position = in_lanes * ray.position, direction = in_lanes.rotation * ray.direction;
  const auto travels = ray.ended == T(0);
  const auto chosen = [&](const Vec3<T>& a, const Vec3<T>& b) {
    return Vec3<T>{select<T>(travels, a.x, b.x), select<T>(travels, a.y, b.y), select<T>(travels, a.z, b.z)};
  };
  return {chosen(position, ray.position), chosen(direction, ray.direction), ray.opl, ray.ended};
}
template <class T>
void shift_along_z(double shift, Ray<T>& ray) {
  ray.position.z = ray.position.z + numerics::select<T>(ray.ended == T(0), T(shift), T(-0.0));
}

// A ray that travels, from the place where it entered the surface's frame, by its crossing; others stay as they are.
template <StepKind kind, bool has_unit_normals, class Number, class T>
Ray<T> step(const StepSettingOf<Number>& setting, const Ray<T>& ray, const surface::Crossing<T>& crossing) {
  using numerics::all, numerics::select;
  using Verdict = surface::StatusIn<T>;
  const auto travels = ray.ended == T(0);
  const auto met = crossing.status == Status::ok;
  const Vec3<T>&hit = crossing.point, &d = ray.direction;

  auto open = met;
  if constexpr (kind.has_apertures) {
    const T r_squared = hit.x * hit.x + hit.y * hit.y;
    open = (r_squared <= T(setting.outer_squared)) & !(r_squared < T(setting.inner_squared));
  }
  const surface::IndexRatio<T> ratio{T(setting.ratio.mu), T(setting.ratio.one_minus_mu_squared)};
  Vec3<T> out = d;
  if constexpr (kind.deflection == Deflection::refract) out = surface::refract<T, has_unit_normals>(d, crossing.normal, crossing.along, ratio);
  if constexpr (kind.deflection == Deflection::reflect) out = surface::reflect<T, has_unit_normals>(d, crossing.normal, crossing.along);
  const auto transmitted = out.x == out.x;  // not NaN

  const auto moves = travels & met, turns = moves & open & transmitted;
  const T opl = kind.has_opl ? ray.opl + T(setting.index_before) * crossing.path : ray.opl;
  if (all(turns)) return {hit, out, opl, ray.ended};  // what follows is for those that do not go on
  const auto chosen = [](const auto& condition, const Vec3<T>& a, const Vec3<T>& b) {
    return Vec3<T>{select<T>(condition, a.x, b.x), select<T>(condition, a.y, b.y), select<T>(condition, a.z, b.z)};
  };
  Ray<T> after{chosen(moves, hit, ray.position), chosen(turns, out, d), select<T>(moves, opl, ray.opl), ray.ended};
  const T clipped(static_cast<int>(Status::clipped)), reflected(static_cast<int>(Status::total_reflection));
  const T why_not = select<T>(met, select<T>(open, reflected, clipped), Verdict::number(crossing.status));
  after.ended = select<T>(turns | !travels, ray.ended, T(ending(setting.surface_number, Status::ok)) + why_not);
  return after;
}

}  // namespace sagitta::trace
