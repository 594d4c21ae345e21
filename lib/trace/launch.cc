// SPDX-License-Identifier: Apache-2.0
#include "lib/trace/launch.h"

#include "lib/trace/launch_rays.h"

namespace sagitta::trace {
namespace {

// Rays that are not found end at once, where they would have been launched, in the frame of the stop.
void end_lost(const scene::Scene& scene, const AimedPupil& aimed, std::int32_t ended, RayBatch& rays) {
  const numerics::RigidTransform<double> stop_from_global = scene.surface(scene.stop).global_from_local.inverse();
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (aimed.found[i]) continue;
    const double opl = rays.opl.empty() ? 0 : rays.opl[i];
    rays.set(i, stop_from_global * rays.position(i), stop_from_global.rotation * rays.direction(i), opl);
    rays.ended[i] = ended;
  }
}

}  // namespace

Launcher::Launcher(const scene::Scene& scene, const scene::Field& field, const scene::Wavelength& wavelength)
    : scene_(scene), field_(field), index_before_(wavelength.index.front()) {
  if (scene.pupil.is_of_stop) aim_.emplace(scene, field, wavelength);
}

AimedPupil Launcher::at_entrance_pupil(std::span<const PupilPoint> pupil, int thread_count) const {
  if (aim_) return aim_->at(pupil, thread_count);
  return {{pupil.begin(), pupil.end()}, std::vector<bool>(pupil.size(), true), 0};
}

RayBatch Launcher::operator()(std::span<const PupilPoint> pupil, bool with_opl, int thread_count) const {
  if (!aim_) return launch(scene_, field_, index_before_, pupil, with_opl);
  const AimedPupil aimed = aim_->at(pupil, thread_count);
  RayBatch rays = launch(scene_, field_, index_before_, aimed.points, with_opl);
  end_lost(scene_, aimed, ending_of_lost(), rays);
  return rays;
}

RayBatch launch(const scene::Scene& scene, const scene::Field& field, const scene::Wavelength& wavelength, std::span<const PupilPoint> pupil, bool with_opl) {
  return Launcher(scene, field, wavelength)(pupil, with_opl);
}

RayBatch launch(const scene::Scene& scene, const scene::Field& field, double index_before, std::span<const PupilPoint> pupil, bool with_opl) {
  RayBatch rays(pupil.size(), with_opl);
  rays.opl_origin = launch_rays<double>(scene, field, index_before, pupil, [&](std::size_t i, const Vec3<double>& position, const Vec3<double>& direction, double opl) {
    rays.set(i, position, direction, opl);
  });
  return rays;
}

}  // namespace sagitta::trace
