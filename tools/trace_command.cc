// SPDX-License-Identifier: Apache-2.0
// sagitta trace SYSTEM.yaml -o DIR: the main job, end to end.
#include <fmt/core.h>

#include <algorithm>
#include <filesystem>

#include "lib/analysis/job.h"
#include "lib/numerics/parallel.h"
#include "lib/output/atomic_file.h"
#include "lib/output/report.h"
#include "tools/commands.h"
#include "tools/job_report.h"
#include "tools/load.h"
#include "tools/pictures.h"
#include "tools/write.h"

namespace sagitta::tools {
int trace_command(const TraceOptions& options) {
  auto request = make_request("trace", options);
  if (!request) return 2;
  const auto model = load_model(options.system, options.settings);
  if (!model) return model.status;
  pictures("trace");
  const std::filesystem::path folder(options.folder);
  request->want_spot = wants(options.only, "spot");
  request->want_wavefront = wants(options.only, "wavefront");
  output::Report report;
  for (const scene::Beam& beam : {analysis::beam_of_job(), scene::Beam{}}) {
    const auto compiled = load_scene(*model, beam);
    if (!compiled) return 1;
    if (!make_folder("trace", folder)) return 1;
    report = make_report(*model, *compiled);
    report.plan = analysis::plan_of(*compiled, *request);
    report.results = std::move(run_with_progress({&*compiled->scene, 1}, *request).front());
    if (!leaves_a_part(report)) break;
  }

  bool spots_are_written = true, wavefronts_are_written = true;
  numerics::do_both(
      options.thread_count,
      [&] {
        if (request->want_spot)
          spots_are_written = write_image("trace", folder / "spot", spot_parts(report), spot_figure(report), options.thread_count);
      },
      [&] {
        if (request->want_wavefront)
          wavefronts_are_written = write_image("trace", folder / "wavefront", wavefront_parts(report), wavefront_figure(report), options.thread_count);
      });
  bool all_written = spots_are_written && wavefronts_are_written;
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
