// SPDX-License-Identifier: Apache-2.0
// From compiled systems to their reports: what `trace` and `compare` do alike.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lib/analysis/job.h"
#include "lib/output/report.h"
#include "lib/prescription/model.h"
#include "lib/scene/compile.h"
#include "tools/commands.h"

namespace sagitta::tools {

// None, after saying so, where there is no such pattern.
std::optional<analysis::JobRequest> make_request(const char* command, const JobOptions& options);

// Whether an output is among those of --only, which are all where there are none.
bool wants(const std::vector<std::string>& only, const char* output);

// A report without results.
output::Report make_report(const prescription::Model& model, const scene::CompileResult& compiled);

// Whether a ray left what was triangulated (tools/load.h).
bool leaves_a_part(const output::Report& report);

// The job, with a line of progress on a terminal.
std::vector<std::vector<analysis::JobResult>> run_with_progress(std::span<const scene::Scene> scenes, const analysis::JobRequest& request);

}  // namespace sagitta::tools
