// SPDX-License-Identifier: Apache-2.0
// What `sagitta materials` says of media, as tables, JSON and chart. Plain numbers and texts in. A number that does not exist is NaN: "-" in
// tables, null in JSON.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "lib/output/chart.h"

namespace sagitta::output {

struct MediumValue {
  std::string line;  // of the spectrum, "" for another wavelength
  double wavelength_nm = 0, index = 0;
  double slope_per_um = std::numeric_limits<double>::quiet_NaN();  // dn/dL
  double group_index = std::numeric_limits<double>::quiet_NaN();
};

struct MediumReport {
  std::string name, from, file;               // from: the catalogue or folder, in short
  std::string kind, comments, references;     // kind: of the dispersion
  bool is_table = false;                      // measured at the points of its curve, and a straight line between them
  bool has_range = true;                      // false: meant for any wavelength
  double shortest_nm = 0, longest_nm = 0;
  double nd = 0, vd = 0, ne = 0, ve = 0;      // index and Abbe number at the lines d and e
  std::vector<MediumValue> values;
};

// A line a medium.
std::string media_list_text(const std::vector<MediumReport>& media);
std::string media_list_json(const std::vector<MediumReport>& media, const std::string& version);

// Each with its values.
std::string media_text(const std::vector<MediumReport>& media);
std::string media_json(const std::vector<MediumReport>& media, const std::string& version);

// Index against wavelength: curves[i], of media[i], not empty, as a line; markers are at the values that are not of spectral lines; where
// there are none, at the measured points of a table, and of others at a few places of the curve.
Chart media_chart(const std::vector<MediumReport>& media, const std::vector<std::vector<ChartPoint>>& curves, const std::string& version);

}  // namespace sagitta::output
