// SPDX-License-Identifier: Apache-2.0
#include "lib/study/variant.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <new>
#include <numbers>
#include <utility>
#include <variant>
#include <vector>

#include "lib/analysis/difference.h"
#include "lib/numerics/parallel.h"
#include "lib/scene/compile.h"
#include "lib/scene/compile_cloud.h"
#include "lib/study/nearest_vertex.h"
#include "lib/study/newton.h"
#include "lib/study/through_internal.h"
#include "lib/study/variant_internal.h"
#include "lib/trace/trace.h"

namespace sagitta::study {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

// A batch of rays, in the frame of the surface before, through the surface under study.
using Through = std::function<void(trace::RayBatch&)>;

std::size_t at(int number) { return static_cast<std::size_t>(number - 1); }

// A scene, its rays at the surface under study: what both sides of a comparison have.
struct View {
  const scene::Scene& scene;
  const scene::Field& field;
  int number;
  const scene::Scene& launching;  // the system as prescribed: rays that are aimed are the same in every variant

  const scene::Wavelength& wavelength() const { return scene.primary; }
  const surface::Shape& shape() const { return scene.surface(number).shape; }
  trace::RayBatch before_surface(std::span<const trace::PupilPoint> pupil) const {
    trace::RayBatch rays = trace::launch(launching, field, launching.primary, pupil, false);
    for (int before = 1; before < number; ++before) trace::trace_surface(scene, wavelength(), before, rays);
    return rays;
  }
  void to_image(trace::RayBatch& rays) const {
    for (int behind = number + 1; behind <= scene.surface_count(); ++behind) trace::trace_surface(scene, wavelength(), behind, rays);
  }
  // Ray by ray, by crossings that the tracer does not take.
  template <class Meet>
  void pass(trace::RayBatch& rays, const Meet& meet) const {
    const auto gap = static_cast<std::size_t>(number);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const Path<double> ray = through(scene.surface(number), number, wavelength().index[gap - 1], wavelength().index[gap],
                                       Path<double>{rays.position(i), rays.direction(i), rays.ended[i]}, meet);
      rays.set(i, ray.position, ray.direction, 0);
      rays.ended[i] = ray.ended;
    }
  }
  double beam_radius() const {
    std::vector<trace::PupilPoint> pupil = trace::pupil_points({trace::PatternKind::hexapolar}, 1000);
    constexpr int rim = 360;
    for (int i = 0; i < rim; ++i) pupil.push_back({std::cos(2 * std::numbers::pi * i / rim), std::sin(2 * std::numbers::pi * i / rim)});
    trace::RayBatch rays = before_surface(pupil);
    trace::trace_surface(scene, wavelength(), number, rays);
    double radius = nan;
    for (std::size_t i = 0; i < rays.size(); ++i)
      if (rays.ended[i] == 0) radius = std::fmax(radius, std::hypot(rays.x[i], rays.y[i]));
    return radius;
  }
};

using CloudPointer = std::shared_ptr<const prescription::PointCloud>;
prescription::Shape shape_of_points(CloudPointer cloud, const Variant& variant, double spacing) {
  prescription::Shape shape;
  shape.kind = surface::Facets::kind;
  for (const numerics::Key& key : surface::Facets::keys) {
    const std::string name(key.name);
    if (key.kind == numerics::ValueKind::number) shape.parameters.numbers[name] = key.fallback;
    else if (!key.choices.empty()) shape.parameters.texts[name] = numerics::words_of(key.choices).front();
  }
  shape.parameters.numbers["shape_mm"] = variant.shape_spacings * spacing;
  shape.parameters.texts["points"] = cloud->file;
  shape.parameters.texts["interpolation"] = variant.interpolation;
  shape.cloud = std::move(cloud);
  return shape;
}

struct SurfaceTimes {
  Spread processor_ns, wall_ns;
  std::int64_t rays = 0;
  double launching_ns = 0;  // a ray, by the clock: launched and brought to the surface
};

