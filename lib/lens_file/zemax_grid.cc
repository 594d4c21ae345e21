// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>

#include "lib/lens_file/numbers.h"
#include "lib/lens_file/zemax_surface_internal.h"
#include "lib/surface/grid.h"

namespace sagitta::lens_file {
namespace {

constexpr Real least_spacing = 1e-12L, largest_spacing = 1e12L;

bool is_count(Real value) { return value >= surface::fewest_grid_nodes && value <= surface::most_grid_nodes && value == std::floor(value); }
bool is_spacing(Real value) { return std::abs(value) >= least_spacing && std::abs(value) <= largest_spacing; }

}  // namespace

std::string grid_file_of(const ZemaxSurface& given, Real unit_mm, Report& report) {
  if (!given.grid || !given.grid->place) {
    report.left_out(given.type_place, "GRID_SAG without its heights (GDAT, GARR); its conic stands for it",
                    "the DAT file that OpticStudio took is read as it is: grid: {points: FILE.DAT, radius_mm: ...}");
    return {};
  }
  const auto& [place, layout, nodes, first_node] = *given.grid;
  if (unit_mm != 1) {
    report.left_out(*place, "GDAT in a lens whose unit is not mm: it is not known in which unit the numbers of a grid are then; its conic stands for it");
    return {};
  }
  if (layout.size() < 4 || !is_count(layout[0]) || !is_count(layout[1]) || !is_spacing(layout[2]) || !is_spacing(layout[3])) {
    report.broken(*place, fmt::format("GDAT: nx ny dx dy are needed, whole numbers from {} to {} and spacings from {:g} to {:g}", surface::fewest_grid_nodes, surface::most_grid_nodes,
                                      static_cast<double>(least_spacing), static_cast<double>(largest_spacing)));
    return {};
  }
  if (static_cast<Real>(nodes.size()) != layout[0] * layout[1]) {
    report.broken(*place, fmt::format("GDAT tells of {} x {} nodes, GARR gives {}", number_text(static_cast<double>(layout[0])), number_text(static_cast<double>(layout[1])), nodes.size()));
    return {};
  }
  std::string text = fmt::format("! By sagitta import, from line {} of a Zemax lens file on.\n", place->line);
  for (std::size_t i = 0; i < 4; ++i) text += number_text(kept(layout[i])) + " ";
  text += "0 0 0\n";
  for (const auto& node : nodes) {
    for (std::size_t i = 0; i < node.size(); ++i) text += (i == 0 ? "" : " ") + number_text(kept(node[i]));
    text += "\n";
  }
  report.warning(*place, "GARR: its rows are taken to run as those of OpticStudio's grid files do, from the largest y, each from the least x", "compare the sag at one corner with OpticStudio's");
  return text;
}

}  // namespace sagitta::lens_file
