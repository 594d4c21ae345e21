// SPDX-License-Identifier: Apache-2.0
// The two ways from a place to a facet (surface/mesh.h): the grid and the tree of boxes.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "lib/scene/mesh_internal.h"

namespace sagitta::scene {
namespace {

using numerics::Vec3;
using surface::Box;
using surface::Mesh;
using surface::no_facet;

constexpr double cells_per_facet = 4;

// The corners of a facet, relative to the mesh's centre.
std::array<Vec3<double>, 3> triangle(const Mesh& mesh, std::uint32_t facet) {
  const surface::Corners& corners = mesh.corners[facet];
  return {mesh.vertices[corners[0]] - mesh.centre, mesh.vertices[corners[1]] - mesh.centre, mesh.vertices[corners[2]] - mesh.centre};
}

struct Span {
  double low, high;
};
Span span_of(double a, double b, double c) {
  const double low = a < b ? a : b, high = a > b ? a : b;
  return {low < c ? low : c, high > c ? high : c};
}

// The cells whose middles lie in the triangle, row by row: beyond those edges that go down, before those that go up, the
// corners being anticlockwise. Every edge is taken from its lower end, so that a cell on it goes to one of its facets.
// Without branches, which nothing could predict. take(row, first, last)
template <class Take>
void for_each_row(const surface::Grid& grid, const std::array<Vec3<double>, 3>& corner, Take&& take) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  // The least cell with its middle there or beyond. Corners lie between -1/2 and the count - 1/2, and so do all places on
  // edges; corners that are not in one row are at least 2^-54 apart, so that no slope is infinite.
  const auto next_above = [](double position) {
    const auto whole = static_cast<std::int32_t>(position);
    return whole + (whole < position);
  };
  double x[3], y[3];  // in cells, from the middle of the first one
  for (std::size_t i = 0; i < 3; ++i) {
    x[i] = (corner[i].x - grid.low_x) * grid.columns_per_mm - 0.5;
    y[i] = (corner[i].y - grid.low_y) * grid.rows_per_mm - 0.5;
  }
  double from_x[3], from_y[3], along[3], if_down[3], if_up[3];
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = i == 2 ? 0 : i + 1;
    const bool is_up = y[j] > y[i], is_down = y[j] < y[i];
    const double ratio = (x[j] - x[i]) / (y[j] - y[i]);
    along[i] = y[j] == y[i] ? 0 : ratio;
    const std::size_t lower = is_up ? i : j;
    from_x[i] = x[lower];
    from_y[i] = y[lower];
    constexpr double if_not_down[2]{-infinity, 0}, if_not_up[2]{infinity, 0};
    if_down[i] = if_not_down[is_down];
    if_up[i] = if_not_up[is_up];
  }
  const Span rows = span_of(y[0], y[1], y[2]);
  const std::int32_t end = next_above(rows.high);
  for (std::int32_t row = next_above(rows.low); row < end; ++row) {
    const auto at = [&](std::size_t i) { return from_x[i] + (row - from_y[i]) * along[i]; };
    const double x0 = at(0), x1 = at(1), x2 = at(2);
    const double first = span_of(x0 + if_down[0], x1 + if_down[1], x2 + if_down[2]).high;
    const double last = span_of(x0 + if_up[0], x1 + if_up[1], x2 + if_up[2]).low;
    take(row, next_above(first), next_above(last));
  }
}

struct Sizes {
  Rectangle all;
  double mean_x = 0, mean_y = 0;  // of the facets' rectangles
};

