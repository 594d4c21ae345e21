// SPDX-License-Identifier: Apache-2.0
// Format xyz: text with x, y, z in mm, in columns (cloud_table_internal.h).
//
// z `nan` or empty: a hole at (x, y). x or y `nan` or empty: no place; the line is left out and counted in a note.
#include <array>
#include <cmath>

#include "lib/prescription/cloud_table_internal.h"

namespace sagitta::prescription {
namespace {

constexpr std::array columns{Column{"x", "mm", {"x", "x_mm"}}, Column{"y", "mm", {"y", "y_mm"}}, Column{"z", "mm", {"z", "z_mm"}}};

}  // namespace

std::shared_ptr<const PointCloud> read_xyz(const CloudRequest& request, Findings& findings) {
  CloudErrors errors(request.file, findings);
  TableReader table(request.file, columns, errors);
  auto cloud = std::make_shared<PointCloud>();
  cloud->file = request.file;
  Tally without_place, holes;
  while (table.next()) {
    const double x = table.value(0), y = table.value(1), z = table.value(2);
    if (std::isnan(x) || std::isnan(y)) {
      without_place.add(table.line());
      continue;
    }
    if (std::isnan(z)) holes.add(table.line());
    cloud->points.push_back({request.osa_axes ? -x : x, y, z});
    cloud->lines.push_back(table.line());
  }
  if (errors.none() && cloud->points.empty()) errors.add(errors.at(0), "holds no points", "lines of x, y, z in mm");
  errors.finish();
  without_place.tell(errors, findings, "without a place (x or y is nan or empty)", "left out");
  holes.tell(errors, findings, "without z (nan or empty)", "holes");
  if (!errors.none()) return nullptr;
  cloud->points.shrink_to_fit();
  cloud->lines.shrink_to_fit();
  return cloud;
}

}  // namespace sagitta::prescription
