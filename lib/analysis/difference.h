// SPDX-License-Identifier: Apache-2.0
// What changes from one system to another when the same rays are launched into both.
//
//   D_i = OPD_i(other) - OPD_i(first),  over the samples i of the pupil grid that arrive in both                      (1)
//   rms = sqrt(mean (D_i - mean D)^2),  P-V = max D - min D,  in waves                                                (2)
//   E_i = D_i - (a + b x_i + c y_i),  a, b, c of the least sum of E_i^2;  rms without tilt = sqrt(mean E_i^2)         (3)
//
// x, y are the places of the samples in the grid. Each wavefront is to the reference sphere about its own chief ray's image
// point, through its own exit pupil, so a shift of the whole image is no part of (1); but where the slope at the chief
// ray's one point changes, (1) is tilted as a whole. That says nothing of the quality of the image: (3) is what does.
// Samples that only one of them has are counted and left out.
// Spots: the difference of the rms radii, and of the centroids.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "lib/analysis/job.h"

namespace sagitta::analysis {

// mask values of a difference's points in the pupil disc; outside it: outside_pupil.
enum class Compared : std::uint32_t { in_both, only_in_first, only_in_other, in_neither };

struct WavefrontDifference {
  int size = 0;
  std::vector<double> opd_waves;    // (1), size x size as in the wavefronts; NaN where there is none
  std::vector<double> without_tilt_waves;  // (3), likewise
  std::vector<std::uint32_t> mask;  // size x size
  std::int64_t in_both = 0, only_in_first = 0, only_in_other = 0;  // samples
  double mean_waves = 0, rms_waves = 0, peak_to_valley_waves = 0;  // NaN where no sample is in both
  double rms_without_tilt_waves = 0;                               // likewise
  std::vector<double> zernike_um;   // coefficient by coefficient; empty where one of them has none
};

// Of wavefronts of the same size.
WavefrontDifference wavefront_difference(const Wavefront& other, const Wavefront& first);

struct SpotDifference {
  double rms_radius = 0;                   // mm; NaN where one has no rays
  double rms_radius_percent = 0;           // of the first's; NaN where that is 0
  std::array<double, 2> centroid_shift{};  // mm
};

SpotDifference spot_difference(const Spot& other, const Spot& first);

// Both, for results that hold a spot and a wavefront or the reason for none.
struct Difference {
  SpotDifference spot;
  std::optional<WavefrontDifference> wavefront;  // none where one of the two has no wavefront
};

// Of the same fields and wavelengths.
std::vector<Difference> differences(const std::vector<JobResult>& other, const std::vector<JobResult>& first);

}  // namespace sagitta::analysis
