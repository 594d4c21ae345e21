// SPDX-License-Identifier: Apache-2.0
// A triangulated surface as flat arrays: what rays need, and nothing of how it was made. The arrays belong to somebody
// else (scene/triangulate.h) and do not change.
//
// Facets are anticlockwise in (x, y) seen from +z, do not overlap in (x, y), and are in the order of a space-filling
// curve. A uniform grid over their (x, y) lists, cell by cell, every facet whose bounding rectangle meets the cell; the
// first of a cell's list covers the cell's centre where any does: there a walk starts.
#pragma once

#include <cstdint>

#include "lib/numerics/vec3.h"

namespace sagitta::surface {

inline constexpr std::uint32_t no_facet = 0xFFFFFFFFu;

struct Facet {
  std::uint32_t corner[3];     // vertices; corner[0] is opposite to the longest edge
  std::uint32_t neighbour[3];  // across the edge opposite to corner[i]; no_facet beyond the rim and in holes
  double slope_x, slope_y;     // dz/dx and dz/dy of its plane
};

// The sphere that fits the vertices best (a plane where c = 0), q = p - centre:
//   c (q.q) - 2 (q_z - a q_x - b q_y - h) = 0                                                                      (1)
// Only a prediction of where a ray comes to the facets.
struct BaseSphere {
  numerics::Vec3<double> centre;  // of the bounding box of the vertices, mm
  double c = 0, a = 0, b = 0, h = 0;

  // The line p + t d, |d| = 1, put into (1): A t^2 - 2 B t + C = 0. Of the roots it is the one that the line crosses in
  // its own sense of travel, as for a conic (surface/conic.h, (5)). NaN: the line passes by.
  template <class T>
  T path(const numerics::Vec3<T>& p, const numerics::Vec3<T>& d) const {
    using std::sqrt;
    const numerics::Vec3<T> q = p - numerics::vec3_cast<T>(centre);
    const T A = c * dot(d, d);
    const T B = d.z - a * d.x - b * d.y - c * dot(q, d);
    const T C = c * dot(q, q) - T(2) * (q.z - a * q.x - b * q.y - h);
    const T root = sqrt(B * B - A * C);
    const T along = d.z < T(0) ? -root : root;
    const bool same_sign = d.z < T(0) ? B <= T(0) : B >= T(0);
    return (same_sign ? C : B - along) / (same_sign ? B + along : A);
  }
};

struct Mesh {
  const numerics::Vec3<double>* vertices = nullptr;
  const Facet* facets = nullptr;
  std::uint32_t vertex_count = 0, facet_count = 0;
  numerics::Vec3<double> low, high;  // bounding box of the vertices
  BaseSphere base;

  std::uint32_t columns = 0, rows = 0;         // the grid; its corner is (low.x, low.y)
  double columns_per_mm = 0, rows_per_mm = 0;
  const std::uint32_t* cell_begin = nullptr;   // columns * rows + 1, row by row: where the list of a cell begins
  const std::uint32_t* cell_facets = nullptr;  // the lists

  // The column of x, and the row of y; columns (rows) or -1 outside. Not finite is outside.
  std::int64_t column(double x) const { return slot((x - low.x) * columns_per_mm, columns); }
  std::int64_t row(double y) const { return slot((y - low.y) * rows_per_mm, rows); }

  std::size_t cell(std::int64_t column, std::int64_t row) const {
    return static_cast<std::size_t>(row) * columns + static_cast<std::size_t>(column);
  }

 private:
  // The upper end belongs to the last slot, so that every vertex has one.
  static std::int64_t slot(double position, std::uint32_t count) {
    if (!(position >= 0)) return -1;
    if (position >= count) return position <= count * (1 + 1e-12) ? std::int64_t{count} - 1 : std::int64_t{count};
    return static_cast<std::int64_t>(position);
  }
};

}  // namespace sagitta::surface
