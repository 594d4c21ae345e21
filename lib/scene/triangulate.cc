// SPDX-License-Identifier: Apache-2.0
#include "lib/scene/triangulate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "lib/scene/mesh_internal.h"

namespace sagitta::scene {
namespace {

using prescription::Findings;
using prescription::PointCloud;

constexpr double largest_coordinate = 1e9, smallest_span = 1e-6;  // mm
constexpr int most_errors = 100;

std::size_t number_of(const PointCloud& cloud, std::size_t point) {
  return point < cloud.lines.size() ? cloud.lines[point] : point + 1;
}

bool coordinates_are_legal(const PointCloud& cloud, Findings& findings) {
  const auto legal = [](double v) { return std::abs(v) <= largest_coordinate; };  // false for NaN
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    const auto& p = cloud.points[i];
    if (legal(p.x) && legal(p.y) && (legal(p.z) || std::isnan(p.z))) continue;
    findings.error(place_of(cloud, i),
                   fmt::format("{}the point ({:.9g}, {:.9g}, {:.9g}) is beyond +-1e9 mm", before_what(cloud, i), p.x, p.y, p.z),
                   "coordinates are in mm");
    if (findings.error_count() == most_errors) break;
  }
  return !findings.has_errors();
}

// One point of every place, by (x, y). Of points at one place the first with a height stays; another height is an error.
std::vector<std::uint32_t> distinct_places(const PointCloud& cloud, Findings& findings) {
  const auto& points = cloud.points;
  std::vector<std::uint32_t> order(points.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    if (points[a].x != points[b].x) return points[a].x < points[b].x;
    if (points[a].y != points[b].y) return points[a].y < points[b].y;
    return a < b;
  });
  std::size_t count = 0, repeated = 0;
  std::uint32_t first_repeated = 0;
  for (const std::uint32_t i : order) {
    if (count == 0 || points[order[count - 1]].x != points[i].x || points[order[count - 1]].y != points[i].y) {
      order[count++] = i;
      continue;
    }
    std::uint32_t& kept = order[count - 1];
    const double z = points[i].z, z_kept = points[kept].z;
    if (!std::isnan(z) && !std::isnan(z_kept) && z != z_kept) {
      if (findings.error_count() < most_errors) {
        findings.error(place_of(cloud, i),
                       fmt::format("{}two heights at one place ({:.9g}, {:.9g}): {:.17g} here and {:.17g} in {}", before_what(cloud, i),
                                   points[i].x, points[i].y, z, z_kept, name_of(cloud, kept)),
                       "a surface has one height at every (x, y)");
      }
      continue;
    }
    if (repeated++ == 0 || i < first_repeated) first_repeated = i;
    if (std::isnan(z_kept)) kept = i;
  }
  if (repeated > 0 && !findings.has_errors()) {
    findings.note(place_of(cloud, first_repeated), fmt::format("{}{} {} another, the first one here: merged", before_what(cloud, first_repeated),
                                                               repeated, repeated == 1 ? "point repeats" : "points repeat"));
  }
  order.resize(count);
  return order;
}

bool spread_is_legal(const PointCloud& cloud, const std::vector<std::uint32_t>& places, Findings& findings) {
  const prescription::Place file{cloud.file};
  if (places.size() < 3) {
    findings.error(file, fmt::format("{} {}: a surface needs at least 3", places.size(), places.size() == 1 ? "place" : "places"),
                   "one point a line: x, y, z in mm");
    return false;
  }
  const auto y = [&](std::uint32_t i) { return cloud.points[i].y; };
  const auto [lowest, highest] = std::minmax_element(places.begin(), places.end(), [&](auto a, auto b) { return y(a) < y(b); });
  const double span = std::max(cloud.points[places.back()].x - cloud.points[places.front()].x, y(*highest) - y(*lowest));
  if (!(span >= smallest_span)) {
    findings.error(file, fmt::format("all points lie within {:.9g} mm: a surface needs at least 1e-6 mm", span), "coordinates are in mm");
    return false;
  }
  return true;
}

}  // namespace

prescription::Place place_of(const PointCloud& cloud, std::size_t point) {
  if (!cloud.has_lines) return {cloud.file};
  return {cloud.file, static_cast<int>(number_of(cloud, point)), 1};
}

std::string name_of(const PointCloud& cloud, std::size_t point) {
  return fmt::format("{} {}", cloud.has_lines ? "line" : "point", number_of(cloud, point));
}

std::string before_what(const PointCloud& cloud, std::size_t point) {
  return cloud.has_lines ? "" : name_of(cloud, point) + ": ";
}

Triangulation triangulate(const PointCloud& cloud, double max_edge) {
  Triangulation result;
  Findings& findings = result.findings;
  if (!coordinates_are_legal(cloud, findings)) return result;
  std::vector<RawFacet> facets;
  {
    const std::vector<std::uint32_t> places = distinct_places(cloud, findings);
    if (findings.has_errors() || !spread_is_legal(cloud, places, findings)) return result;
    facets = delaunay(cloud, places);
  }
  const prescription::Place file{cloud.file};
  if (facets.empty()) {
    findings.error(file, "all points lie on one straight line in (x, y)", "a surface needs points on both sides of it");
    return result;
  }
  Trimmed trimmed = trim(cloud, std::move(facets), max_edge);
  if (trimmed.facets.empty()) {
    findings.error(file,
                   fmt::format("no facet is left between the points: {} touch a hole, {} have an edge longer than max_edge_mm, "
                               "{} are slivers of the hull",
                               trimmed.holes, trimmed.long_edges, trimmed.slivers),
                   "points must be spread over an area");
    return result;
  }
  result.mesh = build_mesh(cloud, std::move(trimmed.facets), findings);
  return result;
}

}  // namespace sagitta::scene
