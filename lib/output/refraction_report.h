// SPDX-License-Identifier: Apache-2.0
// What `sagitta refraction` says: the refraction of an eye by every field and wavelength, as a table, as JSON and as a chart.
#pragma once

#include <string>
#include <vector>

#include "lib/analysis/refraction.h"
#include "lib/output/chart.h"
#include "lib/output/report.h"

namespace sagitta::output {

struct RefractionReport {
  Report system;  // without results
  double vertex_distance_mm = 0;
  bool is_eye = true;  // false: the image is in air, and is taken for a retina
  std::vector<analysis::RefractionResult> results;  // by field, then wavelength
};

std::string refraction_text(const RefractionReport& report);
std::string refraction_json(const RefractionReport& report);
// M against the wavelength: of one field by least squares and the paraxial one, of several the paraxial one. Its slope is the longitudinal chromatic aberration.
Chart refraction_chart(const RefractionReport& report);

}  // namespace sagitta::output
