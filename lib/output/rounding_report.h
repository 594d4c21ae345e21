// SPDX-License-Identifier: Apache-2.0
// What `sagitta verify` says: what rounding does to a system's answers, as tables and as JSON, and whether they are good.
#pragma once

#include <span>
#include <string>

#include "lib/output/report.h"
#include "lib/study/rounding.h"

namespace sagitta::output {

struct RoundingReport {
  Report system;  // without results
  study::Rounding rounding;
  double position_tolerance_mm = 0, opd_tolerance_waves = 0;
};

// Some ray arrives, every place in the image and every OPD is good to the tolerances, and no ray ends differently but on the rim of an aperture.
bool is_good(const RoundingReport& report);
// The surface of the largest share in what is not good, or that ends the last ray where none arrives, from 1; 0: none, or the launch.
int surface_to_blame(const RoundingReport& report);

std::string rounding_text(const RoundingReport& report);
// A line for each system.
std::string rounding_summary(std::span<const RoundingReport> reports);
// An object; of several systems, a list of them.
std::string rounding_json(std::span<const RoundingReport> reports);

}  // namespace sagitta::output