// `batch_size` rays at a time; of a way that takes long, as many batches as `seconds` allow.
SurfaceTimes time_surface(const View& view, const Variant& variant, const Through& through, std::int64_t batch_size, double seconds) {
  const Clocked clocked = variant.threads == 1 ? Clocked::this_thread : Clocked::process;
  const std::int64_t batches = variant.threads == 1 ? 1 : 64;
  std::int64_t count = 0;
  double launching_s = 0;  // of the last run
  const auto run = [&] {
    const Times start = times_now(clocked);
    trace::PupilStream stream(variant.pattern, variant.rays);
    Times total;
    count = 0;
    for (bool has_more = true; has_more && total.wall < seconds;) {
      std::vector<trace::RayBatch> rays;
      for (std::int64_t i = 0; i < batches && has_more; ++i) {
        const std::vector<trace::PupilPoint> pupil = stream.next(batch_size);
        has_more = !pupil.empty();
        if (!has_more) break;
        rays.push_back(view.before_surface(pupil));
        count += static_cast<std::int64_t>(pupil.size());
      }
      const Times before = times_now(clocked);
      if (variant.threads == 1) {
        for (trace::RayBatch& batch : rays) through(batch);
      } else {
        numerics::share_blocks(rays.size(), variant.threads, [&] { return [&](std::size_t i) { through(rays[i]); }; });
      }
      total = total + (times_now(clocked) - before);
    }
    launching_s = (times_now(clocked) - start).wall - total.wall;
    return total;
  };
  const auto [runs, passes] = tracing_repeats(run().wall);  // the caches are warm from here on
  std::vector<double> processor, wall;
  for (int i = 0; i < runs; ++i) {
    Times total;
    for (int pass = 0; pass < passes; ++pass) total = total + run();
    const double per_ray = 1e9 / (passes * static_cast<double>(count));
    processor.push_back(total.processor * per_ray);
    wall.push_back(total.wall * per_ray);
  }
  return {spread_of(processor), spread_of(wall), count, 1e9 * launching_s / static_cast<double>(count)};
}

struct Prepared {
  scene::CompileResult compiled;
  Spread processor_s, wall_s;
};
Prepared prepare(const prescription::Model& model, int repeats) {
  Prepared result;
  std::vector<double> processor, wall;
  for (int run = 0, runs = 1; run < runs; ++run) {
    result.compiled = {};
    const Times before = times_now(Clocked::process);
    result.compiled = scene::compile(model);
    const Times taken = times_now(Clocked::process) - before;
    processor.push_back(taken.processor);
    wall.push_back(taken.wall);
    runs = preparation_repeats(wall.front(), repeats);
  }
  result.processor_s = spread_of(processor);
  result.wall_s = spread_of(wall);
  return result;
}

struct Truth {
  Noise noise;
  std::uint64_t seed = 0;
  trace::Pattern pattern;
  std::int64_t compared = 0;
  std::vector<trace::PupilPoint> pupil;
  TrueRaysResult rays;
};

// A rough cloud takes as long to make as to triangulate.
struct RoughCloud {
  Arrangement arrangement;
  Noise noise;
  std::uint64_t seed = 0;
  double radius = 0;
  CloudPointer cloud;
};

}  // namespace

std::vector<std::string> interpolations() {
  const auto& keys = surface::Facets::keys;
  const auto key = std::find_if(keys.begin(), keys.end(), [](const numerics::Key& one) { return one.name == "interpolation"; });
  return numerics::words_of(key->choices);
}

std::string first_error(const prescription::Findings& findings) {
  for (const auto& finding : findings.all())
    if (finding.severity == prescription::Severity::error) return prescription::format(finding);
  return "the system has no scene";
}

struct Subject::Parts {
  prescription::Model model;
  int number;
  std::size_t field;
  std::optional<scene::Scene> scene;  // of the system as prescribed
  std::string reason;
  double beam_radius = nan;
  std::optional<Truth> clean_truth, rough_truth;
  std::optional<RoughCloud> rough_cloud;
  std::optional<analysis::WavefrontResult> wavefront;

