// SPDX-License-Identifier: Apache-2.0
#include "lib/trace/launch.h"

#include "lib/trace/launch_rays.h"

namespace sagitta::trace {

RayBatch launch(const scene::Scene& scene, const scene::Field& field, double index_before,
                std::span<const PupilPoint> pupil, bool with_opl) {
  RayBatch rays(pupil.size(), with_opl);
  rays.opl_origin = launch_rays<double>(scene, field, index_before, pupil, [&](std::size_t i, const Vec3<double>& position, const Vec3<double>& direction, double opl) {
    rays.set(i, position, direction, opl);
  });
  return rays;
}

}  // namespace sagitta::trace
