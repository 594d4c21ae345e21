// SPDX-License-Identifier: Apache-2.0
// The rays of launch.h in any number type T: double in the tracer, 50 digits where its rounding is measured. The numbers of the
// scene, the field and the pupil are taken as exact.
#pragma once

#include <cmath>
#include <span>

#include "lib/trace/launch.h"

namespace sagitta::trace {

template <class T>
Vec3<T> object_point(const scene::Scene& scene, const scene::Field& field) {
  const T x(field.x), y(field.y), z(scene.object.z);
  if (field.is_height) return {x, y, z};
  const T to_pupil = T(scene.pupil.z) - z;
  return {-to_pupil * x, -to_pupil * y, z};
}

// Calls put(i, position, direction, opl) for every pupil point; `opl` is without the part that all rays share, which is returned.
template <class T, class Put>
T launch_collimated(const scene::Scene& scene, const scene::Field& field, double index_before, std::span<const PupilPoint> pupil, const Put& put) {
  const T index(index_before), semi_diameter(scene.pupil.semi_diameter), z(scene.pupil.z);
  const Vec3<T> d = numerics::normalized(Vec3<T>{T(field.x), T(field.y), T(1)});
  for (std::size_t i = 0; i < pupil.size(); ++i) {
    const T x = T(pupil[i].x) * semi_diameter, y = T(pupil[i].y) * semi_diameter;
    put(i, Vec3<T>{x, y, z}, d, T(index * (x * d.x + y * d.y)));
  }
  return index * z * d.z;
}

template <class T, class Put>
T launch_telecentric(const scene::Scene& scene, const scene::Field& field, std::span<const PupilPoint> pupil, const Put& put) {
  const T edge(scene.pupil.edge_tangent);
  for (std::size_t i = 0; i < pupil.size(); ++i)
    put(i, object_point<T>(scene, field), numerics::normalized(Vec3<T>{T(pupil[i].x) * edge, T(pupil[i].y) * edge, T(1)}), T(0));
  return T(0);
}

template <class T, class Put>
T launch_from_point(const scene::Scene& scene, const scene::Field& field, double index_before, std::span<const PupilPoint> pupil, const Put& put) {
  using numerics::dot, numerics::norm;
  const T index(index_before), semi_diameter(scene.pupil.semi_diameter);
  const Vec3<T> object = object_point<T>(scene, field), centre{T(0), T(0), T(scene.pupil.z)};
  const Vec3<T> to_centre = centre - object;
  const T sense(to_centre.z < T(0) ? -1 : 1);
  const bool from_object = std::abs(scene.object.z) < std::abs(scene.pupil.z);
  for (std::size_t i = 0; i < pupil.size(); ++i) {
    const Vec3<T> off_centre{T(pupil[i].x) * semi_diameter, T(pupil[i].y) * semi_diameter, T(0)};
    const Vec3<T> to_point = to_centre + off_centre;
    const Vec3<T> d = T(sense / norm(to_point)) * to_point;
    // |p - O| - |centre - O| without cancellation
    const T longer = dot(off_centre, to_point + to_centre) / (norm(to_point) + norm(to_centre));
    if (from_object)
      put(i, object, d, T(0));
    else
      put(i, centre + off_centre, d, T(sense * index * longer));
  }
  return from_object ? T(0) : T(sense * index * norm(to_centre));
}

template <class T, class Put>
T launch_rays(const scene::Scene& scene, const scene::Field& field, double index_before, std::span<const PupilPoint> pupil, const Put& put) {
  if (scene.object.at_infinity()) return launch_collimated<T>(scene, field, index_before, pupil, put);
  if (scene.pupil.telecentric) return launch_telecentric<T>(scene, field, pupil, put);
  return launch_from_point<T>(scene, field, index_before, pupil, put);
}

}  // namespace sagitta::trace
