// SPDX-License-Identifier: Apache-2.0
#include "lib/analysis/job.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numbers>
#include <span>

#include "lib/numerics/parallel.h"
#include "lib/scene/first_order.h"
#include "lib/trace/launch.h"
#include "lib/trace/trace.h"

namespace sagitta::analysis {
namespace {

using numerics::Vec3;
using surface::Status;

// Points of the pupil that all fields and wavelengths take before the next ones are made; and rays that travel together: few
// enough that a batch stays in the second-level cache, more where several threads share them.
constexpr std::int64_t portion = 1 << 15;
constexpr std::size_t batch_size = 1 << 13;

// Some rays over the pupil and many on its rim: a sample of those of any pattern.
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

// The launchers of a scene, field by field, each with all wavelengths.
struct Launchers {
  Launchers(const scene::Scene& given, int thread_count) : scene(given), of(given.fields.size() * given.wavelengths.size()) {
    numerics::share_blocks(of.size(), thread_count, [&] {
      return [&](std::size_t i) { of[i].emplace(scene, scene.fields[i / scene.wavelengths.size()], scene.wavelengths[i % scene.wavelengths.size()]); };
    });
  }

  // Without OPL, which spots do not need.
  trace::RayBatch traced(std::size_t field, std::size_t w, std::span<const trace::PupilPoint> pupil, int thread_count) const {
    trace::RayBatch rays = (*of[field * scene.wavelengths.size() + w])(pupil, false, thread_count);
    trace::trace(scene, scene.wavelengths[w], rays, thread_count);
    return rays;
  }

