// SPDX-License-Identifier: Apache-2.0
#include "lib/study/gradient_bound_internal.h"

#include <algorithm>
#include <cmath>

#include "lib/study/carried_internal.h"

namespace sagitta::study {
namespace {

using gradient_index::InMedium, gradient_index::State, gradient_index::Tolerance;
using numerics::vec3_cast;

constexpr double u = 0x1p-53;

// Of r, p and S.
struct Sizes {
  double position = 0, optical_direction = 0, opl = 0;
};
Sizes larger(const Sizes& a, const Sizes& b) { return {std::max(a.position, b.position), std::max(a.optical_direction, b.optical_direction), std::max(a.opl, b.opl)}; }
bool is_finite(const Sizes& a) { return std::isfinite(a.position + a.optical_direction + a.opl); }

Vec3<Carried> variable(const Vec3<double>& v, std::size_t first) {
  Vec3<Carried> result{v.x, v.y, v.z};
  result.x.slopes[first] = result.y.slopes[first + 1] = result.z.slopes[first + 2] = 1;
  return result;
}
void forget_rounding(Vec3<Carried>& v) { v.x.rounding = v.y.rounding = v.z.rounding = 0; }
double rounding_of(const Vec3<Carried>& v) { return std::hypot(v.x.rounding, v.y.rounding, v.z.rounding); }

// Of the derivatives by three of the variables.
double size_of_slopes(const Vec3<Carried>& v, std::size_t first) {
  double sum = 0;
  for (const Carried* one : {&v.x, &v.y, &v.z})
    for (std::size_t i = first; i < first + 3; ++i) sum += one->slopes[i] * one->slopes[i];
  return std::sqrt(sum);
}

// (2)
Sizes at_end(const State<Carried>& at, const Sizes& off) {
  const double A = size_of_slopes(at.position, 0), B = size_of_slopes(at.position, 3), C = size_of_slopes(at.optical_direction, 0), D = size_of_slopes(at.optical_direction, 3);
  const auto& S = at.opl.slopes;
  const double r = D * off.position + B * off.optical_direction, p = C * off.position + A * off.optical_direction;
  return {r, p, off.opl + std::hypot(S[0], S[1], S[2]) * r + std::hypot(S[3], S[4], S[5]) * p};
}

Sizes sum(const Sizes& a, const Sizes& b) { return {a.position + b.position, a.optical_direction + b.optical_direction, a.opl + b.opl}; }
Sizes times(double factor, const Sizes& a) { return {factor * a.position, factor * a.optical_direction, factor * a.opl}; }

// What of (3) goes with the length of a step: rounding, and what the error may be for it.
Sizes rounding_of(const State<Carried>& from, const State<Carried>& to) {
  const auto held = [](double of, double rounding) { return 128 * u * of + rounding; };
  return {held(gradient_index::size_of(Vec3<Carried>(to.position - from.position)), rounding_of(to.position)), held(gradient_index::size_of(from.optical_direction), rounding_of(to.optical_direction)),
          held(gradient_index::size_of(Carried(to.opl - from.opl)), to.opl.rounding)};
}

// From its hit back along the ray, by an optical path of `path`; the tracer has come there in so many steps.
template <class Medium>
std::optional<Sizes> carried_to(const Medium& medium, const Vec3<double>& hit, const Vec3<double>& arriving, double path, int steps, const Tolerance& tolerance, const Uncertainty& start) {
  State<Carried> ray{variable(hit, 0), {}, Carried(0)};
  InMedium<Carried> at = medium.at(vec3_cast<Carried>(hit));
  const auto n_squared = [&] { return at.squared_index.value; };
  ray.optical_direction = variable(std::sqrt(n_squared()) * arriving, 3);
  at = medium.at(ray.position);
  Sizes of_tolerance, of_rounding;
  int taken = 0;
  double longest = std::numeric_limits<double>::infinity();
  for (int tries = 0; tries < 2 * gradient_index::most_steps; ++tries) {
    const double left = path + ray.opl.value;  // what is behind is negative
    if (std::abs(left) <= 1e-6 * std::abs(path)) {
      const double n = std::sqrt(n_squared()), of_length = 8 * u + at.squared_index.rounding / n_squared();
      const Sizes own = at_end(ray, {start.line, n * (start.turn + of_length), 0}), of_steps = times(2, sum(times(steps + 2, of_tolerance), times(taken + 2, of_rounding)));  // (4)
      const Sizes all = sum(own, of_steps);
      return is_finite(all) ? std::optional(all) : std::nullopt;
    }
    if (!gradient_index::is_squared_index(n_squared())) return std::nullopt;
    // Variations obey r'' = H r, H the derivative of the pull: they are followed where the ray itself, along an axis, needs no steps at all.
    const InMedium<Carried> here = medium.at(variable(vec3_cast<double>(ray.position), 0));
    const double turn_limit = std::sqrt(n_squared()) / gradient_index::size_of(here.pull), parting_limit = 1 / std::sqrt(size_of_slopes(here.pull, 0));
    const double h = -std::copysign(std::min({longest, turn_limit, parting_limit, std::abs(left) / n_squared()}), left);
    State<Carried> from = ray;
    forget_rounding(from.position), forget_rounding(from.optical_direction), from.opl.rounding = 0;
    const auto next = gradient_index::leap(medium, from, medium.at(from.position), Carried(h), tolerance);
    longest = std::abs(h) * gradient_index::step_factor(next.error);
    if (!(next.error <= 1)) continue;
    const Sizes held{tolerance.mm, tolerance.mm, tolerance.mm}, off = rounding_of(from, next.behind);
    of_tolerance = larger(of_tolerance, larger(at_end(from, held), at_end(next.behind, held)));
    of_rounding = larger(of_rounding, larger(at_end(from, off), at_end(next.behind, off)));
    ray = next.behind, at = medium.at(ray.position), ++taken;
  }
  return std::nullopt;
}

// The index there, by which it changes, and its rounding as a part of it.
struct IndexAt {
  double index, slope, rounding;
};
IndexAt index_at(const scene::GradientGap& gap, const Vec3<Carried>& place) {
  const Carried n = trace::index_in(gap, place);
  return {n.value, std::hypot(n.slopes[0], n.slopes[1], n.slopes[2]), n.rounding / n.value};
}

}  // namespace

std::optional<AtGradient> at_gradient(const View& view, int number, const ExactStep& step, const Uncertainty& given) {
  const scene::Surface& surface = view.scene.surface(number);
  const scene::GradientGap *before = view.wavelength.gradient(number - 1), *behind = view.wavelength.gradient(number);
  const Vec3<double> hit = vec3_cast<double>(step.crossing.point);
  AtGradient result{vec3_cast<double>(step.arriving), given.line, given.turn, 0, 0, view.index_before(number), view.index_behind(number), 0, 0, 0};
  if (before) {
    const trace::Ray<double> entering{vec3_cast<double>(step.start), vec3_cast<double>(step.direction), 0, 0};
    const trace::GradientStep<double> tracer = trace::step_in_gradient(surface, number, view.wavelength, view.scene.tolerance, entering);
    if (tracer.crossing.status != Status::ok) return std::nullopt;
    const numerics::RigidTransform<double> medium_from_here = trace::medium_from_surface(surface, *before);
    const auto off = std::visit(
        [&]<class Form>(const Form& form) {
          const trace::PlacedForm<Carried, Form> medium = trace::placed<Carried>(form, medium_from_here);
          return carried_to(medium, hit, result.arriving, tracer.behind.opl, tracer.steps, view.scene.tolerance, given);
        },
        before->form);
    if (!off) return std::nullopt;
    const IndexAt index = index_at(*before, trace::transform_cast<Carried>(surface.local_from_previous.inverse()) * variable(hit, 0));
    result.line = off->position, result.turn = off->optical_direction / index.index + 4 * u, result.opl = off->opl, result.path = tracer.behind.opl;
    result.index_before = index.index, result.slope_before = index.slope, result.index_rounding += index.rounding;
  }
  if (surface.mirror || surface.image) {
    result.index_behind = result.index_before, result.slope_behind = result.slope_before;
  } else if (behind) {
    const IndexAt index = index_at(*behind, variable(hit, 0));
    result.index_behind = index.index, result.slope_behind = index.slope, result.index_rounding += index.rounding;
  }
  return result;
}

}  // namespace sagitta::study
