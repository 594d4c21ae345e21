// SPDX-License-Identifier: Apache-2.0
#include "lib/scene/triangulate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
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

bool is_legal(const numerics::Vec3<double>& p) {
  const auto legal = [](double v) { return std::abs(v) <= largest_coordinate; };  // false for NaN
  return legal(p.x) && legal(p.y) && (legal(p.z) || std::isnan(p.z));
}

bool coordinates_are_legal(const PointCloud& cloud, Findings& findings) {
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    const auto& p = cloud.points[i];
    if (is_legal(p)) continue;
    findings.error(place_of(cloud, i),
                   fmt::format("{}the point ({:.9g}, {:.9g}, {:.9g}) is beyond +-1e9 mm", before_what(cloud, i), p.x, p.y, p.z),
                   "coordinates are in mm");
    if (findings.error_count() == most_errors) break;
  }
  return !findings.has_errors();
}

// One point of every place in the window, along the curve. Of points at one place the first with a height stays; another
// height is an error.
PointCloud distinct_places(const PointCloud& cloud, const Rectangle& all, const Rectangle& window, Findings& findings) {
  const auto& points = cloud.points;
  std::vector<std::uint32_t> order = along_curve(points, all, window);
  std::size_t count = 0, repeated = 0;
  std::uint32_t first_repeated = 0;
  constexpr std::size_t ahead = 16;  // what is read in the curve's order, which nothing could guess, is asked for so early
  const auto ask_for = [&](std::size_t k) {
    if (k < order.size()) __builtin_prefetch(&points[order[k]]);
  };
  for (std::size_t k = 0; k < order.size(); ++k) {
    ask_for(k + ahead);
    const std::uint32_t i = order[k];
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
  PointCloud places;
  places.file = cloud.file;
  places.has_lines = cloud.has_lines;
  places.points.reserve(count);
  places.lines.reserve(count);
  for (std::size_t k = 0; k < count; ++k) {
    ask_for(k + ahead);
    places.points.push_back(points[order[k]]);
    places.lines.push_back(static_cast<std::uint32_t>(number_of(cloud, order[k])));
  }
  return places;
}

bool spread_is_legal(const PointCloud& places, Findings& findings) {
  const prescription::Place file{places.file};
  const std::size_t count = places.points.size();
  if (count < 3) {
    findings.error(file, fmt::format("{} {}: a surface needs at least 3", count, count == 1 ? "place" : "places"),
                   "one point a line: x, y, z in mm");
    return false;
  }
  const auto [left, right] = std::minmax_element(places.points.begin(), places.points.end(), [](auto& p, auto& q) { return p.x < q.x; });
  const auto [lowest, highest] = std::minmax_element(places.points.begin(), places.points.end(), [](auto& p, auto& q) { return p.y < q.y; });
  const double span = std::max(right->x - left->x, highest->y - lowest->y);
  if (!(span >= smallest_span)) {
    findings.error(file, fmt::format("all points lie within {:.9g} mm: a surface needs at least 1e-6 mm", span), "coordinates are in mm");
    return false;
  }
  return true;
}

// All of the cloud where there is no window.
void triangulate_within(const Rectangle* window, const PointCloud& cloud, const CloudExtent& extent, double max_edge, Triangulation& result) {
  Findings& findings = result.findings;
  if (const auto missing = missing_triangulation({cloud.file})) return findings.add(*missing);
  // From here on points go by their numbers along the curve: what is near on the surface is near in memory.
  const PointCloud places = distinct_places(cloud, extent.places, window ? *window : extent.places, findings);
  result.place_count = places.points.size();
  if (findings.has_errors() || !spread_is_legal(places, findings)) return;
  const std::vector<RawFacet> facets = delaunay(places.points);
  const prescription::Place file{cloud.file};
  if (facets.empty()) return findings.error(file, "all points lie on one straight line in (x, y)", "a surface needs points on both sides of it");
  std::vector<char> is_known;
  if (window) is_known = known_facets(places, facets, *window);
  const Trimmed trimmed = trim(places, facets, max_edge, is_known);
  if (trimmed.kept == 0) {
    return findings.error(file,
                          fmt::format("no facet is left between the points: {} touch a hole, {} have an edge longer than max_edge_mm, "
                                      "{} are slivers of the hull",
                                      trimmed.holes, trimmed.long_edges, trimmed.slivers),
                          "points must be spread over an area");
  }
  result.mesh = build_mesh(places, extent, facets, trimmed.gone, findings);
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

std::optional<prescription::Finding> missing_triangulation(const prescription::Place& place) {
  if (!triangulator().empty()) return std::nullopt;
  return prescription::Finding{place, prescription::Severity::error, "points cannot be triangulated: this build of sagitta is without CGAL",
                               "build it with cmake -DSAGITTA_CGAL=ON, or trace a fit to the points (sagitta fit)"};
}

bool has_legal_coordinates(const PointCloud& cloud) { return std::all_of(cloud.points.begin(), cloud.points.end(), is_legal); }

Triangulation triangulate(const PointCloud& cloud, double max_edge) {
  Triangulation result;
  if (!coordinates_are_legal(cloud, result.findings)) return result;
  triangulate_within(nullptr, cloud, extent_of(cloud), max_edge, result);
  return result;
}

Triangulation triangulate_part(const PointCloud& cloud, const CloudExtent& extent, const Rectangle& window, double max_edge) {
  Triangulation result;
  triangulate_within(&window, cloud, extent, max_edge, result);
  return result;
}

}  // namespace sagitta::scene
