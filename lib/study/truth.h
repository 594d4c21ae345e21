// SPDX-License-Identifier: Apache-2.0
// The exact rays: given pupil points of one field and wavelength through a scene in 50 digits, by the templates that the tracer is
// made of (surface/crossing.h, surface/refraction.h) and none of its kernels, blocks or lanes.
//
// The doubles of the scene (curvatures, coefficients, indices, frames) and of the launched rays are taken as exact; a direction stands
// for the line along it. The ratio of indices is formed anew. The surface under study may carry a roughness on its sag:
// the hit on it is the one continuous with the bare surface's. All surfaces are analytic.
//
// Errors: rounding of 50 digits, after which a place or a direction is stored as long double: 2^-64 of itself, 2000 times finer than
// the doubles that are compared with it (where long double is no longer than double: the same). With `Digits::extended` the
// arithmetic is long double's too. That is for rough surfaces: one of 256 waves takes 2.3 ms a ray in 50 digits, .08 ms so, and phases of up
// to 2e5 rad cost it 2e-16 of a direction (l = 1 um, 25 mm across), less at longer l.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lib/scene/scene.h"
#include "lib/study/roughness.h"
#include "lib/trace/launch.h"

namespace sagitta::study {

enum class Digits { fifty, extended };

// In the frame of the surface; where `ended` (as in trace::RayBatch) is not 0, of the surface that ended it.
struct TrueRay {
  numerics::Vec3<long double> position, direction;
  std::int32_t ended = 0;
};

struct TrueRays {
  std::vector<TrueRay> at_surface;  // the hits on the surface under study, directions behind it
  std::vector<TrueRay> at_image;
};

struct TrueRaysResult {
  std::optional<TrueRays> rays;
  std::string reason;  // why there are none
};

struct TrueRaysRequest {
  int surface_number = 1;                // under study
  const Roughness* roughness = nullptr;  // on it; null: none
  Digits digits = Digits::fifty;
  int thread_count = 0;                  // 0: as many as the machine runs; the same rays for any
};

TrueRaysResult true_rays(const scene::Scene& scene, const scene::Wavelength& wavelength, const scene::Field& field,
                         std::span<const trace::PupilPoint> pupil, const TrueRaysRequest& request);

}  // namespace sagitta::study
