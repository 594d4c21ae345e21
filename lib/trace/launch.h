// SPDX-License-Identifier: Apache-2.0
// Fields and pupil points -> rays in the global frame.
//
// A pupil point (px, py) of the unit disc stands at (px, py) times the entrance pupil's semi-diameter, in the plane
// through the paraxial entrance pupil across the axis. Rays travel toward +z:
//   object at infinity   d ~ (tan ax, tan ay, 1), from the pupil point; OPL counts from the plane across the bundle
//                        through the global origin: n d.p
//   object at O          d ~ +-(p - O); OPL counts from O: +-n |p - O| (minus: the pupil lies before the object). An
//                        angle is the chief ray's at the entrance pupil, so O = centre - (z_pupil - z_O)(tan ax, tan ay, 1)
//   telecentric          d ~ (px tan u, py tan u, 1) from O, sin u = object_na/n; OPL 0
// A ray starts at the pupil point, or at O where that is nearer to the first vertex.
//
// Where the scene asks for it, (px, py) is a point of the stop, and the ray is the one of the same field, launched through another point of the same pupil
// plane, that really meets the stop there (aim.h). Fields, OPL and its origin are the same.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "lib/scene/scene.h"
#include "lib/trace/aim.h"
#include "lib/trace/ray_batch.h"

namespace sagitta::trace {

// Rays of one field at one wavelength. What it takes to aim, where rays are aimed, is found out once, when it is made. Scene and wavelength outlive it.
class Launcher {
 public:
  Launcher(const scene::Scene& scene, const scene::Field& field, const scene::Wavelength& wavelength);

  // Every batch has the same opl_origin: the OPL at its start of the ray through the centre of the paraxial entrance pupil. Who asks for no wavefront needs no column of OPL.
  RayBatch operator()(std::span<const PupilPoint> pupil, bool with_opl = true, int thread_count = 1) const;

  // The points of the paraxial entrance pupil that the rays are launched through; itself where rays are not aimed.
  AimedPupil at_entrance_pupil(std::span<const PupilPoint> pupil, int thread_count = 1) const;
  // How a ray ends that cannot be aimed.
  std::int32_t ending_of_lost() const { return ending(scene_.stop, Status::not_converged); }
  const std::optional<Aim>& aim() const { return aim_; }

 private:
  const scene::Scene& scene_;
  scene::Field field_;
  double index_before_;
  std::optional<Aim> aim_;
};

// Some rays at once, aimed where the scene asks for it.
RayBatch launch(const scene::Scene& scene, const scene::Field& field, const scene::Wavelength& wavelength, std::span<const PupilPoint> pupil, bool with_opl = true);

// Through points of the paraxial entrance pupil, whatever the scene asks for. index_before is that of the object space.
RayBatch launch(const scene::Scene& scene, const scene::Field& field, double index_before, std::span<const PupilPoint> pupil, bool with_opl = true);

}  // namespace sagitta::trace
