// SPDX-License-Identifier: Apache-2.0
// Format xyz of a grid: text with x, y, z in mm, in columns (cloud_table_internal.h), in any order, of points on a regular grid.
//
// Along x and y there are as many places as differ by more than 5e-6 of the whole width, and each point lies within a thousandth of a spacing of its own.
// z `nan` or empty, or no line: nothing is known there. x or y `nan` or empty: the line is left out and counted in a note.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "lib/prescription/cloud_table_internal.h"
#include "lib/prescription/grid_formats_internal.h"
#include "lib/surface/grid.h"

namespace sagitta::prescription {
namespace {

constexpr std::array columns{Column{"x", "mm", {"x", "x_mm"}}, Column{"y", "mm", {"y", "y_mm"}}, Column{"z", "mm", {"z", "z_mm"}}};
constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

struct Point {
  double x, y, z;
  std::uint32_t line;
};

// Equidistant places.
struct Places {
  std::size_t count = 0;
  double first = 0, spacing = 0;

  Places(const std::vector<Point>& points, double Point::*coordinate) {
    std::vector<double> sorted;
    for (const Point& point : points) sorted.push_back(point.*coordinate);
    std::sort(sorted.begin(), sorted.end());
    const double width = sorted.back() - sorted.front(), apart = width * 0.5 / surface::most_grid_nodes;
    count = 1;
    for (std::size_t k = 1; k < sorted.size(); ++k) count += sorted[k] - sorted[k - 1] > apart;
    first = sorted.front(), spacing = count > 1 ? width / static_cast<double>(count - 1) : 0;
  }
  // Where it belongs; as many as there are where it lies beside all of them.
  std::size_t of(double value) const {
    const double at = (value - first) / spacing, nearest = std::round(at);
    return std::abs(at - nearest) <= 1e-3 ? static_cast<std::size_t>(nearest) : count;
  }
};

}  // namespace

std::shared_ptr<SagGrid> read_xyz_grid(const GridRequest& request, CloudErrors& errors, Findings& findings) {
  TableReader table(request.file, columns, errors);
  auto grid = std::make_shared<SagGrid>();
  std::vector<Point> points;
  Tally without_place;
  while (table.next()) {
    const Point point{table.value(0), table.value(1), table.value(2), table.line()};
    if (std::isnan(point.x) || std::isnan(point.y)) without_place.add(table.line());
    else if (std::max(std::abs(point.x), std::abs(point.y)) > largest_grid_length || std::abs(point.z) > largest_grid_value)
      errors.add(errors.at(table.line()), fmt::format("x and y go to {:g} mm, z to {:g}", largest_grid_length, largest_grid_value));
    else points.push_back(point);
  }
  without_place.tell(errors, findings, "without a place (x or y is nan or empty)", "left out");
  if (errors.none() && points.empty()) errors.add(errors.at(0), "holds no points", "lines of x, y, z in mm");
  if (!errors.none()) return grid;

  const Places x(points, &Point::x), y(points, &Point::y);
  const auto is_count = [](std::size_t count) { return count >= surface::fewest_grid_nodes && count <= surface::most_grid_nodes; };
  const bool is_sparse = static_cast<double>(x.count) * static_cast<double>(y.count) > 10 * static_cast<double>(points.size());
  if (!is_count(x.count) || !is_count(y.count) || is_sparse || x.spacing < smallest_grid_length || y.spacing < smallest_grid_length) {
    errors.add(errors.at(0), fmt::format("{} points with {} different x and {} different y are no regular grid", points.size(), x.count, y.count),
               fmt::format("a grid has from {} to {} of each; delaunay takes points that lie anywhere", surface::fewest_grid_nodes, surface::most_grid_nodes));
    return grid;
  }
  grid->count_x = static_cast<int>(x.count), grid->count_y = static_cast<int>(y.count);
  grid->first_x = x.first, grid->first_y = y.first, grid->spacing_x = x.spacing, grid->spacing_y = y.spacing;
  grid->has_given_slopes = false;
  grid->nodes.assign(x.count * y.count, {unknown, 0, 0, 0});
  std::vector<std::uint32_t> lines(grid->nodes.size(), 0);
  for (const Point& point : points) {
    const std::size_t i = x.of(point.x), j = y.of(point.y);
    if (i == x.count || j == y.count) {
      errors.add(errors.at(point.line), fmt::format("({:g}, {:g}) lies on no node of a grid of {} x {}", point.x, point.y, x.count, y.count),
                 "delaunay takes points that lie anywhere");
      continue;
    }
    std::uint32_t& line = lines[j * x.count + i];
    if (line != 0) errors.add(errors.at(point.line), fmt::format("a second point at ({:g}, {:g})", point.x, point.y), fmt::format("the first is in line {}", line));
    line = point.line;
    grid->nodes[j * x.count + i].z = point.z;
  }
  const auto missing = std::count_if(grid->nodes.begin(), grid->nodes.end(), [](const SagGrid::Node& node) { return std::isnan(node.z); });
  if (missing > 0) findings.note(errors.at(0), fmt::format("{} of {} nodes have no z: cells around them are holes", missing, grid->nodes.size()));
  return grid;
}

}  // namespace sagitta::prescription