  const scene::Scene& scene;
  std::vector<std::optional<trace::Launcher>> of;
};

// Where the spots of a scene's fields are, each about the first wavelength that brings rays, and how far they all reach
// from there. A perfect image still has a size to draw: a nanometre.
struct SpotFrames {
  struct Centre {
    double x = 0, y = 0, z = 0;  // z: of one of the rays
  };
  std::vector<Centre> centres;
  double half_width = 1e-6;
};

// Whether the rays of any wavelength arrived.
bool frame_spots(const Launchers& launchers, std::size_t field, std::span<const trace::PupilPoint> pupil, SpotFrames& frames) {
  SpotFrames::Centre& centre = frames.centres[field];
  bool centred = false;
  for (std::size_t w = 0; w < launchers.scene.wavelengths.size(); ++w) {
    SpotCollector collector(SpotImage(0, 1, 0, 0));
    const trace::RayBatch rays = launchers.traced(field, w, pupil, 1);
    collector.add(rays);
    const Spot spot = collector.spot();
    if (spot.rays[Status::ok] == 0) continue;
    const auto arrived = static_cast<std::size_t>(std::find(rays.ended.begin(), rays.ended.end(), 0) - rays.ended.begin());
    if (!centred) centre = {spot.centroid_x, spot.centroid_y, rays.z[arrived]};
    centred = true;
    frames.half_width = std::max(frames.half_width, std::hypot(spot.centroid_x - centre.x, spot.centroid_y - centre.y) + spot.geometric_radius);
  }
  return centred;
}

// By the pilot rays; where none of a field arrives, by the first of the job's own rays that do, for sums about a place far from
// the spot would lose its digits.
SpotFrames spot_frames(const Launchers& launchers, const JobRequest& request) {
  const std::vector<trace::PupilPoint> pilot = pilot_points();
  SpotFrames frames{std::vector<SpotFrames::Centre>(launchers.scene.fields.size())};
  for (std::size_t field = 0; field < launchers.scene.fields.size(); ++field) {
    if (frame_spots(launchers, field, pilot, frames)) continue;
    trace::PupilStream stream(request.pattern, request.ray_count);
    for (std::vector<trace::PupilPoint> pupil; !(pupil = stream.next(batch_size)).empty();)
      if (frame_spots(launchers, field, pupil, frames)) break;
  }
  return frames;
}

// In the image surface's frame; none where angles from it say no more than x and y.
std::optional<Vec3<double>> nodal_point_of(const scene::Scene& scene) {
  const scene::Surface& image = scene.surface(scene.surface_count());
  const double z = first_order(scene, scene.primary, 1).rear_nodal_point;
  if (std::holds_alternative<surface::Plane>(image.shape) || !std::isfinite(z)) return {};
  return image.global_from_local.inverse() * Vec3<double>{0, 0, z};
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

scene::Beam beam_of_job(std::optional<scene::LaunchPupil> pupil) {
  return trace::beam_of([pupil](const scene::Scene& scene, const std::function<void(const trace::LaunchedRays&)>& take) {
    scene::Scene launching = scene;
    if (pupil) launching.pupil = *pupil;
    const std::vector<trace::PupilPoint> points = pilot_points();
    for (std::size_t field = 0; field < scene.fields.size(); ++field)
      for (std::size_t w = 0; w < scene.wavelengths.size(); ++w)
        take({launch(launching, scene.fields[field], scene.wavelengths[w], points, false), field, w});
  });
}

std::vector<std::vector<JobResult>> run_jobs(std::span<const scene::Scene> scenes, const JobRequest& request, const Progress& progress) {
  struct Task {
    const scene::Scene* scene;
    JobResult* result;
  };
  std::vector<std::vector<JobResult>> results(scenes.size());
  std::vector<Task> tasks;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    const std::size_t wavelength_count = scenes[i].wavelengths.size();
    results[i].resize(scenes[i].fields.size() * wavelength_count);
    for (std::size_t k = 0; k < results[i].size(); ++k) {
      results[i][k].field = k / wavelength_count;
      results[i][k].wavelength = k % wavelength_count;
      tasks.push_back({&scenes[i], &results[i][k]});
    }
  }

  if (request.want_spot) {
    std::vector<Launchers> launchers;
    std::vector<SpotFrames> frames;
    double half_width = 0;
    for (const scene::Scene& scene : scenes) {
      launchers.emplace_back(scene, request.thread_count);
      frames.push_back(spot_frames(launchers.back(), request));
      half_width = std::max(half_width, frames.back().half_width);
    }
    const double first_pixel = 2 * round_up(half_width) / request.spot_image_size;
    std::vector<SpotCollector> collectors;
    std::vector<std::optional<AngularSpotCollector>> angular_collectors;
    for (const Task& task : tasks) {
      const SpotFrames::Centre& centre = frames[static_cast<std::size_t>(task.scene - scenes.data())].centres[task.result->field];
      collectors.emplace_back(SpotImage(request.spot_image_size, first_pixel, centre.x, centre.y));
      angular_collectors.emplace_back();
      if (const auto nodal_point = nodal_point_of(*task.scene)) angular_collectors.back().emplace(*nodal_point, Vec3<double>{centre.x, centre.y, centre.z});
    }
    // Each task has one thread, or some where there are few tasks; its rays are collected in their order.
    const int threads = numerics::thread_count_of(request.thread_count);
    const int threads_of_task = std::max(1, threads / static_cast<int>(numerics::worker_count(tasks.size(), threads)));
    const std::size_t batch = threads_of_task > 1 ? portion : batch_size;
    trace::PupilStream stream(request.pattern, request.ray_count);
    std::mutex counting;
    std::int64_t done = 0;
    const double all = static_cast<double>(stream.size()) * static_cast<double>(tasks.size());
    for (std::vector<trace::PupilPoint> pupil; !(pupil = stream.next(portion)).empty();) {
      numerics::share_blocks(tasks.size(), threads, [&] {
        return [&](std::size_t i) {
          const auto& [scene, result] = tasks[i];
          for (std::size_t from = 0; from < pupil.size(); from += batch) {
            const trace::RayBatch rays = launchers[static_cast<std::size_t>(scene - scenes.data())].traced(
                result->field, result->wavelength, std::span(pupil).subspan(from, std::min(batch, pupil.size() - from)), threads_of_task);
            collectors[i].add(rays);
            if (angular_collectors[i]) angular_collectors[i]->add(rays);
          }
          const std::lock_guard lock(counting);
          done += static_cast<std::int64_t>(pupil.size());
          if (progress) progress(static_cast<double>(done) / all);
        };
      });
    }
    double pixel = 0;
    for (const SpotCollector& collector : collectors) pixel = std::max(pixel, collector.image().pixel_mm);
    for (std::size_t i = 0; i < tasks.size(); ++i) {
      JobResult& result = *tasks[i].result;
      result.spot = collectors[i].spot();
      if (angular_collectors[i]) result.angular_spot = angular_collectors[i]->spot(tasks[i].scene->surfaces.back().global_from_local.rotation);
      result.spot_image = collectors[i].image_with(pixel);
      result.rays = result.spot->rays;
    }
  }
  ZernikeFitter fitter(request.wavefront.indexing, request.wavefront.zernike_terms);
  for (const auto& [scene, result] : tasks) {
    if (request.want_wavefront) {
      WavefrontRequest wanted = request.wavefront;
      wanted.thread_count = request.thread_count;
      result->wavefront = wavefront(*scene, scene->wavelengths[result->wavelength], scene->fields[result->field], wanted, fitter);
      if (!request.want_spot) result->rays = result->wavefront->rays;
    }
    result->coverage = coverage_of(*scene, result->rays);
  }
  return results;
}

std::vector<JobResult> run_job(const scene::Scene& scene, const JobRequest& request, const Progress& progress) {
  return std::move(run_jobs({&scene, 1}, request, progress).front());
}

}  // namespace sagitta::analysis
