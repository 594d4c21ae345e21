// SPDX-License-Identifier: Apache-2.0
// A triangulated surface as flat arrays: what rays need, and nothing of how it was made. The arrays belong to somebody
// else (scene/triangulate.h) and do not change.
//
// Facets are anticlockwise in (x, y) seen from +z, do not overlap in (x, y), and are in the order of a space-filling
// curve. Two ways lead from a place to a facet:
// - a grid over (x, y), about four cells a facet: each holds the facet at its middle, where a walk starts;
// - a tree of boxes for rays that no walk can settle. Since neighbours on the curve are neighbours on the surface, it
//   needs no pointers: a leaf bounds `leaf_size` facets in their order, a box above `branching` boxes in theirs.
//
// Coordinates of facets, grid and boxes are relative to `centre`, so that a cloud far from the origin keeps its digits.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "lib/numerics/vec3.h"

namespace sagitta::surface {

inline constexpr std::uint32_t no_facet = 0xFFFFFFFFu;

// What a ray needs to know of a facet, in one cache line.
//   plane    Z = z + slope_x (X - x) + slope_y (Y - y)
//   weights  w1 = u_x (X - x) + u_y (Y - y),  w2 = v_x (X - x) + v_y (Y - y),  w0 = 1 - w1 - w2
// (x, y) is corner 0 to float's precision, z the plane's height there. A weight is known to within `guard`.
struct alignas(64) Facet {
  double z, slope_x, slope_y;
  float x, y;
  float u_x, u_y, v_x, v_y;
  float guard;
  std::uint32_t neighbour[3];  // across the edge opposite to corner i; no_facet beyond the rim and in holes
};
static_assert(sizeof(Facet) == 64);

// The vertices of a facet; the first is opposite to the longest edge.
using Corners = std::array<std::uint32_t, 3>;

// The sphere that fits the vertices best (a plane where c = 0), q relative to the mesh's centre:
//   c (q.q) - 2 (q_z - a q_x - b q_y - h) = 0                                                                      (1)
// Only a prediction of where a ray comes to the facets.
struct BaseSphere {
  double c = 0, a = 0, b = 0, h = 0;

  // The line q + t d, |d| = 1, put into (1): A t^2 - 2 B t + C = 0. Of the roots it is the one that the line crosses in
  // its own sense of travel, as for a conic (surface/conic.h, (5)). NaN: the line passes by.
  template <class T>
  T path(const numerics::Vec3<T>& q, const numerics::Vec3<T>& d) const {
    using std::sqrt;
    const T A = c * dot(d, d);
    const T B = d.z - a * d.x - b * d.y - c * dot(q, d);
    const T C = c * dot(q, q) - T(2) * (q.z - a * q.x - b * q.y - h);
    const T root = sqrt(B * B - A * C);
    const T along = d.z < T(0) ? -root : root;
    const T forward_B = d.z < T(0) ? -B : B;
    return (forward_B >= T(0) ? C : B - along) / (forward_B >= T(0) ? B + along : A);
  }
};

// A box that holds facets with a margin for the rounding of everything that is asked of it.
struct Box {
  float low[3], high[3];
};

struct Grid {
  double low_x = 0, low_y = 0, columns_per_mm = 0, rows_per_mm = 0;
  std::int32_t columns = 0, rows = 0;
  const std::uint32_t* facets = nullptr;  // columns * rows, row by row; no_facet where the middle of a cell has none

  // The cell at (x, y); -1 outside the grid, or if a coordinate is not finite. The outermost cells are twice as wide
  // outward: every vertex has one, and so has a place that is predicted a little beyond the rim.
  std::int32_t cell(double x, double y) const {
    const double column = (x - low_x) * columns_per_mm, row = (y - low_y) * rows_per_mm;
    const bool inside = (column > -1) & (column < columns + 1.0) & (row > -1) & (row < rows + 1.0);
    const std::int32_t i = static_cast<std::int32_t>(inside ? column : 0), j = static_cast<std::int32_t>(inside ? row : 0);  // -0.x is 0
    const std::int32_t last_i = i < columns ? i : columns - 1, last_j = j < rows ? j : rows - 1;
    return inside ? last_j * columns + last_i : -1;
  }
  std::uint32_t facet_near(double x, double y) const {
    const std::int32_t at = cell(x, y);
    return at < 0 ? no_facet : facets[at];
  }
};

struct Mesh {
  static constexpr std::uint32_t leaf_size = 4, branching = 8;

  const numerics::Vec3<double>* vertices = nullptr;  // in the surface's frame
  const Corners* corners = nullptr;                  // of every facet
  const Facet* facets = nullptr;
  std::uint32_t vertex_count = 0, facet_count = 0;
  numerics::Vec3<double> centre;
  double extent = 0;                                 // no coordinate of a vertex is farther from the centre's
  BaseSphere base;
  Grid grid;
  const Box* boxes = nullptr;                        // the leaves' level first, the root last
  std::uint32_t box_count = 0;

  std::size_t data_bytes() const {
    const auto cells = static_cast<std::size_t>(grid.columns) * static_cast<std::size_t>(grid.rows);
    return vertex_count * sizeof *vertices + facet_count * (sizeof *corners + sizeof *facets) + cells * sizeof *grid.facets + box_count * sizeof *boxes;
  }
};

}  // namespace sagitta::surface
