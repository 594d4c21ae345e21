// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "lib/scene/mesh_internal.h"

namespace sagitta::scene {
namespace {

using numerics::Vec3;
using prescription::PointCloud;
using surface::Corners;
using surface::Facet;
using surface::Mesh;
using surface::no_facet;

// The facets in the order of their corners' numbers, the lowest corner first: the numbers run along a curve, so what is
// near on the surface is near in memory, and the order of any two facets depends on nothing else.
void sort_by_corners(std::size_t point_count, std::vector<RawFacet>& facets) {
  const auto lowest = [](const RawFacet& facet) { return std::min({facet.corner[0], facet.corner[1], facet.corner[2]}); };
  const auto all = [](const RawFacet& facet) {
    auto corners = facet.corner;
    std::sort(corners.begin(), corners.end());
    return corners;
  };
  std::vector<std::uint32_t> begin(point_count + 1, 0);
  for (const RawFacet& facet : facets) ++begin[lowest(facet) + 1];
  for (std::size_t i = 1; i < begin.size(); ++i) begin[i] += begin[i - 1];
  std::vector<std::uint32_t> order(facets.size()), filled(begin.begin(), begin.end() - 1);
  for (std::uint32_t f = 0; f < facets.size(); ++f) order[filled[lowest(facets[f])]++] = f;
  for (std::size_t i = 0; i < point_count; ++i)
    std::sort(order.begin() + begin[i], order.begin() + begin[i + 1],
              [&](std::uint32_t f, std::uint32_t g) { return all(facets[f]) < all(facets[g]); });
  std::vector<std::uint32_t> new_index(facets.size());
  for (std::uint32_t k = 0; k < order.size(); ++k) new_index[order[k]] = k;
  std::vector<RawFacet> sorted(facets.size());
  for (std::size_t k = 0; k < order.size(); ++k) {
    RawFacet& facet = sorted[k] = facets[order[k]];
    for (std::uint32_t& next : facet.neighbour) next = next == no_facet ? no_facet : new_index[next];
  }
  facets = std::move(sorted);
}

// The places that facets use, in their order.
void take_vertices(const PointCloud& places, const std::vector<RawFacet>& facets, MeshStorage& mesh) {
  std::vector<std::uint32_t> vertex_of(places.points.size(), 0);
  for (const RawFacet& facet : facets)
    for (const std::uint32_t corner : facet.corner) vertex_of[corner] = 1;
  for (std::size_t i = 0; i < vertex_of.size(); ++i) {
    if (!vertex_of[i]) continue;
    vertex_of[i] = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.push_back(places.points[i]);
  }
  mesh.corners.reserve(facets.size());
  for (const RawFacet& facet : facets)
    mesh.corners.push_back({vertex_of[facet.corner[0]], vertex_of[facet.corner[1]], vertex_of[facet.corner[2]]});
}

// surface/mesh.h, Facet. In long double, so that the plane of a thin facet still passes through its corners.
Facet facet_between(const Vec3<double>& v0, const Vec3<double>& v1, const Vec3<double>& v2, const Mesh& mesh) {
  using Long = long double;
  const auto exact = [](const Vec3<double>& v) { return numerics::vec3_cast<Long>(v); };
  const Vec3<Long> corner = exact(v0) - exact(mesh.centre), to_1 = exact(v1) - exact(v0), to_2 = exact(v2) - exact(v0);
  const Vec3<Long> normal = cross(to_1, to_2);
  const Long per_z = 1 / normal.z, slope_x = -normal.x * per_z, slope_y = -normal.y * per_z;
  Facet facet{};
  facet.slope_x = static_cast<double>(slope_x);
  facet.slope_y = static_cast<double>(slope_y);
  facet.x = static_cast<float>(corner.x);
  facet.y = static_cast<float>(corner.y);
  facet.z = static_cast<double>(corner.z + (slope_x * (Long{facet.x} - corner.x) + slope_y * (Long{facet.y} - corner.y)));
  facet.u_x = static_cast<float>(to_2.y * per_z);
  facet.u_y = static_cast<float>(-to_2.x * per_z);
  facet.v_x = static_cast<float>(-to_1.y * per_z);
  facet.v_y = static_cast<float>(to_1.x * per_z);
  facet.guard = static_cast<float>(0x1p-22 * mesh.extent) *
                (std::abs(facet.u_x) + std::abs(facet.u_y) + std::abs(facet.v_x) + std::abs(facet.v_y));
  return facet;
}

void make_facets(const std::vector<RawFacet>& raw, MeshStorage& storage) {
  storage.facets.reserve(raw.size());
  for (std::size_t f = 0; f < raw.size(); ++f) {
    const Corners& corners = storage.corners[f];
    Facet& facet = storage.facets.emplace_back(facet_between(storage.vertices[corners[0]], storage.vertices[corners[1]],
                                                             storage.vertices[corners[2]], storage.mesh));
    std::copy(raw[f].neighbour.begin(), raw[f].neighbour.end(), facet.neighbour);
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
    const auto by_line = [&](std::uint32_t a, std::uint32_t b) { return cloud.lines[a] < cloud.lines[b]; };
    const auto [first, second] = std::minmax({corner(shortest + 1), corner(shortest + 2)}, by_line);
    if (!told.emplace(first, second).second) continue;
    findings.error(place_of(cloud, second),
                   fmt::format("{}two points so near one place that no slope can be told: the other one is in {}",
                               before_what(cloud, second), name_of(cloud, first)),
                   "a surface has one height at every (x, y)");
  }
}

void finish(MeshStorage& storage) {
  Mesh& mesh = storage.mesh;
  mesh.vertices = storage.vertices.data();
  mesh.corners = storage.corners.data();
  mesh.facets = storage.facets.data();
  mesh.vertex_count = static_cast<std::uint32_t>(storage.vertices.size());
  mesh.facet_count = static_cast<std::uint32_t>(storage.facets.size());
  if (mesh.facet_count > 0) index_mesh(storage);
}

}  // namespace

std::shared_ptr<const MeshStorage> build_mesh(const PointCloud& places, const CloudExtent& extent, std::vector<RawFacet> facets,
                                              prescription::Findings& findings) {
  auto storage = std::make_shared<MeshStorage>();
  Mesh& mesh = storage->mesh;
  mesh.centre = extent.centre;
  mesh.extent = extent.reach;
  mesh.base = extent.base;
  sort_by_corners(places.points.size(), facets);
  take_vertices(places, facets, *storage);
  make_facets(facets, *storage);
  refuse_cliffs(places, facets, *storage, findings);
  if (findings.has_errors()) return nullptr;
  facets = {};
  finish(*storage);
  return storage;
}

std::shared_ptr<const MeshStorage> without_facets(const MeshStorage& all, const std::vector<char>& is_dropped) {
  auto storage = std::make_shared<MeshStorage>();
  storage->mesh.centre = all.mesh.centre;
  storage->mesh.extent = all.mesh.extent;
  storage->mesh.base = all.mesh.base;
  storage->vertices = all.vertices;
  std::vector<std::uint32_t> new_index(all.facets.size(), no_facet);
  std::uint32_t count = 0;
  for (std::size_t f = 0; f < all.facets.size(); ++f)
    if (!is_dropped[f]) new_index[f] = count++;
  for (std::size_t f = 0; f < all.facets.size(); ++f) {
    if (is_dropped[f]) continue;
    storage->corners.push_back(all.corners[f]);
    Facet& facet = storage->facets.emplace_back(all.facets[f]);
    for (std::uint32_t& next : facet.neighbour) next = next == no_facet ? no_facet : new_index[next];
  }
  finish(*storage);
  return storage;
}

}  // namespace sagitta::scene
