// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "lib/scene/mesh_internal.h"

namespace sagitta::scene {
namespace {

using prescription::PointCloud;
using surface::no_facet;

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double widest_circumradius = 2;  // in mean edge lengths

double square_of_edge(const PointCloud& cloud, const RawFacet& facet, std::size_t i) {
  const auto &a = cloud.points[facet.corner[(i + 1) % 3]], &b = cloud.points[facet.corner[(i + 2) % 3]];
  const double dx = b.x - a.x, dy = b.y - a.y;
  return dx * dx + dy * dy;
}

// The mean length of the Delaunay edges at a corner of a facet: anticlockwise around it, and where the hull ends that
// clockwise. Edges go by their facet and the end that they have anticlockwise of the corner's. Added up by size, so that the
// bits do not depend on the facet it begins with.
double mean_edge_length(const PointCloud& cloud, const std::vector<RawFacet>& facets, std::uint32_t first, std::uint32_t vertex) {
  std::vector<double> lengths;
  const auto mean = [&] {
    std::sort(lengths.begin(), lengths.end());
    return std::accumulate(lengths.begin(), lengths.end(), 0.0) / static_cast<double>(lengths.size());
  };
  const auto corner_in = [&](const RawFacet& facet) {
    return static_cast<std::size_t>(std::find(facet.corner.begin(), facet.corner.end(), vertex) - facet.corner.begin());
  };
  const auto add = [&](const RawFacet& facet, std::size_t opposite) { lengths.push_back(std::sqrt(square_of_edge(cloud, facet, opposite % 3))); };
  for (std::uint32_t f = first;;) {
    const RawFacet& facet = facets[f];
    const std::size_t i = corner_in(facet);
    add(facet, i + 2);
    f = facet.neighbour[(i + 1) % 3];
    if (f == first) return mean();
    if (f != no_facet) continue;
    add(facet, i + 1);
    break;
  }
  for (std::uint32_t f = first;;) {
    f = facets[f].neighbour[(corner_in(facets[f]) + 2) % 3];
    if (f == no_facet) return mean();
    add(facets[f], corner_in(facets[f]) + 2);
  }
}

}  // namespace

double edge_length(const PointCloud& cloud, const RawFacet& facet, int i) {
  return std::sqrt(square_of_edge(cloud, facet, static_cast<std::size_t>(i)));
}

RawFacet from_widest_corner(const PointCloud& cloud, const RawFacet& facet) {
  const auto [a, b, c] = facet.corner;
  const auto [na, nb, nc] = facet.neighbour;
  const double sa = square_of_edge(cloud, facet, 0), sb = square_of_edge(cloud, facet, 1), sc = square_of_edge(cloud, facet, 2);
  // Of equal ones that of the first corner in (x, y), whatever the facet's order and the points' numbers.
  const auto comes_first = [&](double square, std::uint32_t corner, double other_square, std::uint32_t other) {
    if (square != other_square) return square > other_square;
    const auto &p = cloud.points[corner], &q = cloud.points[other];
    return p.x != q.x ? p.x < q.x : p.y < q.y;
  };
  const bool a_before_b = comes_first(sa, a, sb, b), b_before_c = comes_first(sb, b, sc, c), a_before_c = comes_first(sa, a, sc, c);
  if (a_before_b && a_before_c) return facet;
  if (b_before_c && !a_before_b) return {{b, c, a}, {nb, nc, na}};
  return {{c, a, b}, {nc, na, nb}};
}

Trimmed trim(const PointCloud& cloud, const std::vector<RawFacet>& facets, double max_edge, const std::vector<char>& is_known) {
  const auto is_outside = [&](std::size_t f) { return !is_known.empty() && !is_known[f]; };
  Trimmed trimmed;
  std::vector<char>& gone = trimmed.gone;
  gone.assign(facets.size(), false);
  std::vector<char> seen(facets.size(), false);
  for (std::size_t f = 0; f < facets.size(); ++f) {
    const auto z = [&](std::size_t i) { return cloud.points[facets[f].corner[i]].z; };
    const bool hole = std::isnan(z(0) + z(1) + z(2));
    const auto is_long = [&](std::size_t i) { return square_of_edge(cloud, facets[f], i) > max_edge * max_edge; };
    const bool long_edge = max_edge < infinity && !hole && (is_long(0) || is_long(1) || is_long(2));
    gone[f] = hole || long_edge || is_outside(f);
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
    if (is_outside(f) || std::find(neighbour.begin(), neighbour.end(), no_facet) != neighbour.end()) reach(f);
  }
  std::vector<float> mean_lengths(cloud.points.size());  // of those that were asked for
  const auto mean_length = [&](std::uint32_t facet, std::uint32_t vertex) {
    float& mean = mean_lengths[vertex];
    if (mean == 0) mean = static_cast<float>(mean_edge_length(cloud, facets, facet, vertex));
    return double{mean};
  };
  const auto is_sliver = [&](std::uint32_t f) {
    const RawFacet facet = from_widest_corner(cloud, facets[f]);  // the same bits, whatever its order
    const auto& [v0, v1, v2] = facet.corner;
    const auto &p0 = cloud.points[v0], &p1 = cloud.points[v1], &p2 = cloud.points[v2];
    const double twice_area = (p1.x - p0.x) * (p2.y - p0.y) - (p2.x - p0.x) * (p1.y - p0.y);
    const double circumradius = edge_length(cloud, facet, 0) / (2 * twice_area) * edge_length(cloud, facet, 1) *
                                edge_length(cloud, facet, 2);
    const double mean = (mean_length(f, v0) + mean_length(f, v1) + mean_length(f, v2)) / 3;
    return !(twice_area > 0 && circumradius <= widest_circumradius * mean);
  };
  while (!on_rim.empty()) {
    const std::uint32_t f = on_rim.back();
    on_rim.pop_back();
    if (!gone[f]) {
      if (!is_sliver(f)) continue;
      gone[f] = true;
      ++trimmed.slivers;
    }
    for (const std::uint32_t next : facets[f].neighbour) reach(next);
  }

  trimmed.kept = static_cast<std::size_t>(std::count(gone.begin(), gone.end(), false));
  return trimmed;
}

}  // namespace sagitta::scene
