// SPDX-License-Identifier: Apache-2.0
// OPD by the contract's words, in long double and in the global frame: the sphere is met by solving |p + t d - Q| = |R|,
// and both optical paths are taken to it whole.
#pragma once

#include <cmath>

#include "tests/support/prescriptions.h"

namespace sagitta::test {

// In waves; NaN where the ray is lost or does not meet the sphere. `exit_pupil_z` is the paraxial one.
inline double reference_opd(const scene::Scene& scene, const scene::Wavelength& wavelength, const scene::Field& field,
                            double exit_pupil_z, const trace::PupilPoint& point) {
  using Long = long double;
  trace::RayBatch rays = launch(scene, field, wavelength.index.front(), std::vector<trace::PupilPoint>{{0, 0}, point});
  scene::Scene open = scene;
  for (auto& surface : open.surfaces) surface.inner_semi_diameter = 0;
  trace::RayBatch chief = rays;
  trace::trace(open, wavelength, chief);
  trace::trace(scene, wavelength, rays);
  if (chief.ended[0] != 0 || rays.ended[1] != 0) return NAN;
  const auto Q = numerics::vec3_cast<Long>(global_ray(scene, chief, 0).p), along = numerics::vec3_cast<Long>(global_ray(scene, chief, 0).d);
  const auto p = numerics::vec3_cast<Long>(global_ray(scene, rays, 1).p), d = numerics::vec3_cast<Long>(global_ray(scene, rays, 1).d);
  const Long R = (static_cast<Long>(exit_pupil_z) - Q.z) / along.z, index = wavelength.index[scene.surfaces.size() - 1];
  const Long b = dot(p - Q, d), c = dot(p - Q, p - Q) - R * R, root = std::sqrt(b * b - c);
  const Long t = R > 0 ? -b + root : -b - root;
  const Long chief_path = static_cast<Long>(chief.opl_origin) + chief.opl[0] + index * R;
  const Long path = static_cast<Long>(rays.opl_origin) + rays.opl[1] + index * t;
  return static_cast<double>((chief_path - path) * 1000 / wavelength.wavelength_um);
}

}  // namespace sagitta::test
