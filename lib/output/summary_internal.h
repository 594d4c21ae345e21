// SPDX-License-Identifier: Apache-2.0
// What the summaries of one system and of several have in common.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "lib/output/report.h"

namespace sagitta::output {

// A number that does not exist is null: nlohmann writes NaN and infinity so, and every other number with as many digits
// as bring back its bits.
nlohmann::ordered_json report_json(const Report& report);
// {"field", "angle_deg" or "object_height_mm", "wavelength_nm"}
nlohmann::ordered_json place_json(const Report& report, const analysis::JobResult& result);
nlohmann::ordered_json plan_json(const Report& report);
std::string text_of(const nlohmann::ordered_json& json);

// OSA's Zernike coefficients of a wavefront as they are told of `report`: with an eye in the examiner's frame, where what is odd in x has the other sign.
std::vector<double> in_frame_of(const Report& report, std::vector<double> osa);
std::string osa_axes(const Report& report);  // that frame

// Five digits; "-" for a number that does not exist.
std::string significant(double value);
// A share as 100.00; "-" likewise.
std::string percent(double share);
// Why there is no wavefront, and where rays were lost: a line each, without the system's name.
std::vector<std::string> remarks(const Report& report, const analysis::JobResult& result);

}  // namespace sagitta::output
