// SPDX-License-Identifier: Apache-2.0
// One ray through one surface with a gradient-index medium before it, behind it, or both, in any number type T: along its curve to the hit
// (gradient_index/travel.h), then the tracer's own step (step.h), with the indices that there are at the hit.
//
// Indices that agree to within the rounding of the gradient's formula are the same: where a gradient ends with the index of what is around it, nothing is refracted,
// at grazing incidence too.
//
// Besides the endings of a shape those of travel.h; and missed where the ray comes to a medium that has no index there, as where it leaves one.
#pragma once

#include <optional>
#include <variant>

#include "lib/gradient_index/travel.h"
#include "lib/trace/step.h"

namespace sagitta::trace {

template <class T>
numerics::RigidTransform<T> transform_cast(const numerics::RigidTransform<double>& a) {
  using numerics::vec3_cast;
  return {{vec3_cast<T>(a.rotation.row_x), vec3_cast<T>(a.rotation.row_y), vec3_cast<T>(a.rotation.row_z)}, vec3_cast<T>(a.translation)};
}

// A form seen from another frame.
template <class T, class Form>
struct PlacedForm {
  const Form& form;
  numerics::RigidTransform<T> medium_from_here;
  bool is_shift;

  gradient_index::InMedium<T> at(const Vec3<T>& place) const {
    if (is_shift) return form.at(place + medium_from_here.translation);
    const gradient_index::InMedium<T> there = form.at(medium_from_here * place);
    return {there.squared_index, medium_from_here.rotation.transposed() * there.pull};
  }
};

// A shape, whichever it is.
template <class T>
struct AnyShape {
  const surface::Shape& shape;

  surface::Crossing<T> meet(const Vec3<T>& place, const Vec3<T>& direction) const {
    return std::visit([&](const auto& of) -> surface::Crossing<T> { return of.meet(place, direction); }, shape);
  }
  gradient_index::TangentPlane<T> tangent(const T& x, const T& y) const {
    return std::visit([&](const auto& of) -> gradient_index::TangentPlane<T> { return {of.sag(x, y), of.gradient(x, y)}; }, shape);
  }
  double sag(double x, double y) const {
    return std::visit([&](const auto& of) { return of.sag(x, y); }, shape);
  }
};

// The frame of the medium before a surface, from the surface's.
inline numerics::RigidTransform<double> medium_from_surface(const scene::Surface& surface, const scene::GradientGap& gap) {
  return gap.medium_from_surface * surface.local_from_previous.inverse();
}
template <class T, class Form>
PlacedForm<T, Form> placed(const Form& form, const numerics::RigidTransform<double>& medium_from_here) {
  return {form, transform_cast<T>(medium_from_here), medium_from_here.rotation == numerics::Rotation<double>{}};
}

// `ray`, which travels, is in the surface's frame, on the surface before.
template <class T>
gradient_index::Arrival<T> travel(const scene::Surface& surface, const scene::GradientGap& gap, const gradient_index::Tolerance& tolerance, const Vec3<T>& place,
                                  const Vec3<T>& direction) {
  const numerics::RigidTransform<double> medium_from_here = medium_from_surface(surface, gap);
  const AnyShape<T> shape{surface.shape};
  return std::visit(
      [&]<class Form>(const Form& form) {
        const PlacedForm<T, Form> medium = placed<T>(form, medium_from_here);
        return gradient_index::Traveller<T, PlacedForm<T, Form>, AnyShape<T>>(medium, shape, tolerance).go(place, direction);
      },
      gap.form);
}

// The index at a place in the frame of the surface before the gap.
template <class T>
T index_in(const scene::GradientGap& gap, const Vec3<T>& place) {
  const Vec3<T> in_medium = transform_cast<T>(gap.medium_from_surface) * place;
  return std::visit([&](const auto& form) { return form.index_at(in_medium); }, gap.form);
}

template <class T>
struct GradientStep {
  Ray<T> behind;
  surface::Crossing<T> crossing;
  T index_before, index_behind;  // at the hit
  int steps;                     // of the integration
  Vec3<T> arriving;              // the direction at the hit, before the surface
};

// `entering` travels and is in the surface's frame already.
template <class T>
GradientStep<T> step_in_gradient(const scene::Surface& surface, int number, const scene::Wavelength& wavelength, const gradient_index::Tolerance& tolerance,
                                 const Ray<T>& entering) {
  using std::abs;
  const scene::GradientGap *before = wavelength.gradient(number - 1), *behind = wavelength.gradient(number);
  const auto index_of_gap = [&](int gap) { return T(wavelength.index[static_cast<std::size_t>(gap)]); };
  Ray<T> ray = entering;
  GradientStep<T> result{ray, {}, index_of_gap(number - 1), index_of_gap(number), 0, ray.direction};
  if (before) {
    const gradient_index::Arrival<T> arrival = travel(surface, *before, tolerance, ray.position, ray.direction);
    result.crossing = arrival.crossing, result.steps = arrival.steps;
    if (arrival.crossing.status == Status::ok) {
      ray.direction = result.arriving = arrival.direction, ray.opl = ray.opl + arrival.state.opl;
      result.index_before = index_in(*before, Vec3<T>(transform_cast<T>(surface.local_from_previous.inverse()) * arrival.crossing.point));
    }
  } else {
    result.crossing = AnyShape<T>{surface.shape}.meet(ray.position, ray.direction);
  }
  const bool passes = !surface.mirror && !surface.image;
  if (result.crossing.status == Status::ok && behind && passes) {
    result.index_behind = index_in(*behind, result.crossing.point);
    const double n = static_cast<double>(result.index_behind);
    if (!(n * n >= gradient_index::least_squared_index && n * n <= gradient_index::largest_squared_index)) result.crossing = surface::no_crossing<T>(Status::missed);
  }
  if (!passes) result.index_behind = result.index_before;
  const T least_step = T(8) * std::numeric_limits<T>::epsilon() * result.index_before;
  if (abs(T(result.index_behind - result.index_before)) <= least_step) result.index_behind = result.index_before;
  if (result.crossing.status != Status::ok) result.crossing.path = T(0), result.crossing.point = ray.position;  // the step forms them whether it moves or not
  const StepKind kind{surface.image || surface.mirror || result.index_behind != result.index_before ? deflection_at(surface, 1, 2) : Deflection::none, true, surface.has_apertures()};
  const auto setting = StepSettingOf<T>::of(surface, number, result.index_before, result.index_behind);
  with_kind(kind, [&]<StepKind known>() { result.behind = step<known, false>(setting, ray, result.crossing); });
  return result;
}

}  // namespace sagitta::trace
