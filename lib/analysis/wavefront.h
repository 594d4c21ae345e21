// SPDX-License-Identifier: Apache-2.0
// Wavefront error over the entrance pupil, for one field and wavelength.
//
//   OPD = OPL(chief) - OPL(ray), both to the reference sphere; in waves                                            (1)
//
// The sphere is centred on the chief ray's image point Q and passes through the point where the chief ray meets the plane
// of the paraxial exit pupil: radius |R|, R the signed distance from Q along the chief ray. For a ray at p (from Q) with
// direction d, b = p.d and h = |p|^2 - b^2 (its squared distance from Q), the sphere is met at
//   t = -b + s sqrt(R^2 - h),   s = sign R                                                                          (2)
// and with n' the index of the image space (1) becomes, without cancellation,
//   OPD = [OPL(chief) - OPL(ray)]_image + n' (b + s h/(|R| + sqrt(R^2 - h))).                                         (3)
// The last term vanishes as |R| grows; beyond |R| = 1e8 mm it is left out (the plane limit). A ray with h > R^2 has no
// OPD: it counts as missed.
//
// Samples: size x size points (i - size/2)/(size/2 - 1) of the unit pupil disc, those with x^2 + y^2 <= 1 traced; the
// point size/2 is the chief ray. RMS is about the mean, peak-to-valley over the samples; tilt stays in.
// Zernike coefficients in um, by least squares over the samples (zernike_fit.h).
//
// Source: Welford, Aberrations of Optical Systems (1986), chapter 7; sign and grid are OpticStudio's.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lib/analysis/reference_sphere.h"
#include "lib/analysis/zernike_fit.h"
#include "lib/scene/scene.h"
#include "lib/trace/ray_batch.h"

namespace sagitta::analysis {

struct WavefrontRequest {
  int size = 64;
  int zernike_terms = 36;
  numerics::ZernikeIndexing indexing = numerics::ZernikeIndexing::osa;
  int thread_count = 1;
};

// mask value of a point outside the pupil disc; inside it is the ray's Status.
inline constexpr std::uint32_t outside_pupil = 255;

struct Wavefront {
  int size = 0;
  std::vector<double> opd_waves;    // size x size, row 0 is the top (largest y); NaN where there is none
  std::vector<std::uint32_t> mask;  // size x size
  double reference_radius = 0;      // R of (2), mm, signed
  double rms_waves = 0, peak_to_valley_waves = 0;
  std::optional<ZernikeFit> zernike;  // coefficients in um; none where the samples do not determine the terms
};

struct WavefrontResult {
  std::optional<Wavefront> wavefront;
  std::string reason;         // why there is none
  trace::StatusCounts rays;   // of the grid
};

WavefrontResult wavefront(const scene::Scene& scene, const scene::Wavelength& wavelength, const scene::Field& field,
                          const WavefrontRequest& request);

// The sphere alone; a reason where there is none.
struct ReferenceResult {
  ReferenceSphere<double> sphere;
  double exit_pupil_z = 0;  // global
  std::string reason;
};
ReferenceResult reference_sphere(const scene::Scene& scene, const scene::Wavelength& wavelength, const scene::Field& field);

// As the chief ray sees the scene: a central obscuration does not stop it.
scene::Scene without_obscurations(scene::Scene scene);
// The same with a fitter of the request's terms that others have used before.
WavefrontResult wavefront(const scene::Scene& scene, const scene::Wavelength& wavelength, const scene::Field& field,
                          const WavefrontRequest& request, ZernikeFitter& fitter);

}  // namespace sagitta::analysis
