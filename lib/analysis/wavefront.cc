// SPDX-License-Identifier: Apache-2.0
#include "lib/analysis/wavefront.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "lib/numerics/sum.h"
#include "lib/scene/first_order.h"
#include "lib/trace/launch.h"
#include "lib/trace/trace.h"

namespace sagitta::analysis {
namespace {

using numerics::cross;
using numerics::dot;
using numerics::Vec3;
using surface::Status;
using trace::RayBatch;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double largest_radius = 1e8;     // mm; beyond it the reference sphere is a plane
constexpr double afocal_distance = 1e8;    // mm; a paraxial image farther away than this is none

// The chief ray at the image surface. A central obscuration does not stop it.
RayBatch trace_chief(const scene::Scene& scene, const scene::Wavelength& wavelength, const scene::Field& field) {
  scene::Scene open = scene;
  for (scene::Surface& surface : open.surfaces) surface.inner_semi_diameter = 0;
  RayBatch chief = launch(scene, field, wavelength.index.front(), std::vector<trace::PupilPoint>{{0, 0}});
  trace::trace(open, wavelength, chief);
  return chief;
}

struct ReferenceSphere {
  Vec3<double> centre;  // Q, in the image surface's frame
  double radius;        // R
  double opl_chief;     // from the batches' common origin to Q
  double index;         // n'
};

// (3), in mm; NaN where the ray does not meet the sphere.
double optical_path_difference(const ReferenceSphere& sphere, const RayBatch& rays, std::size_t ray) {
  const Vec3<double> p = rays.position(ray) - sphere.centre, d = rays.direction(ray);
  const double b = dot(p, d);
  double from_plane = 0;
  if (std::abs(sphere.radius) <= largest_radius) {
    const Vec3<double> off = cross(p, d);
    const double h = dot(off, off);
    from_plane = h / (std::abs(sphere.radius) + std::sqrt(sphere.radius * sphere.radius - h));
    if (sphere.radius < 0) from_plane = -from_plane;
  }
  return (sphere.opl_chief - rays.opl[ray]) + sphere.index * (b + from_plane);
}

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

// Where the chief ray meets the image surface, and the sphere about that point; a reason where there is none.
struct ReferenceResult {
  ReferenceSphere sphere;
  std::string reason;
};

ReferenceResult reference_sphere(const scene::Scene& scene, const scene::Wavelength& wavelength, const scene::Field& field) {
  const scene::FirstOrder paraxial = first_order(scene, wavelength, nan);
  const int image = scene.surface_count();
  if (!(std::abs(paraxial.image_z) <= afocal_distance)) return {{}, "the image is afocal"};
  const RayBatch chief = trace_chief(scene, wavelength, field);
  if (chief.ended[0] != 0)
    return {{}, fmt::format("the chief ray is lost: {} at surface {}",
                            surface::status_names[static_cast<std::size_t>(chief.status(0))], chief.ended_at(0))};
  ReferenceSphere sphere{chief.position(0), 0, chief.opl[0], wavelength.index[static_cast<std::size_t>(image - 1)]};
  sphere.radius = (paraxial.exit_pupil.z - trace::global_position(scene, image, chief, 0).z) /
                  trace::global_direction(scene, image, chief, 0).z;
  if (!(sphere.radius != 0)) return {{}, "the exit pupil lies in the image: the reference sphere has no radius"};
  return {sphere, {}};
}

}  // namespace

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
  RayBatch rays = launch(scene, field, wavelength.index.front(), points);
  trace::trace(scene, wavelength, rays, request.thread_count);
  const ReferenceResult reference = reference_sphere(scene, wavelength, field);
  if (!reference.reason.empty()) return {{}, reference.reason, count_statuses(rays)};

  result.reference_radius = reference.sphere.radius;
  result.opd_waves.assign(result.mask.size(), nan);
  std::vector<Sample> samples;  // in um
  for (std::size_t pixel = 0, ray = 0; pixel < result.mask.size(); ++pixel) {
    if (result.mask[pixel] == outside_pupil) continue;
    if (rays.ended[ray] == 0) {
      const double opd_um = optical_path_difference(reference.sphere, rays, ray) * 1e3;
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
