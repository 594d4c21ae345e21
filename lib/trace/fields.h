// SPDX-License-Identifier: Apache-2.0
// Fields by other quantities than the launch takes (launch.h), at the primary wavelength. A quantity that no field has gives none.
//
//   visual angles          tan of the angle at which the front nodal point N sees the field, each section from its own N. Of a distant object that is the field's own tangent;
//                          of a near one, in the plane z_O, the object point h = -(z_N - z_O) tan a
//   paraxial image heights h' = s t by (4) of scene/first_order.h, each section by its own s
//   real image heights     where the chief ray meets the image surface, in that surface's own frame. The chief ray is the launch's: through the centre of the paraxial
//                          entrance pupil, or aimed at the centre of the stop. No aperture stops it
//
// Real image heights are solved for in the angle vector of a collimated bundle (its length the angle a, its direction that of the tangents), or in the height of the object
// point: from the field on the axis outwards, in steps of the wanted place (continuation), each by damped Newton (plane_search.h). Error: the place is met to
// 1e-12 of its distance from the origin, or to what the rounding of the rays leaves, 1e-9 of it at most. A place that is not found so has no field, which is no proof that there is none.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "lib/scene/scene.h"
#include "lib/trace/plane_search.h"

namespace sagitta::trace {

using Fields = std::vector<std::optional<scene::Field>>;

Fields fields_of_visual_angles(const scene::Scene& scene, std::span<const PupilPoint> tangents);
// Heights and places in mm.
Fields fields_of_paraxial_images(const scene::Scene& scene, std::span<const PupilPoint> heights);
Fields fields_of_real_images(const scene::Scene& scene, std::span<const PupilPoint> places);

}  // namespace sagitta::trace
