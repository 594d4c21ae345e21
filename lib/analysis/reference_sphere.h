// SPDX-License-Identifier: Apache-2.0
// The sphere that a wavefront is measured to, equations (2) and (3) of wavefront.h, in any number type T: double in the analysis, 50 digits
// where its rounding is measured.
#pragma once

#include <cmath>

#include "lib/numerics/vec3.h"
#include "lib/scene/scene.h"

namespace sagitta::analysis {

using numerics::Vec3;

inline constexpr double largest_reference_radius = 1e8;  // mm; beyond it the reference sphere is a plane

template <class T>
struct ReferenceSphere {
  Vec3<T> centre;  // Q, in the image surface's frame
  T radius;        // R
  T opl_chief;     // from the origin that all rays share to Q
  T index;         // n'
};

// About the chief ray's place in the image surface's frame, through its point in the plane of the exit pupil; a radius of 0 or NaN is
// none.
template <class T>
ReferenceSphere<T> sphere_about(const scene::Scene& scene, const scene::Wavelength& wavelength, double exit_pupil_z, const Vec3<T>& position, const Vec3<T>& direction,
                                const T& opl) {
  const int image = scene.surface_count();
  const auto& global = scene.surface(image).global_from_local;
  const Vec3<T> row = numerics::vec3_cast<T>(global.rotation.row_z);
  const T z = dot(row, position) + T(global.translation.z);
  return {position, (T(exit_pupil_z) - z) / dot(row, direction), opl, T(wavelength.index[static_cast<std::size_t>(image - 1)])};
}

// (3), in mm; NaN where the ray does not meet the sphere.
template <class T>
T optical_path_difference(const ReferenceSphere<T>& sphere, const Vec3<T>& position, const Vec3<T>& d, const T& opl) {
  using std::abs, std::sqrt;
  const Vec3<T> p = position - sphere.centre;
  const T b = dot(p, d);
  T from_plane(0);
  if (abs(sphere.radius) <= T(largest_reference_radius)) {
    const Vec3<T> off = cross(p, d);
    const T h = dot(off, off);
    from_plane = h / (abs(sphere.radius) + sqrt(sphere.radius * sphere.radius - h));
    if (sphere.radius < T(0)) from_plane = -from_plane;
  }
  return (sphere.opl_chief - opl) + sphere.index * (b + from_plane);
}

}  // namespace sagitta::analysis
