// SPDX-License-Identifier: Apache-2.0
// sagitta explain SYSTEM.yaml: what `trace` would do, and what it leaves out. Nothing is traced but the rays that tell it.
#include <fmt/core.h>

#include "lib/analysis/plan.h"
#include "lib/output/report.h"
#include "tools/commands.h"
#include "tools/job_report.h"
#include "tools/load.h"

namespace sagitta::tools {

int explain_command(const ExplainOptions& options) {
  const auto model = load_model(options.system, options.settings);
  if (!model) return model.status;
  const auto compiled = load_scene(*model, analysis::beam_of_job());
  if (!compiled) return 1;
  analysis::JobRequest request;
  request.ray_count = options.ray_count;
  request.want_spot = wants(options.only, "spot");
  request.want_wavefront = wants(options.only, "wavefront");
  output::Report report = make_report(*model, *compiled);
  report.plan = analysis::plan_of(*compiled, request);
  fmt::print("{}", options.json ? explanation_json(report) : explanation_text(report));
  return 0;
}

}  // namespace sagitta::tools
