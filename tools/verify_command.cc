// SPDX-License-Identifier: Apache-2.0
// sagitta verify SYSTEM.yaml ...: the same rays in double and in 50 digits.
#include <fmt/core.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "lib/output/rounding_report.h"
#include "tools/commands.h"
#include "tools/job_report.h"
#include "tools/load.h"

namespace sagitta::tools {

int verify_command(const VerifyOptions& options) {
  const study::RoundingRequest request{options.ray_count, options.position_tolerance_mm, options.thread_count};
  std::vector<std::pair<prescription::Model, scene::CompileResult>> systems;  // all are right before the first is looked at
  for (const std::string& system : options.systems) {
    auto model = load_model(system);
    if (!model) return 1;
    auto compiled = load_scene(*model);
    if (!compiled) return 1;
    systems.emplace_back(std::move(*model), std::move(*compiled));
  }
  std::vector<output::RoundingReport> reports;
  for (const auto& [model, compiled] : systems)
    reports.push_back({make_report(model, compiled), rounding_of(*compiled.scene, request), options.position_tolerance_mm, options.opd_tolerance_waves});
  if (options.json) fmt::print("{}", rounding_json(reports));
  else fmt::print("{}", reports.size() == 1 ? rounding_text(reports.front()) : rounding_summary(reports));
  return std::all_of(reports.begin(), reports.end(), output::is_good) ? 0 : 1;
}

}  // namespace sagitta::tools
