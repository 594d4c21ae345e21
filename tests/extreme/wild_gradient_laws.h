// SPDX-License-Identifier: Apache-2.0
// Laws for one ray through one gradient-index gap, beside those of wild_laws.h.
#pragma once

#include <optional>

#include "lib/trace/trace.h"
#include "tests/extreme/wild_laws.h"

namespace sagitta::test {

// A plane across a ray at a place of it, alone in the gap before surface `number`; all in that surface's frame.
struct PlaneInGradient {
  Alone alone;

  PlaneInGradient(const View& view, int number, const Vec3<double>& place, const Vec3<double>& direction) : alone(view.scene.surface(number), 1, 1) {
    const Vec3<double> d = normalized(direction), aside = normalized(std::abs(d.x) < .5 ? cross(d, Vec3<double>{1, 0, 0}) : cross(d, Vec3<double>{0, 1, 0}));
    const numerics::Rotation<double> turn{aside, cross(d, aside), d};
    scene::Surface& plane = alone.scene.surfaces.front();
    plane = scene::Surface{};
    plane.image = true, plane.centred = false;
    plane.local_from_previous = {turn, -(turn * place)};
    alone.scene.tolerance = view.scene.tolerance;
    scene::GradientGap there = *view.wavelength.gradient(number - 1);
    there.medium_from_surface = trace::medium_from_surface(view.scene.surface(number), there);
    alone.wavelength.gradients.emplace(0, there);
  }
  View view() const { return {alone.scene, alone.wavelength}; }
};

// The tracer's own step from where the exact ray starts.
inline trace::GradientStep<double> tracers_step(const View& view, int number, const ExactStep& exact) {
  const trace::Ray<double> entering{numerics::vec3_cast<double>(exact.start), numerics::vec3_cast<double>(exact.direction), 0, 0};
  return trace::step_in_gradient(view.scene.surface(number), number, view.wavelength, view.scene.tolerance, entering);
}

// Where a ray in a gradient crosses a folded surface several times, steps see it in four places each (gradient_index/travel.h), and the exact ray's steps are other ones:
// they may meet different crossings, far apart (2026-11-23, seeds 14133, 28674, 35274, 35678: polynomials far beyond their normalization radius), or one of them none
// (seed 83799): then the exact ray comes to a plane across the tracer's at its hit to within 1e3 tolerances.
inline bool is_another_crossing(const View& view, int number, const ExactStep& exact) {
  if (!view.wavelength.gradient(number - 1)) return false;
  const auto tracer = tracers_step(view, number, exact);
  if (tracer.crossing.status != Status::ok) return false;
  const Vec3<double> start = numerics::vec3_cast<double>(exact.start), there = numerics::vec3_cast<double>(exact.crossing.point), hit = tracer.crossing.point;
  if (exact.crossing.status == Status::ok) return norm(hit - there) > .01 * std::min(norm(hit - start), norm(there - start));
  if (exact.crossing.status != Status::missed) return false;
  const PlaneInGradient plane(view, number, hit, tracer.arriving);
  const ExactStep across = plane.view().look(1, {exact.start, exact.direction, 0, Exact(0)});
  return across.crossing.status == Status::ok && size_of(across.crossing.point) <= 1e3 * view.scene.tolerance.mm;
}

// Sent back from the tracer's hit against the direction in which it came there, the ray comes to the plane across its start, there and against its direction: within what both ways
// are uncertain by, the first way's carried along the second (study/gradient_bound_internal.h, (4)). None: it comes to another crossing of that plane, which a ray that
// turns has; or the way back has no bound.
inline std::optional<double> reversed_in_gradient(const Passage& at) {
  const auto tracer = tracers_step(at.view, at.number, at.exact);
  if (tracer.crossing.status != Status::ok) return std::nullopt;
  const PlaneInGradient plane(at.view, at.number, numerics::vec3_cast<double>(at.exact.start), numerics::vec3_cast<double>(at.exact.direction));
  const View view = plane.view();
  trace::RayBatch back(1);
  back.set(0, tracer.crossing.point, -tracer.arriving, 0);
  const ExactRay sent = study::as_exact(back, 0);
  trace::trace_surface(view.scene, view.wavelength, 1, back);
  const ExactStep exact = view.look(1, sent);
  if (back.ended[0] != 0 || exact.behind.ended != 0) return std::nullopt;
  const RoundingBound bound = rounding_bound(view, 0, 1, sent, exact, {at.bound.position, at.bound.turn});
  if (!(bound.position + bound.direction + bound.opl < std::numeric_limits<double>::infinity())) return std::nullopt;
  const double off = norm(back.position(0)), path = std::abs(tracer.behind.opl);
  // another crossing, one from the other side (2026-11-23, seed 22098), or the other way round a closed path (seed 32186)
  if (off > .01 * path || back.n[0] > 0 || std::abs(back.opl[0] - tracer.behind.opl) > .01 * path) return std::nullopt;
  const Vec3<double> against{0, 0, -1};
  return std::max({part(numerics::vec3_cast<Exact>(back.position(0)), bound.position), part(normalized(numerics::vec3_cast<Exact>(back.direction(0))) - numerics::vec3_cast<Exact>(against), bound.direction),
                   part(Exact(back.opl[0] - tracer.behind.opl), bound.opl + at.bound.opl)});
}

}  // namespace sagitta::test
