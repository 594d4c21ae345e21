// SPDX-License-Identifier: Apache-2.0
// The answers of a system (spot RMS, wavefront RMS, Zernike coefficients) by more and more rays and by every interpolation of its
// point clouds, and what each takes in time: the main job (analysis/job.h) as `trace` runs it, again and again.
//
// Spots by the patterns that fill the pupil, at rungs of 100, 300, 1000, ... rays per field and wavelength; wavefronts on grids of 16 x 16 and more. Between a
// rung and the next come up to 8 counts more, of random patterns each with another seed, and at most N_f/(2 N) of them above a rung N of N_f, the finest, but one.
// The finest are the largest of these rungs whose price stays within a budget:
//   price = rays x fields x wavelengths x sum of weights,  weight 1 of a surface, 10 of points, 80 of points by radial functions, 600 of a gap with a
//                                                               gradient index (1)
// so that they do not depend on how fast the machine is. Every interpolation of a cloud takes the most rays of the first pattern and the finest grid; the
// other clouds stay as given.
//
// So a claim (convergence.h) of hexapolar rays, clipped or not, broke on none of 675 answers by counts that were not measured, of the other patterns on 3 of 1350
// (tests/study/sampling_slow_test.cc).
//
// Rays in gradients are integrated to a tolerance: of a system with any, a few rays and samples run by each of a ladder of tolerances, the tightest the truth, with
// the steps that a ray takes.
//
// Times are of the rungs: launching, tracing and collecting; short runs are repeated. Reading, compiling, drawing and writing are not in them.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "lib/prescription/model.h"
#include "lib/study/convergence.h"
#include "lib/study/timing.h"

namespace sagitta::study {

struct SamplingRequest {
  std::int64_t most_rays = 3'000'000;  // per field and wavelength; at least 1000
  int most_grid = 384;                 // points a side of the pupil; at least 24
  double budget = 1e9;                 // of (1), for spots, and for wavefronts with a weight of 500 more, for the fit of their Zernike terms
  int thread_count = 0;                // 0: as many as the machine runs
};

// Of one field and wavelength. What there is no answer to has a reason.
struct Answers {
  std::size_t field = 0, wavelength = 0;  // from 0
  std::int64_t launched = 0, arrived = 0;
  Answer spot_rms_um, wavefront_rms_waves, zernike_um;
  std::string no_spot, no_wavefront, no_zernike;
};

struct Run {
  std::string pattern;        // of the spots' rays; "" for wavefronts alone
  std::int64_t rays = 0;      // asked for; 0 for wavefronts alone
  int grid = 0;               // points a side; 0 for spots alone
  std::vector<Answers> answers;  // by field, then wavelength
  Spread processor_s, wall_s;    // of all threads together, all fields and wavelengths; the clock's
  std::vector<std::vector<Answers>> beyond = {};  // of the counts between it and the next rung, rising
};

// Of processor time, through the whole system.
inline double ns_per_ray(const Run& run) {
  double rays = 0;
  for (const Answers& answers : run.answers) rays += static_cast<double>(answers.launched);
  return 1e9 * run.processor_s.median / rays;
}

// One interpolation of one cloud, all else as given.
struct CloudRun {
  int surface_number = 0;
  std::string surface, interpolation;
  bool is_given = false;   // the user's own
  std::string reason;      // why there is no run
  double prepare_s = 0;    // processor, of compiling the whole system
  Run spots, wavefronts;

  double ns_per_ray() const { return study::ns_per_ray(spots); }  // NaN where there is no run
};

// One tolerance of the integration through gradients, all else as given.
struct ToleranceRun {
  double tolerance_mm = 0;
  bool is_given = false;  // the system's own
  double steps = 0;       // of a ray through all the gradients, on average over some rays of every field
  Run spots, wavefronts;
};

struct Sampling {
  prescription::Findings findings;        // with an error: then there is nothing else
  std::vector<double> wavelengths_um;
  std::vector<std::vector<Run>> spots;    // by pattern, the one of the truth first; by rising rays
  std::vector<Run> wavefronts;            // by rising grid
  std::vector<CloudRun> clouds;           // surface by surface; c1, the truth, first
  std::vector<ToleranceRun> tolerances;   // rising, the truth first; none where there is no gradient
};

// Calls `progress` with the share that is done, in [0, 1].
Sampling sample_system(const prescription::Model& system, const SamplingRequest& request, const std::function<void(double)>& progress);

}  // namespace sagitta::study
