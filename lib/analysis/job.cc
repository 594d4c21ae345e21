// SPDX-License-Identifier: Apache-2.0
#include "lib/analysis/job.h"

#include <algorithm>
#include <cmath>

#include "lib/trace/launch.h"
#include "lib/trace/trace.h"

namespace sagitta::analysis {
namespace {

// The centre of the spot images of one field, and the half width that holds every spot.
struct Frame {
  double x = 0, y = 0, half_width = 0;
};

Frame frame_of(std::span<const JobResult> field) {
  Frame frame;
  bool centred = false;
  for (const JobResult& result : field) {
    if (result.rays[surface::Status::ok] == 0) continue;
    const Spot& spot = *result.spot;
    if (!centred) frame.x = spot.centroid_x, frame.y = spot.centroid_y, centred = true;
    const double offset = std::hypot(spot.centroid_x - frame.x, spot.centroid_y - frame.y);
    frame.half_width = std::max(frame.half_width, offset + spot.geometric_radius);
  }
  return frame;
}

// The smallest 1, 2 or 5 times a power of ten that is at least `value`.
double round_up(double value) {
  const double decade = std::pow(10, std::floor(std::log10(value)));
  for (const double step : {1.0, 2.0, 5.0, 10.0})
    if (step * decade >= value) return step * decade;
  return 10 * decade;
}

bool is_made_of_data(const surface::Shape& shape) {
  return std::visit([]<class S>(const S&) { return requires { S::is_made_of_data; }; }, shape);
}

std::vector<Coverage> coverage_of(const scene::Scene& scene, const trace::StatusCounts& rays) {
  std::vector<Coverage> result;
  std::int64_t reaching = rays.total();
  for (int number = 1; number <= scene.surface_count(); ++number) {
    std::int64_t lost = 0, outside = 0;
    for (const auto& [ended, count] : rays.endings) {
      if (ended / 8 != number) continue;
      lost += count;
      if (static_cast<surface::Status>(ended % 8) == surface::Status::outside_data) outside = count;
    }
    if (is_made_of_data(scene.surface(number).shape))
      result.push_back({number, static_cast<double>(reaching - outside) / static_cast<double>(reaching)});
    reaching -= lost;
  }
  return result;
}

// All spots at one scale. A perfect image still has a size to draw: a nanometre.
void draw_spots(const scene::Scene& scene, const JobRequest& request, const std::vector<trace::RayBatch>& batches,
                std::vector<JobResult>& results) {
  const std::size_t wavelength_count = scene.wavelengths.size();
  std::vector<Frame> frames;
  double half_width = 1e-6;
  for (std::size_t field = 0; field < scene.fields.size(); ++field) {
    frames.push_back(frame_of(std::span(results).subspan(field * wavelength_count, wavelength_count)));
    half_width = std::max(half_width, frames.back().half_width);
  }
  const double pixel = 2 * round_up(1.0001 * half_width) / request.spot_image_size;
  for (std::size_t i = 0; i < results.size(); ++i) {
    const Frame& frame = frames[results[i].field];
    results[i].spot_image = spot_image(batches[i], request.spot_image_size, pixel, frame.x, frame.y);
  }
}

}  // namespace

std::vector<JobResult> run_job(const scene::Scene& scene, const JobRequest& request,
                               const std::function<void()>& one_done) {
  std::vector<trace::PupilPoint> pupil;
  if (request.want_spot) pupil = trace::pupil_points(request.pattern, request.ray_count);
  WavefrontRequest wavefront_request = request.wavefront;
  wavefront_request.thread_count = request.thread_count;

  std::vector<JobResult> results;
  std::vector<trace::RayBatch> batches;  // kept until the common scale of the spot images is known
  for (std::size_t field = 0; field < scene.fields.size(); ++field)
    for (std::size_t w = 0; w < scene.wavelengths.size(); ++w) {
      const scene::Wavelength& wavelength = scene.wavelengths[w];
      JobResult result;
      result.field = field;
      result.wavelength = w;
      if (request.want_wavefront) {
        result.wavefront = wavefront(scene, wavelength, scene.fields[field], wavefront_request);
        if (result.wavefront->wavefront) result.rays = result.wavefront->wavefront->rays;
      }
      if (request.want_spot) {
        trace::RayBatch rays = launch(scene, scene.fields[field], wavelength.index.front(), pupil);
        trace::trace(scene, wavelength, rays, request.thread_count);
        result.spot = spot(rays);
        result.rays = result.spot->rays;
        batches.push_back(std::move(rays));
      }
      result.coverage = coverage_of(scene, result.rays);
      results.push_back(std::move(result));
      if (one_done) one_done();
    }
  if (request.want_spot) draw_spots(scene, request, batches, results);
  return results;
}

}  // namespace sagitta::analysis
