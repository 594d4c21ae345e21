// SPDX-License-Identifier: Apache-2.0
#include "lib/analysis/wavefront.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "lib/analysis/reference_sphere.h"
#include "lib/numerics/sum.h"
#include "lib/scene/first_order.h"
#include "lib/trace/launch.h"
#include "lib/trace/trace.h"

namespace sagitta::analysis {
namespace {

using surface::Status;
using trace::RayBatch;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double afocal_distance = 1e8;    // mm; a paraxial image farther away than this is none

std::vector<trace::PupilPoint> grid_points(int size, std::vector<std::uint32_t>& mask) {
  std::vector<trace::PupilPoint> points;
  mask.assign(static_cast<std::size_t>(size) * static_cast<std::size_t>(size), outside_pupil);
  const int half = size / 2;
  std::size_t pixel = 0;
  for (int row = 0; row < size; ++row)
    for (int column = 0; column < size; ++column, ++pixel) {
      const int i = column - half, j = (size - 1 - row) - half;  // row 0 is the largest y
      if (i * i + j * j > (half - 1) * (half - 1)) continue;
      mask[pixel] = 0;
      points.push_back({static_cast<double>(i) / (half - 1), static_cast<double>(j) / (half - 1)});
    }
  return points;
}

void measure(Wavefront& result, const std::vector<Sample>& samples, double wavelength_um, ZernikeFitter& fitter) {
  numerics::Sum sum, squares;
  double low = samples.front().value, high = low;
  for (const Sample& sample : samples) {
    sum.add(sample.value);
    low = std::min(low, sample.value);
    high = std::max(high, sample.value);
  }
  const auto count = static_cast<double>(samples.size());
  const double mean = sum.value() / count;
  for (const Sample& sample : samples) squares.add((sample.value - mean) * (sample.value - mean));
  result.rms_waves = std::sqrt(squares.value() / count) / wavelength_um;
  result.peak_to_valley_waves = (high - low) / wavelength_um;
  result.zernike = fitter.fit(samples);
}

}  // namespace

scene::Scene without_obscurations(scene::Scene scene) {
  for (scene::Surface& surface : scene.surfaces) surface.inner_semi_diameter = 0;
  return scene;
}

ReferenceResult reference_sphere(const scene::Scene& scene, const scene::Wavelength& wavelength, const scene::Field& field) {
  const scene::FirstOrder paraxial = first_order(scene, wavelength, nan);
  const double exit_pupil_z = paraxial.exit_pupil.z;
  if (!(std::abs(paraxial.image_z) <= afocal_distance)) return {{}, exit_pupil_z, "the image is afocal"};
  if (wavelength.gradient(scene.surface_count() - 1))
    return {{}, exit_pupil_z, "the image ends a gradient-index medium, which has no one index for a reference sphere: end the medium at a surface before it"};
  RayBatch chief = launch(scene, field, wavelength, std::vector<trace::PupilPoint>{{0, 0}});
  trace::trace(without_obscurations(scene), wavelength, chief);
  if (chief.ended[0] != 0)
    return {{}, exit_pupil_z, fmt::format("the chief ray is lost: {} at surface {}",
                                          surface::status_names[static_cast<std::size_t>(chief.status(0))], chief.ended_at(0))};
  const auto sphere = sphere_about(scene, wavelength, exit_pupil_z, chief.position(0), chief.direction(0), chief.opl[0]);
  if (!(sphere.radius != 0)) return {{}, exit_pupil_z, "the exit pupil lies in the image: the reference sphere has no radius"};
  return {sphere, exit_pupil_z, {}};
}

WavefrontResult wavefront(const scene::Scene& scene, const scene::Wavelength& wavelength, const scene::Field& field,
                          const WavefrontRequest& request) {
  ZernikeFitter fitter(request.indexing, request.zernike_terms);
  return wavefront(scene, wavelength, field, request, fitter);
}

WavefrontResult wavefront(const scene::Scene& scene, const scene::Wavelength& wavelength, const scene::Field& field,
                          const WavefrontRequest& request, ZernikeFitter& fitter) {
  Wavefront result;
  result.size = request.size;
  const std::vector<trace::PupilPoint> points = grid_points(request.size, result.mask);
  RayBatch rays = trace::Launcher(scene, field, wavelength)(points, true, request.thread_count);
  trace::trace(scene, wavelength, rays, request.thread_count);
  const ReferenceResult reference = reference_sphere(scene, wavelength, field);
  if (!reference.reason.empty()) return {{}, reference.reason, count_statuses(rays)};

  result.reference_radius = reference.sphere.radius;
  result.opd_waves.assign(result.mask.size(), nan);
  std::vector<Sample> samples;  // in um
  for (std::size_t pixel = 0, ray = 0; pixel < result.mask.size(); ++pixel) {
    if (result.mask[pixel] == outside_pupil) continue;
    if (rays.ended[ray] == 0) {
      const double opd_um = optical_path_difference(reference.sphere, rays.position(ray), rays.direction(ray), rays.opl[ray]) * 1e3;
      if (std::isfinite(opd_um)) {
        samples.push_back({points[ray].x, points[ray].y, opd_um});
        result.opd_waves[pixel] = opd_um / wavelength.wavelength_um;
      } else {
        rays.ended[ray] = trace::ending(scene.surface_count(), Status::missed);  // the reference sphere
      }
    }
    result.mask[pixel] = static_cast<std::uint32_t>(rays.status(ray));
    ++ray;
  }
  const trace::StatusCounts counts = count_statuses(rays);
  if (samples.empty()) return {{}, "no ray of the pupil grid arrived", counts};
  measure(result, samples, wavelength.wavelength_um, fitter);
  return {std::move(result), {}, counts};
}

}  // namespace sagitta::analysis
