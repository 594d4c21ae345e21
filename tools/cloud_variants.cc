// SPDX-License-Identifier: Apache-2.0
#include "tools/cloud_variants.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "lib/analysis/job.h"
#include "lib/prescription/keys.h"
#include "lib/prescription/shape_reader.h"
#include "lib/scene/fit_zernike.h"
#include "lib/trace/launch.h"
#include "lib/trace/pattern.h"
#include "lib/trace/trace.h"
#include "tools/load.h"

namespace sagitta::tools {
namespace {

using prescription::Findings;
using prescription::Shape;

constexpr double margin = 1.05;
const prescription::Place on_command_line{"--with", -1, 0};

double data_radius(const prescription::PointCloud& cloud) {
  double radius = 0;
  for (const auto& point : cloud.points)
    if (!std::isnan(point.z)) radius = std::max(radius, std::hypot(point.x, point.y));
  return radius;
}

// Of points; the default first.
std::vector<std::string> interpolations() {
  const auto& kinds = prescription::shape_kinds();
  const auto shape = std::find_if(kinds.begin(), kinds.end(), [](const auto& kind) { return kind.name == "delaunay"; });
  const auto key = std::find_if(shape->keys.begin(), shape->keys.end(), [](const numerics::Key& one) { return one.name == "interpolation"; });
  return numerics::words_of(key->choices);
}

// The rays where the surface `number` leaves them.
trace::RayBatch rays_at(const scene::Scene& scene, const scene::Field& field, const scene::Wavelength& wavelength,
                        std::span<const trace::PupilPoint> pupil, int number) {
  trace::RayBatch rays = launch(scene, field, wavelength, pupil);
  for (int surface = 1; surface <= number; ++surface) trace_surface(scene, wavelength, surface, rays);
  return rays;
}

}  // namespace

ParsedVariant parse_variant(std::string text) {
  text.erase(0, std::min(text.find_first_not_of(' '), text.size()));  // "delaunay, zernike:36"
  const std::size_t colon = std::min(text.find(':'), text.size());
  const std::string kind = text.substr(0, colon), rest = text.substr(std::min(colon + 1, text.size()));
  if (kind == "delaunay") {
    const std::vector<std::string> known = interpolations();
    if (text == kind) return {VariantKind{text, known.front()}, {}};
    if (std::find(known.begin(), known.end(), rest) != known.end()) return {VariantKind{text, rest}, {}};
    return {{}, fmt::format("the interpolations are {}", fmt::join(known, ", "))};
  }
  if (kind != "zernike") return {{}, "expected delaunay, delaunay:INTERPOLATION or zernike:TERMS"};
  int terms = 0;
  const int most = scene::most_zernike_terms(numerics::ZernikeIndexing::osa);
  const auto [end, fault] = std::from_chars(rest.data(), rest.data() + rest.size(), terms);
  if (fault != std::errc{} || end != rest.data() + rest.size() || terms < 1 || terms > most)
    return {{}, fmt::format("expected zernike:TERMS with TERMS from 1 to {}, such as zernike:36", most)};
  return {VariantKind{text, {}, terms}, {}};
}

std::optional<double> footprint_radius(const prescription::Model& model, int number) {
  const auto pupil = trace::pupil_points({trace::PatternKind::hexapolar}, 2000);
  std::optional<double> radius;
  for (const scene::Beam& beam : {analysis::beam_of_job(), scene::Beam{}}) {
    const scene::CompileResult compiled = scene::compile(model, beam);  // its notes are of a surface that is not compared
    if (!compiled.scene) {
      report(prescription::in_order(compiled.findings, model.documents));
      return std::nullopt;
    }
    const scene::Scene& scene = *compiled.scene;
    radius.reset();
    bool leaves = false;
    for (const scene::Field& field : scene.fields)
      for (const scene::Wavelength& wavelength : scene.wavelengths) {
        const trace::RayBatch rays = rays_at(scene, field, wavelength, pupil, number);
        leaves = leaves || leaves_a_part(compiled.parts, count_statuses(rays));
        for (std::size_t i = 0; i < rays.size(); ++i)
          if (rays.ended[i] == 0) radius = std::max(radius.value_or(0), std::hypot(rays.x[i], rays.y[i]));
      }
    if (!leaves) break;
  }
  return radius;
}

double share_within(const scene::Scene& scene, const scene::Field& field, const scene::Wavelength& wavelength,
                    std::span<const trace::PupilPoint> pupil, int number, double radius_mm) {
  const trace::RayBatch rays = rays_at(scene, field, wavelength, pupil, number);
  std::int64_t reaching = 0, within = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (rays.ended[i] != 0 && rays.ended_at(i) != number) continue;
    ++reaching;
    const bool meets = rays.ended[i] == 0 || rays.status(i) == surface::Status::clipped || rays.status(i) == surface::Status::total_reflection;
    within += meets && std::hypot(rays.x[i], rays.y[i]) <= radius_mm;
  }
  return static_cast<double>(within) / static_cast<double>(reaching);
}

