// SPDX-License-Identifier: Apache-2.0
#include "lib/study/sampling.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "lib/analysis/job.h"
#include "lib/analysis/plan.h"
#include "lib/numerics/zernike_basis.h"
#include "lib/scene/compile.h"
#include "lib/study/variant_internal.h"
#include "lib/surface/shapes.h"
#include "lib/surface/status.h"
#include "lib/trace/beam.h"

namespace sagitta::study {
namespace {

using analysis::JobRequest;
using analysis::JobResult;

// Those that fill the pupil, the truth's first.
constexpr const char* patterns[] = {"hexapolar", "square", "random:1"};
constexpr int grids[] = {16, 24, 32, 48, 64, 96, 128, 192, 256, 384};
constexpr double fit_weight = 500;  // of a sample of a wavefront: its share of the fit of Zernike terms, in surfaces
// Whatever the budget: those that `trace` takes unless asked, and two finer.
constexpr std::int64_t least_finest_rays = 100'000;
constexpr int least_finest_grid = 128;
// By which tolerances are compared: the same rays for all, so that few tell.
constexpr std::int64_t tolerance_rays = 1000;
constexpr int tolerance_grid = 32;

// Where counts lie between a rung and the next, of a logarithmic scale: multiples of the golden ratio, which come near no simple part of it.
std::vector<double> places_between(double rung, double next, double finest) {
  std::vector<double> places;
  const int most = std::clamp(static_cast<int>(finest / (2 * rung)), 1, 8);
  for (int i = 1; i <= most; ++i) places.push_back(rung * std::pow(next / rung, i * std::numbers::phi - std::floor(i * std::numbers::phi)));
  std::sort(places.begin(), places.end());
  return places;
}

std::vector<std::int64_t> ray_ladder(double most) {
  std::vector<std::int64_t> rungs;
  for (std::int64_t decade = 100;; decade *= 10)
    for (const std::int64_t rung : {decade, 3 * decade}) {
      if (static_cast<double>(rung) > most) return rungs;
      rungs.push_back(rung);
    }
}

double samples_of(int grid) { return std::numbers::pi * std::pow(grid / 2 - 1, 2); }  // about
int grid_of(double samples) { return 2 * static_cast<int>(std::lround(std::sqrt(samples / std::numbers::pi))) + 2; }  // its inverse; an odd grid has the samples of the even one before

// A system compiled for its job: of large clouds a part, until a ray leaves it.
class CompiledSystem {
 public:
  explicit CompiledSystem(const prescription::Model& model) : model_(model), compiled_(scene::compile(model, analysis::beam_of_job())) {}

  struct Timed {
    std::vector<JobResult> results;
    Times times;
  };
  const scene::CompileResult& compiled() const { return compiled_; }
  Timed run(const JobRequest& request) {
    Timed run = timed(request);
    const bool leaves = std::any_of(run.results.begin(), run.results.end(), [&](const JobResult& result) {
      return trace::leaves_a_part(compiled_.parts, result.rays) || (result.wavefront && trace::leaves_a_part(compiled_.parts, result.wavefront->rays));
    });
    if (!leaves) return run;
    compiled_ = scene::compile(model_);
    return timed(request);
  }

 private:
  Timed timed(const JobRequest& request) const {
    const Times before = times_now(Clocked::process);
    std::vector<JobResult> results = analysis::run_job(*compiled_.scene, request);
    return {std::move(results), times_now(Clocked::process) - before};
  }

