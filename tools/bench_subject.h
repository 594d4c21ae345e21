// SPDX-License-Identifier: Apache-2.0
// What the benchmarks trace: scenes and rays. Where one cannot be made they say why and end the process: a benchmark has
// nothing else to do.
#pragma once

#include <string>

#include "lib/prescription/model.h"
#include "lib/scene/scene.h"
#include "lib/trace/ray_batch.h"

namespace sagitta::bench {

struct Subject {
  scene::Scene scene;
  trace::RayBatch rays;
};

// Surfaces like a cornea's front (R = 7.72 mm, beam of 4 mm), 0.5 mm apart, alternately from air into 1.376 and back.
// `kind` is that of a shape, or, with points, an interpolation; those lie at random over a disc of `data_radius` mm.
scene::Scene corneas(const std::string& kind, int point_count, std::size_t copies, double data_radius = 4);

// A system of systems/.
prescription::Model read_system(const std::string& file);
scene::Scene compiled(const prescription::Model& model);

// The first field's rays over the entrance pupil, in the order of the hexapolar pattern; or with random places in the corneas'
// beam and directions up to 3 degrees off the axis.
trace::RayBatch beam(const scene::Scene& scene, std::size_t ray_count, bool is_random);

}  // namespace sagitta::bench
