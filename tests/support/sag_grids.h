// SPDX-License-Identifier: Apache-2.0
// Grids of heights for tests, from functions.
#pragma once

#include <cmath>
#include <limits>
#include <utility>

#include "lib/scene/compile_grid.h"

namespace sagitta::tests {

using prescription::SagGrid;

struct GridLayout {
  int count_x, count_y;
  double spacing_x, spacing_y, middle_x = 0, middle_y = 0;
};

// node_of(x, y): z with its slopes and twist.
template <class NodeOf>
SagGrid sag_grid(const GridLayout& of, const NodeOf& node_of) {
  SagGrid grid{.file = "grid", .count_x = of.count_x, .count_y = of.count_y, .first_x = of.middle_x - of.spacing_x * (of.count_x - 1) / 2,
               .first_y = of.middle_y - of.spacing_y * (of.count_y - 1) / 2, .spacing_x = of.spacing_x, .spacing_y = of.spacing_y, .nodes = {}};
  for (int j = 0; j < of.count_y; ++j)
    for (int i = 0; i < of.count_x; ++i) grid.nodes.push_back(node_of(grid.first_x + i * of.spacing_x, grid.first_y + j * of.spacing_y));
  return grid;
}
// The same with heights alone.
inline SagGrid without_slopes(SagGrid grid) {
  for (SagGrid::Node& node : grid.nodes) node = {node.z, 0, 0, 0};
  grid.has_given_slopes = false;
  return grid;
}
inline SagGrid with_hole(SagGrid grid, int i, int j) {
  grid.nodes[static_cast<std::size_t>(j * grid.count_x + i)] = {std::numeric_limits<double>::quiet_NaN(), 0, 0, 0};
  return grid;
}

// r^2 = x^2 + y^2, z of a sphere.
inline SagGrid::Node of_sphere(double radius, double x, double y) {
  const double c = 1 / radius, root = std::sqrt(1 - c * c * (x * x + y * y));
  return {c * (x * x + y * y) / (1 + root), c * x / root, c * y / root, c * c * c * x * y / (root * root * root)};
}
// Waves with a dimple, 0 at the origin.
inline SagGrid::Node of_waves(double size, double x, double y) {
  const double dimple = size * (std::cos(x) - 1), dimple_x = -size * std::sin(x);
  return {dimple * std::cos(.7 * y) + size * .5 * std::sin(y), dimple_x * std::cos(.7 * y), -.7 * dimple * std::sin(.7 * y) + size * .5 * std::cos(y),
          -.7 * dimple_x * std::sin(.7 * y)};
}

inline surface::BicubicGrid grid_on(const SagGrid& grid, numerics::Arena& arena, const surface::Conic& base = {}) { return scene::grid_surface(grid, base, arena); }

}  // namespace sagitta::tests
