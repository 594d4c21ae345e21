// SPDX-License-Identifier: Apache-2.0
#include "tools/job_report.h"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>

#include "lib/output/progress.h"
#include "lib/prescription/keys.h"
#include "tools/load.h"
#include "tools/version.h"

namespace sagitta::tools {

std::optional<analysis::JobRequest> make_request(const char* command, const JobOptions& options) {
  const auto pattern = trace::parse_pattern(options.pattern);
  if (!pattern) {
    fmt::print(stderr, "sagitta {}: --pattern {}: expected hexapolar, square, random:SEED, fan_x or fan_y\n", command, options.pattern);
    return std::nullopt;
  }
  analysis::JobRequest request;
  request.pattern = *pattern;
  request.ray_count = options.ray_count;
  request.thread_count = options.thread_count;
  return request;
}

bool wants(const std::vector<std::string>& only, const char* output) {
  return only.empty() || std::find(only.begin(), only.end(), output) != only.end();
}

output::Report make_report(const prescription::Model& model, const scene::CompileResult& compiled) {
  output::Report report;
  report.system = model.name.empty() ? std::filesystem::path(model.file).stem().string() : model.name;
  report.version = version();
  for (const auto& [name, value] : model.parameters) report.parameters.emplace_back(name, value);
  report.eye = model.eye;
  report.fields_are_heights = model.fields.kind == prescription::FieldKind::object_heights_mm;
  for (const auto& field : model.fields.points) report.fields.push_back({field.x, field.y});
  if (!model.fields.given_points.empty()) {
    const std::string_view plural = prescription::field_keys[static_cast<std::size_t>(model.fields.given_kind)].name;  // "real_image_heights_mm"
    const std::size_t unit = plural.rfind('_');
    report.given_field = std::string(plural.substr(0, unit - 1)) + std::string(plural.substr(unit));
    for (const auto& field : model.fields.given_points) report.given_fields.push_back({field.x, field.y});
  }
  report.wavelengths_nm = model.wavelengths_nm;
  report.pupil_is_of_stop = model.aperture.is_of_stop;
  for (const auto& surface : model.surfaces) {
    report.surface_names.push_back(surface.name);
    const auto& texts = surface.shape.parameters.texts;
    const auto interpolation = texts.find("interpolation");
    if (interpolation != texts.end() && interpolation->second == "linear")
      report.surfaces_of_flat_facets.push_back(static_cast<int>(report.surface_names.size()));
  }
  report.first_order = compiled.first_order;
  report.first_order_x = compiled.first_order_x;
  report.smoothing = compiled.smoothing;
  report.parts = compiled.parts;
  return report;
}

bool leaves_a_part(const output::Report& report) {
  return std::any_of(report.results.begin(), report.results.end(), [&](const analysis::JobResult& result) {
    return leaves_a_part(report.parts, result.rays) || (result.wavefront && leaves_a_part(report.parts, result.wavefront->rays));
  });
}

std::vector<std::vector<analysis::JobResult>> run_with_progress(std::span<const scene::Scene> scenes, const analysis::JobRequest& request) {
  constexpr std::uint64_t steps = 1000;
  output::Progress line("tracing", steps);
  std::uint64_t shown = 0;
  return analysis::run_jobs(scenes, request, [&](double share) {
    const auto reached = static_cast<std::uint64_t>(share * steps);
    line.advance(reached - shown);
    shown = reached;
  });
}

}  // namespace sagitta::tools
