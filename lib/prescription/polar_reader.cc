// SPDX-License-Identifier: Apache-2.0
// Format polar: text with ring number, meridian in degrees, radius in mm and elevation z in mm, in columns
// (cloud_table_internal.h). A topographer's frame: the angle from x to the examiner's right, anticlockwise, z out of the
// eye; it is converted (ring_places_internal.h).
//
// z `nan`, empty, -1000, or -1 written just so: a hole. So too where the radius is missing (`nan`, empty, -1 or -1000);
// its place then follows from its neighbours on ring and meridian. Ring or meridian `nan` or empty: no place; the line is
// left out and counted in a note. An apex may be given as ring 0, radius 0, on one meridian or on all: one place.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "lib/prescription/cloud_table_internal.h"
#include "lib/prescription/ring_places_internal.h"

namespace sagitta::prescription {
namespace {

enum : std::size_t { ring_column, meridian_column, radius_column, z_column };
constexpr std::array columns{Column{"ring", "whole steps", {"ring"}},
                             Column{"meridian", "degrees", {"meridian", "meridian_deg", "angle_deg"}},
                             Column{"radius", "mm", {"radius", "radius_mm"}}, Column{"z", "mm", {"z", "z_mm"}}};

}  // namespace

std::shared_ptr<const PointCloud> read_polar(const CloudRequest& request, Findings& findings) {
  CloudErrors errors(request.file, findings);
  TableReader table(request.file, columns, errors);
  std::vector<RingSample> samples;
  std::vector<double> elevations;
  std::vector<std::uint32_t> lines;
  Tally without_place, holes;
  // A height can be -1 mm, but then it has its decimals; no radius is negative, and no height is a metre.
  const auto value_or_missing = [&](std::size_t column) {
    const double value = table.value(column);
    const bool is_missing = value == -1000 || (value == -1 && (column == radius_column || is_missing_marker(table.text(column))));
    return is_missing ? std::numeric_limits<double>::quiet_NaN() : value;
  };
  while (table.next()) {
    const double ring = table.value(ring_column), meridian_deg = table.value(meridian_column);
    const double radius = value_or_missing(radius_column), z = value_or_missing(z_column);
    const auto refuse = [&](std::size_t column, const char* what, const char* hint) {
      errors.add(table.place_of(column), fmt::format("{}: {}", what, quoted(table.text(column))), hint);
    };
    if (std::isnan(ring) || std::isnan(meridian_deg)) {
      without_place.add(table.line());
    } else if (!(ring >= 0) || ring != std::floor(ring)) {
      refuse(ring_column, "the ring is no whole number from 0", "rings count outward");
    } else if (radius < 0) {
      refuse(radius_column, "the radius is negative", "a missing sample is nan, -1 or -1000");
    } else {
      const bool is_hole = std::isnan(radius) || std::isnan(z);
      if (is_hole) holes.add(table.line());
      samples.push_back({ring, meridian_deg, radius});
      elevations.push_back(is_hole ? std::numeric_limits<double>::quiet_NaN() : z);
      lines.push_back(table.line());
    }
  }
  if (errors.none() && samples.empty()) errors.add(errors.at(0), "holds no points", "lines of ring, meridian in degrees, radius and z in mm");
  if (errors.none() && holes.count == samples.size()) errors.add(errors.at(0), "every sample is missing");
  errors.finish();
  without_place.tell(errors, findings, "without a place (ring or meridian is nan or empty)", "left out");
  if (!errors.none()) return nullptr;
  holes.tell(errors, findings, "without radius or z (nan, empty, -1 or -1000)", "holes");

  auto cloud = std::make_shared<PointCloud>();
  cloud->file = request.file;
  cloud->points.reserve(samples.size());
  cloud->lines.reserve(samples.size());
  const std::vector<double> radius = places_of(samples);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (std::isnan(radius[i])) continue;
    cloud->points.push_back(in_eye_frame(radius[i], samples[i].meridian_deg, elevations[i]));
    cloud->lines.push_back(lines[i]);
  }
  return cloud;
}

}  // namespace sagitta::prescription
