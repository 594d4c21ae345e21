// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "lib/scene/mesh_internal.h"

namespace sagitta::scene {
namespace {

using prescription::PointCloud;
using surface::no_facet;

constexpr double widest_circumradius = 2;  // in mean edge lengths

// The mean length of the Delaunay edges at every point.
std::vector<float> mean_edge_lengths(const PointCloud& cloud, const std::vector<RawFacet>& facets) {
  struct Sum {
    double length = 0;
    std::uint32_t count = 0;
  };
  std::vector<Sum> sums(cloud.points.size());
  for (std::uint32_t f = 0; f < facets.size(); ++f) {
    for (std::size_t i = 0; i < 3; ++i) {
      const RawFacet& facet = facets[f];
      if (facet.neighbour[i] < f) continue;  // every edge once
      const double length = edge_length(cloud, facet, static_cast<int>(i));
      for (const std::uint32_t end : {facet.corner[(i + 1) % 3], facet.corner[(i + 2) % 3]}) {
        sums[end].length += length;
        ++sums[end].count;
      }
    }
  }
  std::vector<float> means(sums.size());
  std::transform(sums.begin(), sums.end(), means.begin(),
                 [](const Sum& sum) { return static_cast<float>(sum.length / std::max(sum.count, 1u)); });
  return means;
}

}  // namespace

double edge_length(const PointCloud& cloud, const RawFacet& facet, int i) {
  const auto& a = cloud.points[facet.corner[static_cast<std::size_t>((i + 1) % 3)]];
  const auto& b = cloud.points[facet.corner[static_cast<std::size_t>((i + 2) % 3)]];
  return std::hypot(b.x - a.x, b.y - a.y);
}

RawFacet from_widest_corner(const PointCloud& cloud, const RawFacet& facet) {
  const std::array<double, 3> length{edge_length(cloud, facet, 0), edge_length(cloud, facet, 1), edge_length(cloud, facet, 2)};
  RawFacet turned = facet;
  const auto first = std::max_element(length.begin(), length.end()) - length.begin();
  std::rotate(turned.corner.begin(), turned.corner.begin() + first, turned.corner.end());
  std::rotate(turned.neighbour.begin(), turned.neighbour.begin() + first, turned.neighbour.end());
  return turned;
}

Trimmed trim(const PointCloud& cloud, std::vector<RawFacet> facets, double max_edge) {
  Trimmed trimmed;
  std::vector<char> gone(facets.size(), false), seen(facets.size(), false);
  for (std::size_t f = 0; f < facets.size(); ++f) {
    facets[f] = from_widest_corner(cloud, facets[f]);
    const auto& corner = facets[f].corner;
    const bool hole = std::any_of(corner.begin(), corner.end(), [&](std::uint32_t v) { return std::isnan(cloud.points[v].z); });
    const bool long_edge = !hole && edge_length(cloud, facets[f], 0) > max_edge;
    gone[f] = hole || long_edge;
    trimmed.holes += hole;
    trimmed.long_edges += long_edge;
  }

  // Peeling. Whether a facet on the rim stays does not depend on what went before it, so the order is free.
  std::vector<std::uint32_t> on_rim;
  const auto reach = [&](std::uint32_t f) {
    if (f == no_facet || seen[f]) return;
    seen[f] = true;
    on_rim.push_back(f);
  };
  for (std::uint32_t f = 0; f < facets.size(); ++f) {
    const auto& neighbour = facets[f].neighbour;
    if (std::find(neighbour.begin(), neighbour.end(), no_facet) != neighbour.end()) reach(f);
  }
  const std::vector<float> mean_length = mean_edge_lengths(cloud, facets);
  const auto is_sliver = [&](const RawFacet& facet) {
    const auto& [v0, v1, v2] = facet.corner;
    const auto &p0 = cloud.points[v0], &p1 = cloud.points[v1], &p2 = cloud.points[v2];
    const double twice_area = (p1.x - p0.x) * (p2.y - p0.y) - (p2.x - p0.x) * (p1.y - p0.y);
    const double circumradius = edge_length(cloud, facet, 0) / (2 * twice_area) * edge_length(cloud, facet, 1) *
                                edge_length(cloud, facet, 2);
    const double mean = (double{mean_length[v0]} + mean_length[v1] + mean_length[v2]) / 3;
    return !(twice_area > 0 && circumradius <= widest_circumradius * mean);
  };
  while (!on_rim.empty()) {
    const std::uint32_t f = on_rim.back();
    on_rim.pop_back();
    if (!gone[f]) {
      if (!is_sliver(facets[f])) continue;
      gone[f] = true;
      ++trimmed.slivers;
    }
    for (const std::uint32_t next : facets[f].neighbour) reach(next);
  }

  std::vector<std::uint32_t> new_index(facets.size(), no_facet);
  std::uint32_t count = 0;
  for (std::size_t f = 0; f < facets.size(); ++f) {
    if (!gone[f]) new_index[f] = count++;
  }
  for (std::size_t f = 0; f < facets.size(); ++f) {
    if (gone[f]) continue;
    for (std::uint32_t& next : facets[f].neighbour) next = next == no_facet ? no_facet : new_index[next];
    facets[new_index[f]] = facets[f];
  }
  facets.resize(count);
  trimmed.facets = std::move(facets);
  return trimmed;
}

}  // namespace sagitta::scene
