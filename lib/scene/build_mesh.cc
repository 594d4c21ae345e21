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
using surface::Corners;
using surface::Facet;
using surface::Mesh;
using surface::no_facet;

// Where the whole cloud lies, holes not counted. Everything that steers a ray depends on it, and not on the facets at
// hand: part of a cloud's facets give a ray the same bits as all of them.
struct Extent {
  Vec3<double> low, high;
  Vec3<double> centre;  // medians, which a stray point far away does not move
  double reach = 0;     // the largest distance of a coordinate from the centre's
};
Extent extent_of(const PointCloud& cloud) {
  constexpr double inf = std::numeric_limits<double>::infinity();
  Extent box{{inf, inf, inf}, {-inf, -inf, -inf}, {}};
  for (const Vec3<double>& p : cloud.points) {
    if (std::isnan(p.z)) continue;
    box.low = {std::min(box.low.x, p.x), std::min(box.low.y, p.y), std::min(box.low.z, p.z)};
    box.high = {std::max(box.high.x, p.x), std::max(box.high.y, p.y), std::max(box.high.z, p.z)};
  }
  const std::vector<Vec3<double>> some = sample_of(cloud.points);
  std::vector<double> values(some.size());
  const auto median = [&](auto&& coordinate) {
    std::transform(some.begin(), some.end(), values.begin(), coordinate);
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
  };
  box.centre = {median([](const auto& p) { return p.x; }), median([](const auto& p) { return p.y; }), median([](const auto& p) { return p.z; })};
  const Vec3<double> up = box.high - box.centre, down = box.centre - box.low;
  box.reach = std::max({up.x, up.y, up.z, down.x, down.y, down.z});
  return box;
}

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

// The facets along Morton's curve: what is near on the surface is near in memory. The order of any two depends on nothing
// but their corners and the cloud's extent.
void sort_along_curve(const PointCloud& cloud, const Extent& box, std::vector<RawFacet>& facets) {
  const auto place = [](double sum, double low, double high) {  // of three coordinates
    return high > low ? static_cast<std::uint32_t>(std::clamp((sum / 3 - low) / (high - low), 0.0, 1.0) * 65535) : 0u;
  };
  std::vector<std::uint64_t> keys(facets.size());
  for (std::size_t f = 0; f < facets.size(); ++f) {
    const auto& [i, j, k] = facets[f].corner;
    const auto &a = cloud.points[i], &b = cloud.points[j], &c = cloud.points[k];
    keys[f] = interleaved(place(a.x + b.x + c.x, box.low.x, box.high.x), place(a.y + b.y + c.y, box.low.y, box.high.y)) << 32 | f;
  }
  std::sort(keys.begin(), keys.end());
  const auto facet_of = [&](std::uint64_t key) -> const RawFacet& { return facets[static_cast<std::uint32_t>(key)]; };
  for (auto run = keys.begin(); run != keys.end();) {
    const auto end = std::find_if(run, keys.end(), [&](std::uint64_t key) { return key >> 32 != *run >> 32; });
    if (end - run > 1) std::sort(run, end, [&](std::uint64_t a, std::uint64_t b) { return facet_of(a).corner < facet_of(b).corner; });
    run = end;
  }
  std::vector<std::uint32_t> new_index(facets.size());
  for (std::size_t k = 0; k < keys.size(); ++k) new_index[static_cast<std::uint32_t>(keys[k])] = static_cast<std::uint32_t>(k);
  std::vector<RawFacet> sorted(facets.size());
  for (std::size_t k = 0; k < keys.size(); ++k) {
    RawFacet& facet = sorted[k] = facet_of(keys[k]);
    for (std::uint32_t& next : facet.neighbour) next = next == no_facet ? no_facet : new_index[next];
  }
  facets = std::move(sorted);
}

// Vertices in the order in which the facets first use them.
void take_vertices(const PointCloud& cloud, const std::vector<RawFacet>& facets, MeshStorage& mesh) {
  std::vector<std::uint32_t> vertex_of(cloud.points.size(), no_facet);
  mesh.corners.reserve(facets.size());
  mesh.vertices.reserve(std::min(cloud.points.size(), facets.size() + 2));
  mesh.points.reserve(mesh.vertices.capacity());
  for (const RawFacet& raw : facets) {
    Corners& corners = mesh.corners.emplace_back();
    for (std::size_t i = 0; i < 3; ++i) {
      std::uint32_t& vertex = vertex_of[raw.corner[i]];
      if (vertex == no_facet) {
        vertex = static_cast<std::uint32_t>(mesh.vertices.size());
        mesh.vertices.push_back(cloud.points[raw.corner[i]]);
        mesh.points.push_back(raw.corner[i]);
      }
      corners[i] = vertex;
    }
  }
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
    const auto [first, second] = std::minmax({corner(shortest + 1), corner(shortest + 2)});
    if (!told.emplace(first, second).second) continue;
    findings.error(place_of(cloud, second),
                   fmt::format("two points so near one place that no slope can be told: the other one is in line {}",
                               place_of(cloud, first).line),
                   "a surface has one height at every (x, y)");
  }
}

}  // namespace

std::shared_ptr<const MeshStorage> build_mesh(const PointCloud& cloud, std::vector<RawFacet> facets,
                                              prescription::Findings& findings) {
  auto storage = std::make_shared<MeshStorage>();
  Mesh& mesh = storage->mesh;
  const Extent box = extent_of(cloud);
  mesh.centre = box.centre;
  mesh.extent = box.reach;
  sort_along_curve(cloud, box, facets);
  take_vertices(cloud, facets, *storage);
  make_facets(facets, *storage);
  refuse_cliffs(cloud, facets, *storage, findings);
  if (findings.has_errors()) return nullptr;
  facets = {};

  mesh.base = fit_base_sphere(cloud.points, mesh.centre);
  mesh.vertices = storage->vertices.data();
  mesh.corners = storage->corners.data();
  mesh.facets = storage->facets.data();
  mesh.vertex_count = static_cast<std::uint32_t>(storage->vertices.size());
  mesh.facet_count = static_cast<std::uint32_t>(storage->facets.size());
  index_mesh(*storage);
  return storage;
}

}  // namespace sagitta::scene
