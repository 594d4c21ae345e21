// SPDX-License-Identifier: Apache-2.0
// A rotation followed by a translation, p -> R p + t. Named by what it maps: p_local = local_from_global * p_global.
#pragma once

#include "lib/numerics/vec3.h"

namespace sagitta::numerics {

// A rotation matrix by rows.
template <class T>
struct Rotation {
  Vec3<T> row_x{T(1), T(0), T(0)}, row_y{T(0), T(1), T(0)}, row_z{T(0), T(0), T(1)};

  friend constexpr Vec3<T> operator*(const Rotation& r, const Vec3<T>& v) {
    return {dot(r.row_x, v), dot(r.row_y, v), dot(r.row_z, v)};
  }
  friend constexpr Rotation operator*(const Rotation& a, const Rotation& b) {
    const Rotation c = b.transposed();
    return {c * a.row_x, c * a.row_y, c * a.row_z};
  }
  constexpr Rotation transposed() const {
    return {{row_x.x, row_y.x, row_z.x}, {row_x.y, row_y.y, row_z.y}, {row_x.z, row_y.z, row_z.z}};
  }
  friend bool operator==(const Rotation&, const Rotation&) = default;
};

// Right-handed rotation about x, then the new y, then the new z (angles in radians): R = Rx Ry Rz. A positive angle
// about x turns +y toward +z. Exact identity for zero angles.
template <class T>
Rotation<T> rotation_about_new_axes(const T& about_x, const T& about_y, const T& about_z) {
  using std::cos;
  using std::sin;
  const T cx = cos(about_x), sx = sin(about_x), cy = cos(about_y), sy = sin(about_y), cz = cos(about_z),
          sz = sin(about_z);
  const Rotation<T> rx{{T(1), T(0), T(0)}, {T(0), cx, -sx}, {T(0), sx, cx}};
  const Rotation<T> ry{{cy, T(0), sy}, {T(0), T(1), T(0)}, {-sy, T(0), cy}};
  const Rotation<T> rz{{cz, -sz, T(0)}, {sz, cz, T(0)}, {T(0), T(0), T(1)}};
  return rx * (ry * rz);
}

template <class T>
struct RigidTransform {
  Rotation<T> rotation{};
  Vec3<T> translation{};

  friend constexpr Vec3<T> operator*(const RigidTransform& a, const Vec3<T>& p) {
    return a.rotation * p + a.translation;
  }
  friend constexpr RigidTransform operator*(const RigidTransform& a, const RigidTransform& b) {
    return {a.rotation * b.rotation, a.rotation * b.translation + a.translation};
  }
  constexpr RigidTransform inverse() const {
    const Rotation<T> back = rotation.transposed();
    return {back, -(back * translation)};
  }
  friend bool operator==(const RigidTransform&, const RigidTransform&) = default;
};

}  // namespace sagitta::numerics