// Cells as long and wide as half a facet is on average, so that scan lines far apart have long cells. Coarser where facets
// are so long and thin that their rows would outnumber them by far.
void lay_grid(const Sizes& sizes, MeshStorage& storage) {
  Mesh& mesh = storage.mesh;
  const auto& [all, mean_x, mean_y] = sizes;
  const double size_x = all.high_x - all.low_x, size_y = all.high_y - all.low_y;
  const double cell_count = std::min(cells_per_facet * mesh.facet_count, 2e9);
  const double shape = size_x / mean_x / (size_y / mean_y);
  const double columns = std::clamp(std::sqrt(cell_count * (std::isfinite(shape) && shape > 0 ? shape : 1)), 1.0, cell_count);
  surface::Grid& grid = mesh.grid;
  grid.low_x = all.low_x;
  grid.low_y = all.low_y;
  grid.columns = static_cast<std::int32_t>(columns);
  grid.rows = static_cast<std::int32_t>(std::max(1.0, cell_count / columns));
  const double most_rows = 16.0 * mesh.facet_count + 1000;
  const double mean_rows = mean_y / size_y * grid.rows * mesh.facet_count;
  if (mean_rows > most_rows) grid.rows = std::max(1, static_cast<std::int32_t>(grid.rows * (most_rows / mean_rows)));
  // A size may be 0 where a stray point far away has taken the digits of all others.
  const auto per_mm = [](std::int32_t count, double size) { return size > 0 ? std::min(count / size, 1e300) : 0; };
  grid.columns_per_mm = per_mm(grid.columns, size_x);
  grid.rows_per_mm = per_mm(grid.rows, size_y);

  const std::size_t cells_in_all = static_cast<std::size_t>(grid.columns) * static_cast<std::size_t>(grid.rows);
  storage.grid.assign(cells_in_all + 4, no_facet);  // some beyond the last one are written with what they hold
  for (std::uint32_t f = 0; f < mesh.facet_count; ++f) {
    for_each_row(grid, triangle(mesh, f), [&](std::int32_t row, std::int32_t begin, std::int32_t end) {
      std::uint32_t* const cells = storage.grid.data() + static_cast<std::size_t>(row) * static_cast<std::size_t>(grid.columns);
      // Up to four at once, without a branch on how many.
      using Four [[gnu::vector_size(16)]] = std::int32_t;
      Four old, at{begin, begin + 1, begin + 2, begin + 3};
      std::memcpy(&old, cells + begin, sizeof old);
      const Four is_in = at < end, now = (old & ~is_in) | (static_cast<std::int32_t>(f) & is_in);
      std::memcpy(cells + begin, &now, sizeof now);
      for (std::int32_t i = begin + 4; i < end; ++i) cells[i] = f;
    });
  }
  grid.facets = storage.grid.data();
}

Box united(const Box* first, const Box* last) {
  Box box = *first;
  for (const Box* other = first + 1; other < last; ++other) {
    for (int i = 0; i < 3; ++i) {
      box.low[i] = std::min(box.low[i], other->low[i]);
      box.high[i] = std::max(box.high[i], other->high[i]);
    }
  }
  return box;
}

Sizes grow_tree(MeshStorage& storage) {
  Mesh& mesh = storage.mesh;
  Sizes sizes;
  // Above the rounding of floats and of every test that follows, by far.
  const double margin = 0x1p-22 * mesh.extent;
  const auto box_around = [&](std::uint32_t facet) {
    const auto [v0, v1, v2] = triangle(mesh, facet);
    const Span x = span_of(v0.x, v1.x, v2.x), y = span_of(v0.y, v1.y, v2.y), z = span_of(v0.z, v1.z, v2.z);
    sizes.all.include(x.low, y.low);
    sizes.all.include(x.high, y.high);
    sizes.mean_x += x.high - x.low;
    sizes.mean_y += y.high - y.low;
    const auto low = [&](double v) { return static_cast<float>(v - margin); };
    const auto high = [&](double v) { return static_cast<float>(v + margin); };
    return Box{{low(x.low), low(y.low), low(z.low)}, {high(x.high), high(y.high), high(z.high)}};
  };
  const auto groups = [](std::size_t count, std::size_t size) { return (count + size - 1) / size; };
  storage.boxes.reserve(groups(mesh.facet_count, Mesh::leaf_size) * 8 / 7 + 20);
  for (std::uint32_t f = 0; f < mesh.facet_count; f += Mesh::leaf_size) {
    Box boxes[Mesh::leaf_size]{};
    std::uint32_t count = 0;
    while (count < Mesh::leaf_size && f + count < mesh.facet_count) boxes[count] = box_around(f + count), ++count;
    storage.boxes.push_back(united(boxes, boxes + count));
  }
  for (std::size_t begin = 0, end = storage.boxes.size(); end - begin > 1;) {
    for (std::size_t i = begin; i < end; i += Mesh::branching) {
      const std::size_t stop = std::min<std::size_t>(i + Mesh::branching, end);
      const Box above = united(storage.boxes.data() + i, storage.boxes.data() + stop);
      storage.boxes.push_back(above);
    }
    begin = end;
    end = storage.boxes.size();
  }
  mesh.boxes = storage.boxes.data();
  mesh.box_count = static_cast<std::uint32_t>(storage.boxes.size());
  sizes.mean_x /= mesh.facet_count, sizes.mean_y /= mesh.facet_count;
  return sizes;
}

}  // namespace

void index_mesh(MeshStorage& storage) {
  lay_grid(grow_tree(storage), storage);
}

}  // namespace sagitta::scene
