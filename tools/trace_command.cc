// SPDX-License-Identifier: Apache-2.0
// sagitta trace SYSTEM.yaml -o DIR: the main job, end to end.
#include <fmt/core.h>

#include <algorithm>
#include <filesystem>

#include "lib/analysis/job.h"
#include "lib/output/atomic_file.h"
#include "lib/output/progress.h"
#include "lib/output/report.h"
#include "tools/commands.h"
#include "tools/load.h"
#include "tools/write.h"

namespace sagitta::tools {
namespace {

bool wants(const TraceOptions& options, const char* output) {
  return options.only.empty() || std::find(options.only.begin(), options.only.end(), output) != options.only.end();
}

output::Report make_report(const prescription::Model& model, const scene::CompileResult& compiled) {
  output::Report report;
  report.system = model.name.empty() ? std::filesystem::path(model.file).stem().string() : model.name;
  report.version = SAGITTA_VERSION;
  report.fields_are_heights = model.fields.kind == prescription::FieldKind::object_heights_mm;
  for (const auto& field : model.fields.points) report.fields.push_back({field.x, field.y});
  report.wavelengths_nm = model.wavelengths_nm;
  for (const auto& surface : model.surfaces) report.surface_names.push_back(surface.name);
  report.first_order = compiled.first_order;
  return report;
}

}  // namespace

int trace_command(const TraceOptions& options) {
  const auto pattern = trace::parse_pattern(options.pattern);
  if (!pattern) {
    fmt::print(stderr, "sagitta trace: --pattern {}: expected hexapolar, square, random:SEED, fan_x or fan_y\n", options.pattern);
    return 2;
  }
  const auto model = load_model(options.system);
  if (!model) return 1;
  const auto compiled = load_scene(*model);
  if (!compiled) return 1;

  const std::filesystem::path folder(options.folder);
  if (!make_folder("trace", folder)) return 1;

  analysis::JobRequest request;
  request.want_spot = wants(options, "spot");
  request.want_wavefront = wants(options, "wavefront");
  request.pattern = *pattern;
  request.ray_count = options.ray_count;
  request.thread_count = options.thread_count;
  output::Report report = make_report(*model, *compiled);
  {
    constexpr std::uint64_t steps = 1000;
    output::Progress line("tracing", steps);
    std::uint64_t shown = 0;
    report.results = analysis::run_job(*compiled->scene, request, [&](double share) {
      const auto reached = static_cast<std::uint64_t>(share * steps);
      line.advance(reached - shown);
      shown = reached;
    });
  }

  bool all_written = true;
  if (request.want_spot) all_written &= write_image("trace", folder / "spot", spot_parts(report), spot_figure(report));
  if (request.want_wavefront) all_written &= write_image("trace", folder / "wavefront", wavefront_parts(report), wavefront_figure(report));
  const std::string summary = summary_json(report);
  all_written &= written("trace", output::write_file((folder / "summary.json").string(), summary));
  fmt::print("{}", options.json ? summary : summary_text(report));
  if (!all_written) return 1;

  const bool any_arrived = std::any_of(report.results.begin(), report.results.end(),
                                       [](const auto& result) { return result.rays[surface::Status::ok] > 0; });
  if (!any_arrived) fmt::print(stderr, "sagitta trace: not one ray arrived at the image surface\n");
  return any_arrived ? 0 : 1;
}

}  // namespace sagitta::tools
