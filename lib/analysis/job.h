// SPDX-License-Identifier: Apache-2.0
// The main job: every field at every wavelength, traced once, with the analyses that are asked for.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "lib/analysis/angular_spot.h"
#include "lib/analysis/spot.h"
#include "lib/analysis/wavefront.h"
#include "lib/scene/scene.h"
#include "lib/trace/beam.h"
#include "lib/trace/pattern.h"

namespace sagitta::analysis {

struct JobRequest {
  bool want_spot = true;
  bool want_wavefront = true;
  trace::Pattern pattern;
  std::int64_t ray_count = 10000;  // per field and wavelength, at least
  int spot_image_size = 256;       // pixels a side
  WavefrontRequest wavefront;
  int thread_count = 0;            // 0: as many as the machine runs
};

// The share of the rays reaching a surface that is made of data which land inside the data.
struct Coverage {
  int surface_number = 0;
  double share = 0;  // NaN where no ray reached it
};

struct JobResult {
  std::size_t field = 0, wavelength = 0;   // from 0
  trace::StatusCounts rays;                // of the spot's rays, or of the wavefront's where only that is asked for
  std::vector<Coverage> coverage;          // of every surface made of data, by the same rays
  std::optional<Spot> spot;
  std::optional<AngularSpot> angular_spot;  // beside it where the image surface is curved and there is a rear nodal point, that of the primary wavelength
  std::optional<SpotImage> spot_image;     // one pixel size for all the scenes of a job; centred, for all wavelengths of a field, on
                                           // the centroid of some pilot rays of the first one that has any: near the
                                           // spot's own centroid, not on it
  std::optional<WavefrontResult> wavefront;
};

// Called now and then with the share of the rays that are traced, in [0, 1].
using Progress = std::function<void(double)>;

// What the rays of a job need of surfaces made of points (scene/compile.h), whatever its pattern: some rays over the pupil and
// many on its rim, of every field and wavelength. `pupil` takes the place of the scene's own.
scene::Beam beam_of_job(std::optional<scene::LaunchPupil> pupil = {});

// Results by field, then wavelength. Memory does not grow with the number of rays.
std::vector<JobResult> run_job(const scene::Scene& scene, const JobRequest& request, const Progress& progress = {});

// The same for several scenes, so that their spot images have one scale.
std::vector<std::vector<JobResult>> run_jobs(std::span<const scene::Scene> scenes, const JobRequest& request, const Progress& progress = {});

}  // namespace sagitta::analysis
