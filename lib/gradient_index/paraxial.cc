// SPDX-License-Identifier: Apache-2.0
#include "lib/gradient_index/paraxial.h"

#include <limits>

#include "lib/gradient_index/travel.h"
#include "lib/numerics/dual.h"

namespace sagitta::gradient_index {
namespace {

using numerics::Dual;

// (1) for x and for y, in which the section's second derivative is the same: so both columns of the matrix come at once.
template <class FormType>
struct BesideTheAxis {
  const FormType& form;

  InMedium<double> at(const Vec3<double>& place) const {
    const InMedium<Dual> there = form.at(Vec3<Dual>{0, {0, 1}, place.z});
    const double pull = there.pull.y.slope;
    return {there.squared_index.value, {pull * place.x, pull * place.y, there.pull.z.value}};
  }
};

template <class FormType>
ParaxialTransfer transfer(const FormType& form, double z, double thickness, double heading) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN(), eps = std::numeric_limits<double>::epsilon();
  constexpr Tolerance finest{1e-15};
  const BesideTheAxis<FormType> medium{form};
  const double z_end = z + thickness;
  const State<double> start{{1, 0, z}, {0, 1, 0}, 0};
  InMedium<double> at = medium.at(start.position);
  const double index_start = std::sqrt(at.squared_index);
  State<double> ray = start;
  ray.optical_direction.z = heading * index_start;
  double longest = std::numeric_limits<double>::infinity();
  for (int steps = 0; steps < most_steps && is_squared_index(at.squared_index); ++steps) {
    const double left = z_end - ray.position.z;
    if (std::abs(left) <= 2 * eps * (std::abs(z) + std::abs(thickness)))
      return {ray.position.x, ray.position.y, ray.optical_direction.x, ray.optical_direction.y, index_start, std::sqrt(at.squared_index)};
    const double whole = left / ray.optical_direction.z, h = std::copysign(std::min(std::abs(whole), longest), whole);
    const Leap<double> next = leap(medium, ray, at, h, finest);
    longest = std::abs(h) * step_factor(next.error);
    if (!(next.error <= 1)) continue;
    ray = next.behind, at = medium.at(ray.position);
  }
  return {nan, nan, nan, nan, nan, nan};
}

}  // namespace

ParaxialTransfer paraxial_transfer(const Form& form, double z, double thickness, double heading) {
  return std::visit([&](const auto& of) { return transfer(of, z, thickness, heading); }, form);
}

}  // namespace sagitta::gradient_index
