// SPDX-License-Identifier: Apache-2.0
#include "lib/analysis/job.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "lib/trace/launch.h"
#include "lib/trace/trace.h"

namespace sagitta::analysis {
namespace {

using surface::Status;

// Rays that travel together: few enough that a batch stays in the second-level cache, enough to occupy the threads.
constexpr std::int64_t portion = 1 << 15;

// Some rays over the pupil and many on its rim, to learn where the spot will be and how large.
std::vector<trace::PupilPoint> pilot_points() {
  std::vector<trace::PupilPoint> points = trace::pupil_points({trace::PatternKind::hexapolar}, 600);
  for (int i = 0; i < 360; ++i)
    points.push_back({std::cos(2 * std::numbers::pi * i / 360), std::sin(2 * std::numbers::pi * i / 360)});
  return points;
}

// The smallest 1, 2 or 5 times a power of ten that is at least `value`.
double round_up(double value) {
  const double decade = std::pow(10, std::floor(std::log10(value)));
  for (const double step : {1.0, 2.0, 5.0})
    if (step * decade >= value) return step * decade;
  return 10 * decade;
}

trace::RayBatch traced(const scene::Scene& scene, std::size_t field, std::size_t w, std::span<const trace::PupilPoint> pupil,
                       int thread_count) {
  const scene::Wavelength& wavelength = scene.wavelengths[w];
  trace::RayBatch rays = launch(scene, scene.fields[field], wavelength.index.front(), pupil);
  trace::trace(scene, wavelength, rays, thread_count);
  return rays;
}

// One collector a result, all at one scale; of each field centred on the first wavelength that brings rays. A perfect
// image still has a size to draw: a nanometre.
std::vector<SpotCollector> make_collectors(const scene::Scene& scene, const JobRequest& request) {
  struct Frame {
    double x = 0, y = 0;
  };
  const std::vector<trace::PupilPoint> pilot = pilot_points();
  std::vector<Frame> frames(scene.fields.size());
  double half_width = 1e-6;
  for (std::size_t field = 0; field < frames.size(); ++field) {
    bool centred = false;
    for (std::size_t w = 0; w < scene.wavelengths.size(); ++w) {
      const trace::RayBatch rays = traced(scene, field, w, pilot, 1);
      SpotCollector collector(SpotImage(2, 1, 0, 0));
      collector.add(rays);
      const Spot spot = collector.spot();
      if (spot.rays[Status::ok] == 0) continue;
      if (!centred) frames[field] = {spot.centroid_x, spot.centroid_y};
      centred = true;
      half_width = std::max(half_width, std::hypot(spot.centroid_x - frames[field].x, spot.centroid_y - frames[field].y) + spot.geometric_radius);
    }
  }
  const double pixel = 2 * round_up(half_width) / request.spot_image_size;
  std::vector<SpotCollector> collectors;
  for (const Frame& frame : frames)
    for (std::size_t w = 0; w < scene.wavelengths.size(); ++w)
      collectors.emplace_back(SpotImage(request.spot_image_size, pixel, frame.x, frame.y));
  return collectors;
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
      if (static_cast<Status>(ended % 8) == Status::outside_data) outside = count;
    }
    if (is_made_of_data(scene.surface(number).shape))
      result.push_back({number, static_cast<double>(reaching - outside) / static_cast<double>(reaching)});
    reaching -= lost;
  }
  return result;
}

}  // namespace

std::vector<JobResult> run_job(const scene::Scene& scene, const JobRequest& request, const Progress& progress) {
  std::vector<JobResult> results;
  for (std::size_t field = 0; field < scene.fields.size(); ++field)
    for (std::size_t w = 0; w < scene.wavelengths.size(); ++w) {
      JobResult& result = results.emplace_back();
      result.field = field;
      result.wavelength = w;
    }

  if (request.want_spot) {
    std::vector<SpotCollector> collectors = make_collectors(scene, request);
    trace::PupilStream stream(request.pattern, request.ray_count);
    std::int64_t done = 0;
    const double all = static_cast<double>(stream.size()) * static_cast<double>(results.size());
    for (std::vector<trace::PupilPoint> pupil; !(pupil = stream.next(portion)).empty();)
      for (std::size_t i = 0; i < results.size(); ++i) {
        collectors[i].add(traced(scene, results[i].field, results[i].wavelength, pupil, request.thread_count));
        done += static_cast<std::int64_t>(pupil.size());
        if (progress) progress(static_cast<double>(done) / all);
      }
    double pixel = 0;
    for (const SpotCollector& collector : collectors) pixel = std::max(pixel, collector.image().pixel_mm);
    for (std::size_t i = 0; i < results.size(); ++i) {
      results[i].spot = collectors[i].spot();
      results[i].spot_image = collectors[i].image_with(pixel);
      results[i].rays = results[i].spot->rays;
    }
  }
  if (request.want_wavefront)
    for (JobResult& result : results) {
      WavefrontRequest wanted = request.wavefront;
      wanted.thread_count = request.thread_count;
      result.wavefront = wavefront(scene, scene.wavelengths[result.wavelength], scene.fields[result.field], wanted);
      if (!request.want_spot) result.rays = result.wavefront->rays;
    }
  for (JobResult& result : results) result.coverage = coverage_of(scene, result.rays);
  return results;
}

}  // namespace sagitta::analysis
