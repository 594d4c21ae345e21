// SPDX-License-Identifier: Apache-2.0
// A scene at one of its wavelengths, as exact rays see it, and how far the tracer's rays are from them. The doubles of the scene are
// taken as exact.
#pragma once

#include <vector>

#include "lib/study/fifty_digits_internal.h"
#include "lib/study/through_internal.h"
#include "lib/trace/ray_batch.h"

namespace sagitta::study {

using Exact = FiftyDigits;
using ExactRay = Path<Exact>;

inline double size_of(const Exact& value) { return std::abs(static_cast<double>(value)); }
inline double size_of(const Vec3<Exact>& value) { return static_cast<double>(norm(value)); }

// A step to a surface, in its frame: the ray as it comes, where it meets the surface (status ok, or why not), and the ray behind.
struct ExactStep {
  Vec3<Exact> start, direction;
  surface::Crossing<Exact> crossing;
  ExactRay behind;
  Vec3<Exact> arriving;              // the direction at the hit: in a gradient another one
  Exact index_before, index_behind;  // at the hit
};

struct View {
  const scene::Scene& scene;
  const scene::Wavelength& wavelength;

  int surface_count() const { return scene.surface_count(); }
  double index_before(int number) const { return wavelength.index[static_cast<std::size_t>(number - 1)]; }
  double index_behind(int number) const { return wavelength.index[static_cast<std::size_t>(number)]; }
  bool is_dummy(int number) const { return scene.surface(number).does_nothing(index_before(number), index_behind(number)); }

  // Of a ray that has not ended.
  ExactStep look(int number, const ExactRay& ray) const {
    if (wavelength.has_gradient_at(number)) {
      const ThroughGradient<Exact> step = through_gradient(scene.surface(number), number, wavelength, ray);
      return {step.entering.position, step.entering.direction, step.step.crossing, step.behind, step.step.arriving, step.step.index_before, step.step.index_behind};
    }
    ExactStep result;
    result.index_before = index_before(number), result.index_behind = index_behind(number);
    result.behind = through(scene.surface(number), number, index_before(number), index_behind(number), ray, [&](const Vec3<Exact>& p, const Vec3<Exact>& d) {
      result.start = p, result.direction = result.arriving = d;
      return result.crossing = std::visit([&](const auto& shape) -> surface::Crossing<Exact> { return shape.meet(p, d); }, scene.surface(number).shape);
    });
    return result;
  }
  ExactRay step(int number, const ExactRay& ray) const { return ray.ended != 0 ? ray : look(number, ray).behind; }
  // From the frame of surface `from` past dummies to surface `number`. A ray that one of them ends has no crossing.
  ExactStep look_past(int from, int number, ExactRay ray) const {
    for (int next = from + 1; next < number; ++next) ray = step(next, ray);
    if (ray.ended == 0) return look(number, ray);
    return {ray.position, ray.direction, surface::no_crossing<Exact>(Status::missed), ray, ray.direction, {}, {}};
  }
  ExactRay to_image(int behind, ExactRay ray) const {
    for (int number = behind + 1; number <= surface_count(); ++number) ray = step(number, ray);
    return ray;
  }
};

// The length of the direction is the tracer's error too, and stays with the step that made it.
inline ExactRay as_exact(const trace::RayBatch& state, std::size_t i) {
  return {numerics::vec3_cast<Exact>(state.position(i)), numerics::normalized(numerics::vec3_cast<Exact>(state.direction(i))), state.ended[i], Exact(state.opl[i])};
}

struct Differences {
  double position = 0, direction = 0, opl = 0;
};
inline Differences differences(const ExactRay& ray, const ExactRay& truth) {
  return {size_of(ray.position - truth.position), size_of(ray.direction - truth.direction), size_of(ray.opl - truth.opl)};
}

}  // namespace sagitta::study
