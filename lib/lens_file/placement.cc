// SPDX-License-Identifier: Apache-2.0
#include "lib/lens_file/placement.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lib/lens_file/numbers.h"

namespace sagitta::lens_file {
namespace {

using numerics::RigidTransform;
using numerics::Rotation;
using Vector = numerics::Vec3<Real>;

Real degrees(Real radians) { return radians / std::acos(Real(-1)) * 180; }
Real radians(Real degrees) { return degrees / 180 * std::acos(Real(-1)); }
Real size_of(const Vector& v) { return std::abs(v.x) + std::abs(v.y) + std::abs(v.z); }
Vector between_half_turns(Vector angles) {
  const auto wrapped = [](Real a) { return a > 180 ? a - 360 : a <= -180 ? a + 360 : a; };
  return {wrapped(angles.x), wrapped(angles.y), wrapped(angles.z)};
}

constexpr Real unit_roundoff = std::numeric_limits<Real>::epsilon() / 2;
constexpr Real of_a_double = std::numeric_limits<double>::epsilon() / 2;

Vector angles_of(const Rotation<Real>& R) {
  const Real in_xy = std::hypot(R.row_x.x, R.row_x.y);
  Vector angles{0, degrees(std::atan2(R.row_x.z, in_xy)), 0};
  if (in_xy <= 64 * unit_roundoff) {
    angles.x = degrees(std::atan2(R.row_z.y, R.row_y.y));  // (3)
    return angles;
  }
  angles.x = degrees(std::atan2(-R.row_y.z, R.row_z.z));  // (2)
  angles.z = degrees(std::atan2(-R.row_x.y, R.row_x.x));
  const Vector other = between_half_turns({angles.x + 180, 180 - angles.y, angles.z + 180});
  return size_of(other) < size_of(angles) ? other : angles;
}

// A frame with what its numbers may be off by.
struct Frame {
  RigidTransform<Real> transform;
  Real lengths = 0;
  int moves = 0;

  void move(const Move& one) {
    transform = transform * transform_of(one);
    lengths += size_of(one.decenter);
    ++moves;
  }
  Placed placed(Real axis_z) const {
    const Real error = 16 * unit_roundoff * Real(moves + 1);
    const auto rounded = [](Real value, Real bound) { return shortest_within(value, std::max(bound, of_a_double * std::abs(value))); };
    const Vector from_axis = transform.translation - Vector{0, 0, axis_z}, angles = angles_of(transform.rotation);
    const Real of_place = error * (lengths + std::abs(axis_z)), of_angle = error * 180;
    const auto angle = [&](Real value) {
      const double result = rounded(value, of_angle);
      return result == -180 ? 180 : result;
    };
    return {{rounded(from_axis.x, of_place), rounded(from_axis.y, of_place), rounded(from_axis.z, of_place)}, {angle(angles.x), angle(angles.y), angle(angles.z)}};
  }
};

}  // namespace

RigidTransform<Real> transform_of(const Move& move) {
  const Vector a{radians(move.tilt_deg.x), radians(move.tilt_deg.y), radians(move.tilt_deg.z)};
  if (!move.tilts_first) return {numerics::rotation_about_new_axes(a.x, a.y, a.z), move.decenter};
  const Rotation<Real> turn = numerics::rotation_about_new_axes(-a.x, -a.y, -a.z).transposed();  // Rz(g) Ry(b) Rx(a)
  return {turn, turn * move.decenter};
}

std::vector<Placed> place(const Lens& lens) {
  std::vector<Placed> result;
  Frame frame;
  Real axis_z = 0;
  for (const Surface& surface : lens.surfaces) {
    for (const Move& one : surface.before) frame.move(one);
    axis_z += surface.thickness_before;
    Frame alone = frame;
    for (const Move& one : surface.own) alone.move(one);
    result.push_back(alone.placed(axis_z));
    for (const Move& one : surface.after) frame.move(one);
    frame.move(Move::along_axis(surface.thickness));
    axis_z += surface.thickness;
  }
  return result;
}

}  // namespace sagitta::lens_file
