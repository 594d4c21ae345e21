// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "lib/scene/cloud_fit.h"
#include "lib/scene/mesh_internal.h"

namespace sagitta::scene {
namespace {

using numerics::Vec3;
using prescription::PointCloud;
using surface::Facet;
using surface::Mesh;
using surface::no_facet;

// Bits of two 16-bit numbers, interleaved: the place on Morton's curve.
std::uint64_t interleaved(std::uint32_t x, std::uint32_t y) {
  const auto spread = [](std::uint64_t v) {
    v = (v | (v << 8)) & 0x00FF00FF;
    v = (v | (v << 4)) & 0x0F0F0F0F;
    v = (v | (v << 2)) & 0x33333333;
    return (v | (v << 1)) & 0x55555555;
  };
  return spread(x) | (spread(y) << 1);
}

struct Box {
  Vec3<double> low, high;
};

template <class Points>
Box bounding_box(const Points& corners_of) {
  constexpr double inf = std::numeric_limits<double>::infinity();
  Box box{{inf, inf, inf}, {-inf, -inf, -inf}};
  corners_of([&](const Vec3<double>& p) {
    box.low = {std::min(box.low.x, p.x), std::min(box.low.y, p.y), std::min(box.low.z, p.z)};
    box.high = {std::max(box.high.x, p.x), std::max(box.high.y, p.y), std::max(box.high.z, p.z)};
  });
  return box;
}

// The facets along Morton's curve: what is near on the surface is near in memory.
void sort_along_curve(const PointCloud& cloud, std::vector<RawFacet>& facets) {
  const Box box = bounding_box([&](auto&& take) {
    for (const RawFacet& facet : facets) take(cloud.points[facet.corner[0]]);
  });
  const auto place = [](double v, double low, double high) {
    return high > low ? static_cast<std::uint32_t>((v - low) / (high - low) * 65535) : 0u;
  };
  std::vector<std::uint64_t> keys(facets.size());
  for (std::size_t f = 0; f < facets.size(); ++f) {
    const auto& p = cloud.points[facets[f].corner[0]];
    keys[f] = interleaved(place(p.x, box.low.x, box.high.x), place(p.y, box.low.y, box.high.y)) << 32 | f;
  }
  std::sort(keys.begin(), keys.end());
  std::vector<std::uint32_t> new_index(facets.size());
  for (std::size_t k = 0; k < keys.size(); ++k) new_index[static_cast<std::uint32_t>(keys[k])] = static_cast<std::uint32_t>(k);
  std::vector<RawFacet> sorted(facets.size());
  for (std::size_t f = 0; f < facets.size(); ++f) {
    RawFacet& facet = sorted[new_index[f]] = facets[f];
    for (std::uint32_t& next : facet.neighbour) next = next == no_facet ? no_facet : new_index[next];
  }
  facets = std::move(sorted);
}

// Vertices in the order in which the facets first use them.
void take_vertices(const PointCloud& cloud, const std::vector<RawFacet>& facets, MeshStorage& mesh) {
  std::vector<std::uint32_t> vertex_of(cloud.points.size(), no_facet);
  mesh.facets.reserve(facets.size());
  mesh.vertices.reserve(std::min(cloud.points.size(), facets.size() + 2));
  for (const RawFacet& raw : facets) {
    Facet& facet = mesh.facets.emplace_back();
    for (std::size_t i = 0; i < 3; ++i) {
      std::uint32_t& vertex = vertex_of[raw.corner[i]];
      if (vertex == no_facet) {
        vertex = static_cast<std::uint32_t>(mesh.vertices.size());
        mesh.vertices.push_back(cloud.points[raw.corner[i]]);
      }
      facet.corner[i] = vertex;
      facet.neighbour[i] = raw.neighbour[i];
    }
    const auto &p0 = cloud.points[raw.corner[0]], &p1 = cloud.points[raw.corner[1]], &p2 = cloud.points[raw.corner[2]];
    const Vec3<double> normal = cross(p1 - p0, p2 - p0);
    facet.slope_x = -normal.x / normal.z;
    facet.slope_y = -normal.y / normal.z;
  }
}

void refuse_cliffs(const PointCloud& cloud, const std::vector<RawFacet>& facets, const MeshStorage& mesh,
                   prescription::Findings& findings) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> told;  // by both facets of the edge
  for (std::size_t f = 0; f < facets.size() && told.size() < 100; ++f) {
    const Facet& facet = mesh.facets[f];
    if (std::abs(facet.slope_x) <= steepest_slope && std::abs(facet.slope_y) <= steepest_slope) continue;
    const auto length = [&](int i) { return edge_length(cloud, facets[f], i); };
    const int shortest = length(0) < length(1) ? (length(0) < length(2) ? 0 : 2) : (length(1) < length(2) ? 1 : 2);
    const auto corner = [&](int i) { return facets[f].corner[static_cast<std::size_t>(i % 3)]; };
    const auto [first, second] = std::minmax({corner(shortest + 1), corner(shortest + 2)});
    if (!told.emplace(first, second).second) continue;
    findings.error(place_of(cloud, second),
                   fmt::format("{}two points so near one place that no slope can be told: the other one is in {}",
                               before_what(cloud, second), name_of(cloud, first)),
                   "a surface has one height at every (x, y)");
  }
}

// The grid: about a cell a facet, its cells as long and wide as the facets are on average, so that scan lines far apart
// do not fill the lists. Where thin facets across the grid would, it is made coarser.
void build_grid(MeshStorage& storage) {
  Mesh& mesh = storage.mesh;
  const auto facet_count = static_cast<double>(storage.facets.size());
  const auto box_of = [&](const Facet& facet) {
    return bounding_box([&](auto&& take) {
      for (const std::uint32_t v : facet.corner) take(storage.vertices[v]);
    });
  };
  const Vec3<double> size = mesh.high - mesh.low;
  double mean_x = 0, mean_y = 0;  // of the facets' rectangles, in sizes of the whole
  for (const Facet& facet : storage.facets) {
    const Box box = box_of(facet);
    mean_x += (box.high.x - box.low.x) / size.x / facet_count;
    mean_y += (box.high.y - box.low.y) / size.y / facet_count;
  }
  const auto slots = [&](double ideal) { return static_cast<std::uint32_t>(std::clamp(ideal, 1.0, facet_count)); };
  mesh.columns = slots(std::sqrt(facet_count * mean_y / mean_x));
  mesh.rows = slots(facet_count / mesh.columns);

  struct Cells {
    std::int64_t first_column, last_column, first_row, last_row;
  };
  const auto cells_of = [&](const Facet& facet) -> Cells {
    const Box box = box_of(facet);
    return {mesh.column(box.low.x), mesh.column(box.high.x), mesh.row(box.low.y), mesh.row(box.high.y)};
  };
  const std::uint64_t most_entries = 16 * std::uint64_t{storage.facets.size()} + 1000;
  for (;; mesh.columns = (mesh.columns + 1) / 2, mesh.rows = (mesh.rows + 1) / 2) {
    mesh.columns_per_mm = mesh.columns / size.x;
    mesh.rows_per_mm = mesh.rows / size.y;
    std::uint64_t entries = 0;
    for (const Facet& facet : storage.facets) {
      const Cells cells = cells_of(facet);
      entries += static_cast<std::uint64_t>((cells.last_column - cells.first_column + 1) * (cells.last_row - cells.first_row + 1));
    }
    if (entries <= most_entries || std::max(mesh.columns, mesh.rows) == 1) break;
  }

  const auto for_each_entry = [&](auto&& take) {
    for (std::uint32_t f = 0; f < storage.facets.size(); ++f) {
      const Cells cells = cells_of(storage.facets[f]);
      for (std::int64_t row = cells.first_row; row <= cells.last_row; ++row) {
        for (std::int64_t column = cells.first_column; column <= cells.last_column; ++column) take(f, column, row);
      }
    }
  };
  // Counts, then ends, then (filling from the end) beginnings.
  storage.cell_begin.assign(std::size_t{mesh.columns} * mesh.rows + 1, 0);
  for_each_entry([&](std::uint32_t, std::int64_t column, std::int64_t row) { ++storage.cell_begin[mesh.cell(column, row)]; });
  for (std::size_t cell = 1; cell < storage.cell_begin.size(); ++cell) storage.cell_begin[cell] += storage.cell_begin[cell - 1];
  storage.cell_facets.resize(storage.cell_begin.back());
  for_each_entry([&](std::uint32_t f, std::int64_t column, std::int64_t row) {
    storage.cell_facets[--storage.cell_begin[mesh.cell(column, row)]] = f;
  });
  // The facet that covers the centre comes first.
  for_each_entry([&](std::uint32_t f, std::int64_t column, std::int64_t row) {
    const double x = mesh.low.x + (static_cast<double>(column) + 0.5) / mesh.columns_per_mm;
    const double y = mesh.low.y + (static_cast<double>(row) + 0.5) / mesh.rows_per_mm;
    const auto is_left_of = [&](std::size_t i) {
      const auto &a = storage.vertices[storage.facets[f].corner[i]], &b = storage.vertices[storage.facets[f].corner[(i + 1) % 3]];
      return (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x) >= 0;
    };
    if (!is_left_of(0) || !is_left_of(1) || !is_left_of(2)) return;
    const auto list = storage.cell_facets.begin() + storage.cell_begin[mesh.cell(column, row)];
    std::iter_swap(list, std::find(list, storage.cell_facets.end(), f));
  });
}

}  // namespace

std::shared_ptr<const MeshStorage> build_mesh(const PointCloud& cloud, std::vector<RawFacet> facets,
                                              prescription::Findings& findings) {
  auto storage = std::make_shared<MeshStorage>();
  sort_along_curve(cloud, facets);
  take_vertices(cloud, facets, *storage);
  refuse_cliffs(cloud, facets, *storage, findings);
  if (findings.has_errors()) return nullptr;
  facets = {};

  Mesh& mesh = storage->mesh;
  const Box box = bounding_box([&](auto&& take) {
    for (const auto& vertex : storage->vertices) take(vertex);
  });
  mesh.low = box.low;
  mesh.high = box.high;
  mesh.base = fit_base_sphere(storage->vertices, 0.5 * (box.low + box.high));
  build_grid(*storage);
  mesh.vertices = storage->vertices.data();
  mesh.facets = storage->facets.data();
  mesh.vertex_count = static_cast<std::uint32_t>(storage->vertices.size());
  mesh.facet_count = static_cast<std::uint32_t>(storage->facets.size());
  mesh.cell_begin = storage->cell_begin.data();
  mesh.cell_facets = storage->cell_facets.data();
  return storage;
}

}  // namespace sagitta::scene
