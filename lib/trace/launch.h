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
#pragma once

#include <span>
#include <vector>

#include "lib/scene/scene.h"
#include "lib/trace/ray_batch.h"

namespace sagitta::trace {

struct PupilPoint {
  double x = 0, y = 0;
};

// index_before is that of the object space. Every batch of one field, scene and index has the same opl_origin: the
// chief ray's OPL at its start. Who asks for no wavefront needs no column of OPL.
RayBatch launch(const scene::Scene& scene, const scene::Field& field, double index_before,
                std::span<const PupilPoint> pupil, bool with_opl = true);

}  // namespace sagitta::trace