  const prescription::Model& model_;
  scene::CompileResult compiled_;
};

Answers answers_of(const JobResult& result) {
  Answers answers{result.field, result.wavelength, result.rays.total(), result.rays[surface::Status::ok], {}, {}, {}, {}, {}, {}};
  if (result.spot && result.spot->rays[surface::Status::ok] > 0) answers.spot_rms_um = {result.spot->rms_radius * 1e3};
  else if (result.spot) answers.no_spot = "no ray arrived";
  if (!result.wavefront) return answers;
  if (const auto& wavefront = result.wavefront->wavefront) {
    answers.wavefront_rms_waves = {wavefront->rms_waves};
    if (wavefront->zernike) answers.zernike_um = wavefront->zernike->coefficients;
    else answers.no_zernike = "the samples do not determine the terms";
  } else {
    answers.no_wavefront = answers.no_zernike = result.wavefront->reason;
  }
  return answers;
}

std::vector<Answers> answers_of(const std::vector<JobResult>& results) {
  std::vector<Answers> answers;
  for (const JobResult& result : results) answers.push_back(answers_of(result));
  return answers;
}

// A long run counts as it is; before short ones, of which there are several, one warms the caches.
Run measured(CompiledSystem& system, const JobRequest& request, const std::string& pattern) {
  Run run{request.want_spot ? pattern : "", request.want_spot ? request.ray_count : 0, request.want_wavefront ? request.wavefront.size : 0, {}, {}, {}};
  const CompiledSystem::Timed first = system.run(request);
  run.answers = answers_of(first.results);
  std::vector<double> processor, wall;
  const auto add = [&](const Times& times) {
    processor.push_back(times.processor);
    wall.push_back(times.wall);
  };
  if (first.times.wall > 0.2) add(first.times);
  else for (const int runs = first.times.wall < 0.01 ? 7 : 3; static_cast<int>(wall.size()) < runs;) add(system.run(request).times);
  run.processor_s = spread_of(processor);
  run.wall_s = spread_of(wall);
  return run;
}

JobRequest job_of(const SamplingRequest& request, const char* pattern, std::int64_t rays, int grid) {
  JobRequest job;
  job.want_spot = rays > 0;
  job.want_wavefront = grid > 0;
  job.pattern = *trace::parse_pattern(pattern);
  job.ray_count = rays;
  job.spot_image_size = 2;  // none is looked at
  job.wavefront.size = grid;
  job.thread_count = request.thread_count;
  return job;
}

// Of a surface and the gap behind it.
double weight_of(const prescription::Surface& surface, const std::string& interpolation) {
  const double gap = surface.gradient ? 600 : 0;
  if (!surface.shape.cloud) return gap + 1;
  return gap + (interpolation == "linear" || interpolation == "c1" ? 10 : 80);
}

// Of a ray and of a sample of a wavefront, for all fields and wavelengths.
struct Prices {
  double of_ray = 0, of_sample = 0;

