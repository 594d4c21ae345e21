// SPDX-License-Identifier: Apache-2.0
// sagitta verify SYSTEM.yaml: the same rays in double and in 50 digits.
#include <fmt/core.h>

#include "lib/output/rounding_report.h"
#include "tools/commands.h"
#include "tools/job_report.h"
#include "tools/load.h"

namespace sagitta::tools {

int verify_command(const VerifyOptions& options) {
  const auto model = load_model(options.system);
  if (!model) return 1;
  const auto compiled = load_scene(*model);
  if (!compiled) return 1;
  const study::RoundingRequest request{options.ray_count, options.position_tolerance_mm, options.thread_count};
  const output::RoundingReport report{make_report(*model, *compiled), rounding_of(*compiled->scene, request), options.position_tolerance_mm, options.opd_tolerance_waves};
  fmt::print("{}", options.json ? rounding_json(report) : rounding_text(report));
  return is_good(report) ? 0 : 1;
}

}  // namespace sagitta::tools
