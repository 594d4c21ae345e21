// SPDX-License-Identifier: Apache-2.0
// What the reports of one system and of several have in common: names and attributes of parts, and panels.
#pragma once

#include <string>
#include <vector>

#include "lib/output/report.h"

namespace sagitta::output {

std::string part_name(const Report& report, const analysis::JobResult& result, const char* quantity);
std::string panel_title(const Report& report, const analysis::JobResult& result);

// Attributes of every part.
std::vector<ExrAttribute> common_attributes(const Report& report, const analysis::JobResult& result, const trace::StatusCounts& rays);
// Attributes of a map of `size` x `size` points over the pupil.
std::vector<ExrAttribute> pupil_map_attributes(const Report& report, int size);

Panel spot_panel(const Report& report, const analysis::JobResult& result);
Panel wavefront_panel(const Report& report, const analysis::JobResult& result);
// An OPD map over the pupil, with its axes and colours; an empty map has `empty_note` in its place.
Panel pupil_panel(const Report& report, int size, const std::vector<double>& opd_waves, const std::string& empty_note);

// Of an eye: the frame of spots, pictures and maps.
inline constexpr const char* tracers_frame = "x to the examiner's left, y up";
// "right eye, x to the examiner's left, y up; sagitta 0.1.0"; without eyes "sagitta 0.1.0".
std::string pictures_footer(const std::string& eyes, const std::string& version);
// "surface 1 cornea: flat facets (interpolation: linear) are unusable for "; "" where no facets are flat.
std::string flat_facets(const Report& report);

// "" where wavefronts are to be trusted, or none are there.
std::string facets_note(const Report& report);

template <class Value>
std::vector<float> floats(const std::vector<Value>& values) {
  return std::vector<float>(values.begin(), values.end());
}

}  // namespace sagitta::output