  View view(const scene::Scene& of) const { return {of, of.fields[field], number, *scene}; }
  double spacing(const Variant& variant) const { return spacing_of(variant.arrangement, radius(variant)); }
  double radius(const Variant& variant) const {
    const Arrangement& arrangement = variant.arrangement;
    if (variant.cloud_radius_mm > 0) return variant.cloud_radius_mm;
    if (arrangement.kind == ArrangementKind::rings && arrangement.rings > 0) return beam_radius / (1 - variant.margin_spacings / arrangement.rings);
    return beam_radius + variant.margin_spacings * spacing_of(arrangement, beam_radius);
  }
  std::optional<Roughness> roughness(const Noise& noise, std::uint64_t seed) const {
    if (!(noise.rms_um > 0)) return std::nullopt;
    return Roughness(noise.rms_um * 1e-3, noise.correlation_length_um * 1e-3, seed);
  }
  CloudPointer cloud(const Variant& variant, int thread_count = 0) {
    if (!(variant.noise.rms_um > 0)) return std::make_shared<const prescription::PointCloud>(new_cloud(variant, thread_count));
    const bool is_known = rough_cloud && rough_cloud->arrangement == variant.arrangement && rough_cloud->noise == variant.noise &&
                          rough_cloud->seed == variant.seed && rough_cloud->radius == radius(variant);
    if (is_known) return rough_cloud->cloud;
    rough_cloud.reset();
    rough_cloud = RoughCloud{variant.arrangement, variant.noise, variant.seed, radius(variant),
                             std::make_shared<const prescription::PointCloud>(new_cloud(variant, thread_count))};
    return rough_cloud->cloud;
  }
  prescription::PointCloud new_cloud(const Variant& variant, int thread_count) const {
    prescription::PointCloud result;
    result.file = fmt::format("{} points", name_of(variant.arrangement.kind));
    const auto sites = sites_over_disc(variant.arrangement, radius(variant), variant.seed);
    const auto rough = roughness(variant.noise, variant.seed);
    const std::vector<double> above = rough ? heights(*rough, sites, thread_count) : std::vector<double>(sites.size(), 0.0);
    result.points.reserve(sites.size());
    std::visit([&](const auto& shape) {
      for (std::size_t i = 0; i < sites.size(); ++i)
        result.points.push_back({sites[i].x, sites[i].y, shape.sag(sites[i].x, sites[i].y) + above[i]});
    }, scene->surface(number).shape);
    return result;
  }
  const Truth& truth_of(const Variant& variant, int thread_count = 0) {
    const Noise noise = variant.is_against_clean ? Noise{} : variant.noise;
    const bool is_rough = noise.rms_um > 0;
    std::optional<Truth>& truth = is_rough ? rough_truth : clean_truth;
    const std::int64_t compared = std::min(variant.rays, variant.most_compared);
    const bool is_known = truth && truth->pattern.kind == variant.pattern.kind && truth->pattern.seed == variant.pattern.seed && truth->compared == compared &&
                          (!is_rough || (truth->noise == noise && truth->seed == variant.seed));
    if (is_known) return *truth;
    truth = Truth{noise, variant.seed, variant.pattern, compared, trace::pupil_points(variant.pattern, compared), {}};
    const auto rough = roughness(noise, variant.seed);
    truth->rays = true_rays(*scene, scene->primary, scene->fields[field], truth->pupil,
                            {number, rough ? &*rough : nullptr, rough ? Digits::extended : Digits::fifty, thread_count});
    return *truth;
  }
};

