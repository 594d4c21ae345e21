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

// What is read in an order that nothing could guess is asked for so many facets ahead.
constexpr std::size_t ahead = 16;
void ask_for(const std::vector<RawFacet>& facets, const std::vector<std::uint32_t>& order, std::size_t k) {
  if (k < order.size()) __builtin_prefetch(&facets[order[k]]);
}

// The order of the facets that stay by their corners' numbers, the lowest corner first: the numbers run along a curve, so what is
// near on the surface is near in memory, and the order of any two facets depends on nothing else.
std::vector<std::uint32_t> order_by_corners(std::size_t point_count, const std::vector<RawFacet>& facets, const std::vector<char>& gone) {
  struct Others {  // the two other corners, the lower one in front
    std::uint64_t key;
    std::uint32_t facet;
    bool operator<(const Others& other) const { return key < other.key; }
  };
  const auto lowest = [](const RawFacet& facet) { return std::min(facet.corner[0], std::min(facet.corner[1], facet.corner[2])); };
  const auto others = [&](std::uint32_t f) {
    const auto [a, b, c] = facets[f].corner;
    const std::uint32_t highest = std::max(a, std::max(b, c)), middle = std::max(std::min(a, b), std::min(std::max(a, b), c));
    return Others{std::uint64_t{middle} << 32 | highest, f};
  };
  std::vector<std::uint32_t> end(point_count + 1, 0);  // of the facets of each lowest corner; at first where they begin
  for (std::size_t f = 0; f < facets.size(); ++f) end[lowest(facets[f]) + 1] += !gone[f];
  for (std::size_t i = 1; i < end.size(); ++i) end[i] += end[i - 1];
  std::vector<std::uint32_t> order(end.back());
  for (std::uint32_t f = 0; f < facets.size(); ++f)
    if (!gone[f]) order[end[lowest(facets[f])]++] = f;
  std::vector<Others> few;
  for (std::size_t i = 0, begin = 0; i < point_count; begin = end[i++]) {
    if (end[i] - begin < 2) continue;
    few.clear();
    for (std::size_t k = begin; k < end[i]; ++k) {
      ask_for(facets, order, k + ahead);
      few.push_back(others(order[k]));
    }
    std::sort(few.begin(), few.end());
    for (std::size_t k = begin; k < end[i]; ++k) order[k] = few[k - begin].facet;
  }
  return order;
}

// The places that facets use, in their order. vertex_of[place], where used
std::vector<std::uint32_t> take_vertices(const PointCloud& places, const std::vector<RawFacet>& facets, const std::vector<char>& gone,
                                         MeshStorage& mesh) {
  std::vector<std::uint32_t> vertex_of(places.points.size(), 0);
  for (std::size_t f = 0; f < facets.size(); ++f)
    for (const std::uint32_t corner : facets[f].corner) vertex_of[corner] |= !gone[f];
  mesh.vertices.reserve(places.points.size());
  for (std::size_t i = 0; i < vertex_of.size(); ++i) {
    if (!vertex_of[i]) continue;
    vertex_of[i] = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.push_back(places.points[i]);
  }
  return vertex_of;
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

bool is_cliff(const Facet& facet) {  // or has no slope
  return !(std::abs(facet.slope_x) <= steepest_slope && std::abs(facet.slope_y) <= steepest_slope);
}

// Returns whether there is a cliff among them.
bool make_facets(const PointCloud& places, const std::vector<RawFacet>& raw, const std::vector<std::uint32_t>& order,
                 const std::vector<std::uint32_t>& vertex_of, MeshStorage& storage) {
  std::vector<std::uint32_t> new_index(raw.size(), no_facet);
  for (std::uint32_t k = 0; k < order.size(); ++k) new_index[order[k]] = k;
  bool has_cliff = false;
  storage.corners.reserve(order.size());
  storage.facets.reserve(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) {
    ask_for(raw, order, k + ahead);
    const RawFacet turned = from_widest_corner(places, raw[order[k]]);
    const auto [a, b, c] = turned.corner;
    const Corners& corners = storage.corners.emplace_back(Corners{vertex_of[a], vertex_of[b], vertex_of[c]});
    Facet& facet = storage.facets.emplace_back(facet_between(storage.vertices[corners[0]], storage.vertices[corners[1]],
                                                             storage.vertices[corners[2]], storage.mesh));
    for (std::size_t i = 0; i < 3; ++i) facet.neighbour[i] = turned.neighbour[i] == no_facet ? no_facet : new_index[turned.neighbour[i]];
    has_cliff |= is_cliff(facet);
  }
  return has_cliff;
}

void refuse_cliffs(const PointCloud& cloud, const std::vector<RawFacet>& facets, const std::vector<std::uint32_t>& order,
                   const MeshStorage& mesh, prescription::Findings& findings) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> told;  // by both facets of the edge
  for (std::size_t k = 0; k < order.size() && told.size() < 100; ++k) {
    if (!is_cliff(mesh.facets[k])) continue;
    const RawFacet raw = from_widest_corner(cloud, facets[order[k]]);
    const auto length = [&](int i) { return edge_length(cloud, raw, i); };
    const int shortest = length(0) < length(1) ? (length(0) < length(2) ? 0 : 2) : (length(1) < length(2) ? 1 : 2);
    const auto corner = [&](int i) { return raw.corner[static_cast<std::size_t>(i % 3)]; };
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

std::shared_ptr<const MeshStorage> build_mesh(const PointCloud& places, const CloudExtent& extent, const std::vector<RawFacet>& facets,
                                              const std::vector<char>& gone, prescription::Findings& findings) {
  auto storage = std::make_shared<MeshStorage>();
  Mesh& mesh = storage->mesh;
  mesh.centre = extent.centre;
  mesh.extent = extent.reach;
  mesh.base = extent.base;
  {
    const auto order = order_by_corners(places.points.size(), facets, gone);
    if (make_facets(places, facets, order, take_vertices(places, facets, gone, *storage), *storage))
      refuse_cliffs(places, facets, order, *storage, findings);
  }
  if (findings.has_errors()) return nullptr;
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
