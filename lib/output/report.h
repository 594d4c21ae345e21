// SPDX-License-Identifier: Apache-2.0
// What `sagitta trace` says, and `compare` of each system: the results of a job as JSON, table, EXR parts and figures.
//
// Part names: spot.fieldI.NMnm and wavefront.fieldI.NMnm, I from 0, NM the wavelength as in the prescription. Channels:
// Y (ray counts; OPD in waves, NaN where there is none) and wavefront.mask (0 to 5: the ray's status in the order of the
// contract; 255: outside the pupil). Attributes are named in README.md.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lib/analysis/job.h"
#include "lib/analysis/plan.h"
#include "lib/output/exr.h"
#include "lib/output/figure.h"
#include "lib/output/table.h"
#include "lib/scene/first_order.h"
#include "lib/scene/footprint.h"
#include "lib/scene/smooth.h"

namespace sagitta::output {

struct Report {
  std::string system, version;
  std::vector<std::pair<std::string, double>> parameters;  // of the system, as they were set
  std::string eye;  // "right", "left"; "": not said, or not an eye
  bool fields_are_heights = false;
  std::vector<std::array<double, 2>> fields;  // degrees, or mm
  std::string given_field;                    // where they were given as another quantity: its name with its unit, "real_image_height_mm"
  std::vector<std::array<double, 2>> given_fields;
  std::vector<double> wavelengths_nm;
  bool pupil_is_of_stop = false;              // aim: stop
  std::vector<std::string> surface_names;     // [0] of surface 1
  std::vector<int> surfaces_of_flat_facets;   // their numbers: wavefronts behind one are of no use, which is said
  scene::FirstOrder first_order;              // at the primary wavelength
  std::optional<scene::FirstOrder> first_order_x;  // of the x-z section, where that is another
  std::map<int, scene::Smoothing> smoothing;  // by the number of the surface
  std::vector<scene::CloudPart> parts;        // of clouds, that were enough for the rays
  std::optional<analysis::Plan> plan;         // of the job
  std::vector<analysis::JobResult> results;
};

std::string summary_json(const Report& report);
std::string summary_text(const Report& report);

// What `sagitta explain` says: the plan of a report that has one.
std::string explanation_json(const Report& report);
std::string explanation_text(const Report& report);

std::vector<ExrPart> spot_parts(const Report& report);
std::vector<ExrPart> wavefront_parts(const Report& report);
Figure spot_figure(const Report& report);
Figure wavefront_figure(const Report& report);

}  // namespace sagitta::output