Subject::Subject(prescription::Model system, int surface_number, std::size_t field)
    : parts_(new Parts{std::move(system), surface_number, field, {}, {}, nan, {}, {}, {}, {}}) {
  Parts& parts = *parts_;
  scene::CompileResult compiled = scene::compile(parts.model);
  if (!compiled.scene) parts.reason = first_error(compiled.findings);
  else if (!(surface_number >= 1 && surface_number <= compiled.scene->surface_count()))
    parts.reason = fmt::format("there is no surface {}: the system has 1 to {}", surface_number, compiled.scene->surface_count());
  else if (field >= compiled.scene->fields.size())
    parts.reason = fmt::format("there is no field {}: the system has 0 to {}", field, compiled.scene->fields.size() - 1);
  if (!parts.reason.empty()) return;
  parts.scene = std::move(compiled.scene);
  parts.beam_radius = parts.view(*parts.scene).beam_radius();
  if (!(parts.beam_radius > 0)) parts.reason = fmt::format("no ray comes to surface {}", surface_number);
}
Subject::~Subject() = default;
Subject::Subject(Subject&&) noexcept = default;

double Subject::beam_radius() const { return parts_->beam_radius; }

double Subject::point_count(const Variant& variant) const {
  const Arrangement& arrangement = variant.arrangement;
  if (!parts_->reason.empty() || variant.interpolation == Variant::as_prescribed) return 0;
  if (arrangement.rings > 0) return static_cast<double>(arrangement.rings) * arrangement.meridians;
  return arrangement.points_per_mm2 * std::numbers::pi * std::pow(parts_->radius(variant), 2);
}

void Subject::know_truth(const Variant& variant, int thread_count) {
  if (!parts_->reason.empty() || variant.rays < 1) return;
  try {
    parts_->truth_of(variant, thread_count);
  } catch (const std::bad_alloc&) {
    parts_->clean_truth.reset();
    parts_->rough_truth.reset();
  }
}

void Subject::know_rough_cloud(const Variant& variant, int thread_count) {
  if (!parts_->reason.empty() || variant.interpolation == Variant::as_prescribed || !(variant.noise.rms_um > 0) || point_count(variant) > most_points) return;
  try {
    parts_->cloud(variant, thread_count);
  } catch (const std::bad_alloc&) {
    parts_->rough_cloud.reset();
  }
}

prescription::PointCloud Subject::cloud_of(const Variant& variant) {
  return parts_->reason.empty() && variant.interpolation != Variant::as_prescribed ? *parts_->cloud(variant) : prescription::PointCloud{};
}

