// SPDX-License-Identifier: Apache-2.0
// One ray through one surface in any number type, whatever finds the crossing: for the exact rays, and for ways of meeting a surface
// that the tracer does not take. Apertures and endings are the tracer's (trace/step.h).
#pragma once

#include <cstdint>

#include "lib/surface/refraction.h"
#include "lib/trace/gradient_step.h"

namespace sagitta::study {

using numerics::Vec3;
using surface::Status;

template <class T>
struct Path {
  Vec3<T> position, direction;
  std::int32_t ended = 0;  // as in trace::RayBatch
  T opl{};                 // likewise
};

// A ray in the frame of the surface before (before the first: global) goes on into the surface's and through it, if it has not ended.
// `meet(position, direction)` gives the crossing. All doubles are taken as exact.
template <class T, class Meet>
Path<T> through(const scene::Surface& surface, int number, double index_before, double index_after, const Path<T>& ray, const Meet& meet) {
  if (ray.ended != 0) return ray;
  const numerics::RigidTransform<T> local_from_previous = trace::transform_cast<T>(surface.local_from_previous);
  Path<T> result{local_from_previous * ray.position, local_from_previous.rotation * ray.direction, 0, ray.opl};
  const surface::Crossing<T> crossing = meet(result.position, result.direction);
  const auto end = [&](Status status) {
    result.ended = trace::ending(number, status);
    return result;
  };
  if (crossing.status != Status::ok) return end(crossing.status);
  result.position = crossing.point;
  result.opl += T(index_before) * crossing.path;
  const T r_squared = crossing.point.x * crossing.point.x + crossing.point.y * crossing.point.y;
  const T outer(surface.semi_diameter), inner(surface.inner_semi_diameter);
  if (!(r_squared <= outer * outer) || r_squared < inner * inner) return end(Status::clipped);
  Vec3<T> out = result.direction;
  switch (trace::deflection_at(surface, index_before, index_after)) {
    case trace::Deflection::none: break;
    case trace::Deflection::reflect: out = surface::reflect(result.direction, crossing.normal, crossing.along); break;
    case trace::Deflection::refract:
      out = surface::refract(result.direction, crossing.normal, crossing.along, surface::IndexRatio<T>::of(T(index_before), T(index_after)));
      if (!(out.x == out.x)) return end(Status::total_reflection);
  }
  result.direction = out;
  return result;
}

// The same at a surface with a gradient-index medium before or behind it. `entering` is the ray in the surface's frame; of its crossing nothing is left of the path. Steps of
// the integration are exact to 1e-25 mm, or to the rounding of T: of a tracer's ray, what its tolerance leaves is among the errors.
template <class T>
struct ThroughGradient {
  trace::Ray<T> entering;
  trace::GradientStep<T> step;
  Path<T> behind;
};
template <class T>
ThroughGradient<T> through_gradient(const scene::Surface& surface, int number, const scene::Wavelength& wavelength, const Path<T>& ray) {
  constexpr gradient_index::Tolerance finest{1e-25};
  const numerics::RigidTransform<T> local_from_previous = trace::transform_cast<T>(surface.local_from_previous);
  const trace::Ray<T> entering{local_from_previous * ray.position, local_from_previous.rotation * ray.direction, ray.opl, T(0)};
  const trace::GradientStep<T> step = trace::step_in_gradient(surface, number, wavelength, finest, entering);
  return {entering, step, {step.behind.position, step.behind.direction, static_cast<std::int32_t>(static_cast<double>(step.behind.ended)), step.behind.opl}};
}

}  // namespace sagitta::study
