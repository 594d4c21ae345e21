// SPDX-License-Identifier: Apache-2.0
#include "lib/prescription/grid_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "lib/prescription/grid_formats_internal.h"

namespace sagitta::prescription {
namespace {

struct Format {
  std::string_view name;
  std::shared_ptr<SagGrid> (*read)(const GridRequest&, CloudErrors&, Findings&);
};

// The closed list of formats; the first is the default.
constexpr std::array formats{Format{"zemax", read_zemax_grid}, Format{"xyz", read_xyz_grid}};

// Whether any cell has data at its four corners.
bool has_a_cell(const SagGrid& grid) {
  const auto row = static_cast<std::size_t>(grid.count_x);
  const auto has_data = [&](std::size_t node) { return !std::isnan(grid.nodes[node].z); };
  for (std::size_t node = 0; node + row + 1 < grid.nodes.size(); ++node)
    if ((node + 1) % row != 0 && has_data(node) && has_data(node + 1) && has_data(node + row) && has_data(node + row + 1)) return true;
  return false;
}

}  // namespace

std::string_view grid_formats() {
  static const std::string names = [] {
    std::string joined;
    for (const Format& format : formats) joined += fmt::format("{}{}", joined.empty() ? "" : "|", format.name);
    return joined;
  }();
  return names;
}

std::shared_ptr<const SagGrid> read_grid(const GridRequest& request, Findings& findings) {
  const auto format = std::find_if(formats.begin(), formats.end(), [&](const Format& one) { return one.name == request.format; });
  CloudErrors errors(request.file, findings);
  if (format == formats.end()) {
    errors.add(errors.at(0), fmt::format("{} is no format of grids", quoted(request.format)), fmt::format("one of {}", grid_formats()));
    return nullptr;
  }
  auto grid = format->read(request, errors, findings);
  if (errors.none() && !has_a_cell(*grid)) errors.add(errors.at(0), "no cell of the grid has data at its four corners");
  errors.finish();
  if (!errors.none()) return nullptr;
  grid->file = request.file;
  return grid;
}

}  // namespace sagitta::prescription
