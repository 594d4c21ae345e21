// SPDX-License-Identifier: Apache-2.0
// The two ways from a place to a facet (surface/mesh.h): the grid and the tree of boxes.
#include <algorithm>
#include <cmath>
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
  const auto corner = [&](std::size_t i) { return mesh.vertices[mesh.corners[facet][i]] - mesh.centre; };
  return {corner(0), corner(1), corner(2)};
}

Rectangle rectangle_around(const std::array<Vec3<double>, 3>& corner) {
  const auto [low_x, high_x] = std::minmax({corner[0].x, corner[1].x, corner[2].x});
  const auto [low_y, high_y] = std::minmax({corner[0].y, corner[1].y, corner[2].y});
  return {low_x, low_y, high_x, high_y};
}

// The cells whose middles lie in the triangle: row by row, the columns between two edges. take(row, first, last)
template <class Take>
void for_each_row(const surface::Grid& grid, const std::array<Vec3<double>, 3>& corner, Take&& take) {
  const auto middle_at_or_after = [](double position, std::int32_t count) {  // the least cell with its middle there
    return static_cast<std::int32_t>(std::clamp(std::ceil(position - 0.5), 0.0, static_cast<double>(count)));
  };
  const Rectangle box = rectangle_around(corner);
  const std::int32_t end_row = middle_at_or_after((box.high_y - grid.low_y) * grid.rows_per_mm, grid.rows);
  for (std::int32_t row = middle_at_or_after((box.low_y - grid.low_y) * grid.rows_per_mm, grid.rows); row < end_row; ++row) {
    const double y = grid.low_y + (row + 0.5) / grid.rows_per_mm;
    double first = std::numeric_limits<double>::infinity(), last = -first;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3<double>&a = corner[i], &b = corner[(i + 1) % 3];
      if ((a.y <= y) == (b.y <= y)) continue;
      const double x = a.x + (b.x - a.x) * ((y - a.y) / (b.y - a.y));
      first = std::min(first, x);
      last = std::max(last, x);
    }
    if (!(first <= last)) continue;
    const std::int32_t begin = middle_at_or_after((first - grid.low_x) * grid.columns_per_mm, grid.columns);
    const std::int32_t end = middle_at_or_after((last - grid.low_x) * grid.columns_per_mm, grid.columns);
    if (begin < end) take(row, begin, end);
  }
}

// Cells as long and wide as half a facet is on average, so that scan lines far apart have long cells. Coarser where facets
// are so long and thin that their rows would outnumber them by far.
void lay_grid(MeshStorage& storage) {
  Mesh& mesh = storage.mesh;
  Rectangle all;
  double mean_x = 0, mean_y = 0;  // sizes of the facets' rectangles
  for (std::uint32_t f = 0; f < mesh.facet_count; ++f) {
    const Rectangle box = rectangle_around(triangle(mesh, f));
    all = {std::min(all.low_x, box.low_x), std::min(all.low_y, box.low_y), std::max(all.high_x, box.high_x), std::max(all.high_y, box.high_y)};
    mean_x += (box.high_x - box.low_x) / mesh.facet_count;
    mean_y += (box.high_y - box.low_y) / mesh.facet_count;
  }
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

  storage.grid.assign(static_cast<std::size_t>(grid.columns) * static_cast<std::size_t>(grid.rows), no_facet);
  for (std::uint32_t f = 0; f < mesh.facet_count; ++f) {
    for_each_row(grid, triangle(mesh, f), [&](std::int32_t row, std::int32_t begin, std::int32_t end) {
      const auto first = storage.grid.begin() + static_cast<std::ptrdiff_t>(row) * grid.columns;
      std::fill(first + begin, first + end, f);
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

void grow_tree(MeshStorage& storage) {
  Mesh& mesh = storage.mesh;
  // Above the rounding of floats and of every test that follows, by far.
  const double margin = 0x1p-22 * mesh.extent;
  const auto box_around = [&](std::uint32_t facet) {
    const auto corner = triangle(mesh, facet);
    const Rectangle flat = rectangle_around(corner);
    const auto [low_z, high_z] = std::minmax({corner[0].z, corner[1].z, corner[2].z});
    const auto low = [&](double v) { return static_cast<float>(v - margin); };
    const auto high = [&](double v) { return static_cast<float>(v + margin); };
    return Box{{low(flat.low_x), low(flat.low_y), low(low_z)}, {high(flat.high_x), high(flat.high_y), high(high_z)}};
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
}

}  // namespace

void index_mesh(MeshStorage& storage) {
  lay_grid(storage);
  grow_tree(storage);
}

}  // namespace sagitta::scene
