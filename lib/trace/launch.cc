// SPDX-License-Identifier: Apache-2.0
#include "lib/trace/launch.h"

#include <cmath>

namespace sagitta::trace {
namespace {

using numerics::cross;
using numerics::dot;
using numerics::norm;
using numerics::normalized;

Vec3<double> object_point(const scene::Scene& scene, const scene::Field& field) {
  const double z = scene.object.z;
  if (field.is_height) return {field.x, field.y, z};
  const double to_pupil = scene.pupil.z - z;
  return {-to_pupil * field.x, -to_pupil * field.y, z};
}

RayBatch launch_collimated(const scene::Scene& scene, const scene::Field& field, double index,
                           std::span<const PupilPoint> pupil, bool with_opl) {
  RayBatch rays(pupil.size(), with_opl);
  const Vec3<double> d = normalized(Vec3<double>{field.x, field.y, 1});
  rays.opl_origin = index * scene.pupil.z * d.z;
  for (std::size_t i = 0; i < pupil.size(); ++i) {
    const double x = pupil[i].x * scene.pupil.semi_diameter, y = pupil[i].y * scene.pupil.semi_diameter;
    rays.set(i, {x, y, scene.pupil.z}, d, index * (x * d.x + y * d.y));
  }
  return rays;
}

RayBatch launch_telecentric(const scene::Scene& scene, const scene::Field& field, std::span<const PupilPoint> pupil, bool with_opl) {
  RayBatch rays(pupil.size(), with_opl);
  const double edge = scene.pupil.edge_tangent;
  for (std::size_t i = 0; i < pupil.size(); ++i)
    rays.set(i, object_point(scene, field), normalized(Vec3<double>{pupil[i].x * edge, pupil[i].y * edge, 1}), 0);
  return rays;
}

RayBatch launch_from_point(const scene::Scene& scene, const scene::Field& field, double index,
                           std::span<const PupilPoint> pupil, bool with_opl) {
  RayBatch rays(pupil.size(), with_opl);
  const Vec3<double> object = object_point(scene, field), centre{0, 0, scene.pupil.z};
  const Vec3<double> to_centre = centre - object;
  const double sense = to_centre.z < 0 ? -1 : 1;
  const bool from_object = std::abs(object.z) < std::abs(centre.z);
  rays.opl_origin = from_object ? 0 : sense * index * norm(to_centre);
  for (std::size_t i = 0; i < pupil.size(); ++i) {
    const Vec3<double> off_centre{pupil[i].x * scene.pupil.semi_diameter, pupil[i].y * scene.pupil.semi_diameter, 0};
    const Vec3<double> to_point = to_centre + off_centre;
    const Vec3<double> d = (sense / norm(to_point)) * to_point;
    // |p - O| - |centre - O| without cancellation
    const double longer = dot(off_centre, to_point + to_centre) / (norm(to_point) + norm(to_centre));
    if (from_object)
      rays.set(i, object, d, 0);
    else
      rays.set(i, centre + off_centre, d, sense * index * longer);
  }
  return rays;
}

}  // namespace

RayBatch launch(const scene::Scene& scene, const scene::Field& field, double index_before,
                std::span<const PupilPoint> pupil, bool with_opl) {
  if (scene.object.at_infinity()) return launch_collimated(scene, field, index_before, pupil, with_opl);
  if (scene.pupil.telecentric) return launch_telecentric(scene, field, pupil, with_opl);
  return launch_from_point(scene, field, index_before, pupil, with_opl);
}

}  // namespace sagitta::trace