std::vector<ComparedModel> make_variants(const prescription::Model& system, const VariantRequest& request) {
  const auto has_name = [&](const prescription::Surface& one) { return one.name == request.surface; };
  const auto surface = std::find_if(system.surfaces.begin(), system.surfaces.end(), has_name);
  if (surface == system.surfaces.end() || std::count_if(surface, system.surfaces.end(), has_name) > 1) {
    std::vector<std::string> names;
    for (const auto& one : system.surfaces)
      if (!one.name.empty()) names.push_back(one.name);
    const std::string near = prescription::nearest_name(request.surface, names);
    const std::string hint = near.empty() ? fmt::format("the surfaces are: {}", fmt::join(names, ", ")) : fmt::format("did you mean '{}'?", near);
    if (surface == system.surfaces.end())
      fmt::print(stderr, "sagitta compare: --surface: no surface of {} is named '{}'\n  hint: {}\n", system.file, request.surface, hint);
    else
      fmt::print(stderr, "sagitta compare: --surface: several surfaces of {} are named '{}'\n", system.file, request.surface);
    return {};
  }
  Findings findings;
  Shape points = prescription::make_shape(
      "delaunay", {{"points", request.points}, {"format", request.format}, {"axes", request.axes}}, on_command_line, findings);
  if (!report(findings) || !points.cloud) return {};
  auto& numbers = points.parameters.numbers;
  if (surface->shape.kind == points.kind) numbers = surface->shape.parameters.numbers;
  if (request.smoothing_um) numbers["smoothing_um"] = *request.smoothing_um;
  if (request.max_edge_mm) numbers["max_edge_mm"] = *request.max_edge_mm;

  const std::size_t at = static_cast<std::size_t>(surface - system.surfaces.begin());
  std::optional<double> radius = request.radius_mm;
  const bool fits = std::any_of(request.kinds.begin(), request.kinds.end(), [](const VariantKind& kind) { return kind.terms > 0; });
  if (fits && !radius) {
    radius = footprint_radius(system, static_cast<int>(at) + 1);
    if (!radius) {
      fmt::print(stderr, "sagitta compare: no ray of {} can be traced to '{}': give the circle of the fits by --radius-mm\n", system.file, request.surface);
      return {};
    }
    radius = std::min(margin * *radius, data_radius(*points.cloud));
  }

  std::vector<ComparedModel> variants;
  for (const VariantKind& kind : request.kinds) {
    ComparedModel variant{kind.text, system, std::nullopt};
    Shape& shape = variant.model.surfaces[at].shape;
    if (kind.terms == 0) {
      shape = points;
      shape.parameters.texts["interpolation"] = kind.interpolation;
    } else {
      const auto fit = scene::fit_zernike_surface(*points.cloud, {kind.terms, *radius, numerics::ZernikeIndexing::osa});
      if (!fit.surface) {
        findings.error({points.cloud->file, 0, 0}, fmt::format("{}: {}", kind.text, fit.reason), fit.hint);
        report(findings);
        return {};
      }
      shape = zernike_shape(*fit.surface);
      shape.place = on_command_line;
      variant.fit = output::FitQuality{kind.terms, *radius, fit.surface->rms_um, static_cast<int>(at) + 1};
    }
    variants.push_back(std::move(variant));
  }
  return variants;
}

}  // namespace sagitta::tools