  Prices(const prescription::Model& system, double weights) {
    const double tasks = static_cast<double>(system.fields.points.size() * system.wavelengths_nm.size());
    of_ray = tasks * weights;
    of_sample = tasks * (weights + fit_weight);
  }
  double of(std::int64_t rays, int grid) const {
    constexpr double of_start = 5e6;  // short runs come several times
    return of_start + static_cast<double>(rays) * of_ray + (grid > 0 ? samples_of(grid) * of_sample : 0);
  }
};

const std::string& interpolation_of(const prescription::Surface& surface) {
  static const std::string none;
  return surface.shape.cloud ? surface.shape.parameters.text("interpolation") : none;
}

CloudRun measured_cloud(prescription::Model model, std::size_t at, const std::string& interpolation, const JobRequest& spots, const JobRequest& wavefronts) {
  prescription::Surface& surface = model.surfaces[at];
  std::string& own = surface.shape.parameters.texts["interpolation"];
  CloudRun result{static_cast<int>(at) + 1, surface.name, interpolation, own == interpolation, {}, 0, {}, {}};
  own = interpolation;
  const Times before = times_now(Clocked::process);
  CompiledSystem system(model);
  result.prepare_s = (times_now(Clocked::process) - before).processor;
  if (!system.compiled().scene) {
    result.reason = first_error(system.compiled().findings);
    return result;
  }
  result.spots = measured(system, spots, patterns[0]);
  result.wavefronts = measured(system, wavefronts, patterns[0]);
  return result;
}

// Rising; the system's own among them.
std::vector<double> tolerances_of(const prescription::Model& system) {
  std::vector<double> tolerances{1e-14, 1e-12, 1e-10, 1e-8, 1e-6, 1e-4, 1e-3, system.tolerance_mm};
  std::sort(tolerances.begin(), tolerances.end());
  tolerances.erase(std::unique(tolerances.begin(), tolerances.end()), tolerances.end());
  return tolerances;
}

ToleranceRun measured_tolerance(prescription::Model model, double tolerance_mm, const JobRequest& spots, const JobRequest& wavefronts) {
  ToleranceRun result{tolerance_mm, model.tolerance_mm == tolerance_mm, 0, {}, {}};
  model.tolerance_mm = tolerance_mm;
  CompiledSystem system(model);
  for (const analysis::SurfacePlan& surface : analysis::plan_of(system.compiled(), spots).surfaces) result.steps += surface.gradient_steps.value_or(0);
  result.spots = measured(system, spots, patterns[0]);
  result.wavefronts = measured(system, wavefronts, patterns[0]);
  return result;
}

}  // namespace

Sampling sample_system(const prescription::Model& system, const SamplingRequest& request, const std::function<void(double)>& progress) {
  Sampling sampling;
  CompiledSystem compiled(system);
  sampling.findings = compiled.compiled().findings;
  if (!compiled.compiled().scene) return sampling;
  for (const scene::Wavelength& wavelength : compiled.compiled().scene->wavelengths) sampling.wavelengths_um.push_back(wavelength.wavelength_um);

  double weights = 0;
  for (const prescription::Surface& surface : system.surfaces) weights += weight_of(surface, interpolation_of(surface));
  const Prices prices(system, weights);
  const auto rays = ray_ladder(std::min(static_cast<double>(request.most_rays), std::max(static_cast<double>(least_finest_rays), request.budget / prices.of_ray)));
  std::vector<int> sizes;
  for (const int grid : grids)
    if (grid <= request.most_grid && (grid <= least_finest_grid || samples_of(grid) * prices.of_sample <= request.budget)) sizes.push_back(grid);

  // The work is known beforehand, and so the share of it that is done.
  struct Work {
    double price;
    std::function<void()> run;
  };
  std::vector<Work> work;
  const auto beyond = [&](std::vector<Run>& runs, JobRequest job, std::int64_t count, int grid) {
    work.push_back({prices.of(count, grid), [&, job] { runs.back().beyond.push_back(answers_of(compiled.run(job).results)); }});
  };
  sampling.spots.resize(std::size(patterns));
  for (std::size_t at = 0; at < std::size(patterns); ++at) {
    const char* pattern = patterns[at];
    std::vector<Run>& runs = sampling.spots[at];
    JobRequest job = job_of(request, pattern, rays.front(), 0);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      work.push_back({prices.of(rays[i], 0), [&, pattern, count = rays[i]] { runs.push_back(measured(compiled, job_of(request, pattern, count, 0), pattern)); }});
      if (i + 1 == rays.size()) break;
      for (const double place : places_between(static_cast<double>(rays[i]), static_cast<double>(rays[i + 1]), static_cast<double>(rays.back()))) {
        job.ray_count = std::llround(place);
        ++job.pattern.seed;
        beyond(runs, job, job.ray_count, 0);
      }
    }
  }
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    work.push_back({prices.of(0, sizes[i]), [&, grid = sizes[i]] { sampling.wavefronts.push_back(measured(compiled, job_of(request, patterns[0], 0, grid), "")); }});
    if (i + 1 == sizes.size()) break;
    int last = sizes[i];
    for (const double place : places_between(samples_of(sizes[i]), samples_of(sizes[i + 1]), samples_of(sizes.back()))) {
      const int grid = grid_of(place);
      if (grid > last && grid < sizes[i + 1]) beyond(sampling.wavefronts, job_of(request, patterns[0], 0, grid), 0, grid);
      last = std::max(last, grid);
    }
  }
  for (std::size_t i = 0; i < system.surfaces.size(); ++i) {
    const prescription::Surface& surface = system.surfaces[i];
    if (!surface.shape.cloud) continue;
    for (const std::string& interpolation : interpolations()) {
      const Prices others(system, weights - weight_of(surface, interpolation_of(surface)) + weight_of(surface, interpolation));
      work.push_back({others.of(rays.back(), sizes.back()), [&, i, interpolation] {
        sampling.clouds.push_back(measured_cloud(system, i, interpolation, job_of(request, patterns[0], rays.back(), 0), job_of(request, patterns[0], 0, sizes.back())));
      }});
    }
  }
  if (std::any_of(system.surfaces.begin(), system.surfaces.end(), [](const prescription::Surface& surface) { return surface.gradient.has_value(); }))
    for (const double tolerance_mm : tolerances_of(system))
      work.push_back({prices.of(tolerance_rays, tolerance_grid), [&, tolerance_mm] {
        sampling.tolerances.push_back(measured_tolerance(system, tolerance_mm, job_of(request, patterns[0], tolerance_rays, 0), job_of(request, patterns[0], 0, tolerance_grid)));
      }});
  double total = 0, done = 0;
  for (const Work& one : work) total += one.price;
  for (const Work& one : work) {
    one.run();
    done += one.price;
    progress(done / total);
  }
  return sampling;
}

}  // namespace sagitta::study
