// SPDX-License-Identifier: Apache-2.0
// Laws for one ray through one gradient-index gap, beside those of wild_laws.h.
#pragma once

#include <optional>

#include "lib/trace/trace.h"
#include "tests/extreme/wild_laws.h"

namespace sagitta::test {

// Sent back from the tracer's hit against the direction in which it came there, the ray comes to the plane across its start, there and against its direction: within what both ways
// are uncertain by, the first way's carried along the second (study/gradient_bound_internal.h, (4)). None: it comes to another crossing of that plane, which a ray that
// turns has; or the way back has no bound.
inline std::optional<double> reversed_in_gradient(const Passage& at) {
  const scene::GradientGap& gap = *at.view.wavelength.gradient(at.number - 1);
  const Vec3<double> start = numerics::vec3_cast<double>(at.exact.start), d = numerics::vec3_cast<double>(at.exact.direction);
  const Vec3<double> aside = normalized(std::abs(d.x) < .5 ? cross(d, Vec3<double>{1, 0, 0}) : cross(d, Vec3<double>{0, 1, 0}));
  const numerics::Rotation<double> turn{aside, cross(d, aside), d};
  Alone alone(at.surface(), 1, 1);
  scene::Surface& plane = alone.scene.surfaces.front();
  plane = scene::Surface{};
  plane.image = true, plane.centred = false;
  plane.local_from_previous = {turn, -(turn * start)};
  alone.scene.tolerance = at.view.scene.tolerance;
  scene::GradientGap there = gap;
  there.medium_from_surface = trace::medium_from_surface(at.surface(), gap);
  alone.wavelength.gradients.emplace(0, there);
  const View view{alone.scene, alone.wavelength};

  const trace::Ray<double> entering{start, d, 0, 0};
  const auto tracer = trace::step_in_gradient(at.surface(), at.number, at.view.wavelength, at.view.scene.tolerance, entering);
  if (tracer.crossing.status != Status::ok) return std::nullopt;
  trace::RayBatch back(1);
  back.set(0, tracer.crossing.point, -tracer.arriving, 0);
  const ExactRay sent = study::as_exact(back, 0);
  trace::trace_surface(alone.scene, alone.wavelength, 1, back);
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