Measured Subject::measure(const Variant& variant) {
  Parts& parts = *parts_;
  if (!parts.reason.empty()) return {{}, parts.reason};
  const bool is_sampled = variant.interpolation != Variant::as_prescribed;
  const bool is_nearest = variant.search == Search::nearest_vertex, is_to_tolerance = variant.tolerance_mm > 0;
  const std::vector<std::string> known = interpolations();
  if (is_sampled && std::find(known.begin(), known.end(), variant.interpolation) == known.end())
    return {{}, fmt::format("there is no interpolation '{}': it is {} or {}", variant.interpolation, Variant::as_prescribed, fmt::join(known, ", "))};
  if (is_nearest && variant.interpolation != "linear") return {{}, "the nearest vertex is looked for on linear facets only"};
  if (is_to_tolerance && is_sampled) return {{}, "a tolerance is for surfaces as prescribed: between points nothing is iterated to one"};
  if (!(variant.rays >= 1)) return {{}, "there are no rays"};
  if (const double points = point_count(variant); points > most_points) return {{}, fmt::format("{:.3g} points are more than {:g}", points, most_points)};
  const Truth& truth = parts.truth_of(variant);
  if (!truth.rays.rays) return {{}, truth.rays.reason};

  Row row;
  prescription::Model model = parts.model;
  if (is_sampled) {
    const Times before = times_now(Clocked::process);
    CloudPointer cloud = parts.cloud(variant);
    row.sampling_s = (times_now(Clocked::process) - before).wall;
    row.cloud_radius_mm = parts.radius(variant);
    row.points = static_cast<std::int64_t>(cloud->points.size());
    row.points_per_mm2 = static_cast<double>(row.points) / (std::numbers::pi * row.cloud_radius_mm * row.cloud_radius_mm);
    model.surfaces[at(parts.number)].shape = shape_of_points(std::move(cloud), variant, parts.spacing(variant));
  }
  Prepared prepared = prepare(model, variant.prepare_repeats);
  if (!prepared.compiled.scene) return {{}, first_error(prepared.compiled.findings)};
  row.prepare_s = prepared.processor_s;
  row.prepare_wall_s = prepared.wall_s;
  scene::Scene& scene = *prepared.compiled.scene;
  scene.pupil = parts.scene->pupil;
  scene.surfaces[at(parts.number)].vertex_curvature = parts.scene->surface(parts.number).vertex_curvature;
  scene.surfaces[at(parts.number)].vertex_curvature_x = parts.scene->surface(parts.number).vertex_curvature_x;
  const View view = parts.view(scene);

  std::optional<NearestVertex> nearest;
  if (const surface::Facets* facets = scene::facets_of(scene.surfaces[at(parts.number)].shape)) {
    row.triangles = facets->mesh->facet_count;
    if (is_nearest) nearest.emplace(*facets->mesh);
  }

  std::int64_t looks = 0;
  int looks_most = 0;
  const auto way = [&](bool counts_looks) -> Through {
    if (nearest) return [&](trace::RayBatch& rays) { view.pass(rays, [&](const auto& p, const auto& d) { return nearest->meet(p, d); }); };
    if (!is_to_tolerance) return [&](trace::RayBatch& rays) { trace::trace_surface(view.scene, view.wavelength(), view.number, rays); };
    return [&, counts_looks](trace::RayBatch& rays) {
      std::visit([&](const auto& shape) {
        view.pass(rays, [&](const auto& p, const auto& d) {
          const NewtonHit hit = meet_to_tolerance(shape, p, d, variant.tolerance_mm);
          if (counts_looks) looks += hit.looks, looks_most = std::max(looks_most, hit.looks);
          return hit.crossing;
        });
      }, view.shape());
    };
  };
  const Times comparison = times_now(Clocked::process);
  trace::RayBatch rays = view.before_surface(truth.pupil);
  row.compared = static_cast<std::int64_t>(rays.size());
  way(true)(rays);
  if (is_to_tolerance) {
    row.looks_per_ray = static_cast<double>(looks) / static_cast<double>(row.compared);
    row.looks_most = looks_most;
  }
  row.surface = surface_errors(rays, truth.rays.rays->at_surface);
  view.to_image(rays);
  row.spot = spot_errors(rays, truth.rays.rays->at_image);
  row.comparing_s = (times_now(Clocked::process) - comparison).wall;

  const SurfaceTimes times = time_surface(view, variant, way(false), nearest ? 64 : 4096, nearest ? longest_search_s : std::numeric_limits<double>::infinity());
  row.rays = times.rays;
  row.threads = numerics::thread_count_of(variant.threads);
  row.launching_ns_per_ray = times.launching_ns;
  row.ns_per_ray = times.processor_ns;
  row.wall_ns_per_ray = times.wall_ns;

  if (variant.want_wavefront && !nearest && !is_to_tolerance && !(truth.noise.rms_um > 0)) {
    analysis::WavefrontRequest request;
    request.thread_count = variant.threads;
    if (!parts.wavefront) parts.wavefront = wavefront(*parts.scene, parts.scene->primary, parts.scene->fields[parts.field], request);
    const auto own = wavefront(scene, scene.primary, view.field, request);
    if (own.wavefront && parts.wavefront->wavefront) {
      const auto difference = wavefront_difference(*own.wavefront, *parts.wavefront->wavefront);
      row.wavefront_rms_waves = difference.rms_waves;
      row.wavefront_rms_without_tilt_waves = difference.rms_without_tilt_waves;
    }
  }
  return {std::move(row), {}};
}

}  // namespace sagitta::study
