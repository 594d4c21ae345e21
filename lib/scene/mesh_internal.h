// SPDX-License-Identifier: Apache-2.0
// The steps between the triangulation and the mesh, each in a file of its own.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "lib/scene/delaunay.h"
#include "lib/scene/triangulate.h"

namespace sagitta::scene {

inline constexpr double steepest_slope = 1e9;

// Length of the edge in (x, y) opposite to corner i.
double edge_length(const prescription::PointCloud& cloud, const RawFacet& facet, int i);

// Turned so that corner[0] is opposite to the longest edge: cross products of the two edges from there lose least.
RawFacet from_widest_corner(const prescription::PointCloud& cloud, const RawFacet& facet);

// Tells which facets are no surface. Those that are not known, where some are not (known_facets), go from the outset and
// count as outside.
struct Trimmed {
  std::vector<char> gone;  // of each facet
  std::size_t kept = 0, holes = 0, long_edges = 0, slivers = 0;  // how many stay; how many went, and why
};
Trimmed trim(const prescription::PointCloud& cloud, const std::vector<RawFacet>& facets, double max_edge, const std::vector<char>& is_known = {});

// Of the triangulation of a cloud's places within a window, which facets are known to be facets of the whole cloud's
// triangulation, with all that share a corner with them (triangulate.h, "a part").
std::vector<char> known_facets(const prescription::PointCloud& places, const std::vector<RawFacet>& facets, const Rectangle& window);

// Vertices and those facets that are not gone, in the order of the places, which run along a curve. Facets without a slope
// are errors.
std::shared_ptr<const MeshStorage> build_mesh(const prescription::PointCloud& places, const CloudExtent& extent,
                                              const std::vector<RawFacet>& facets, const std::vector<char>& gone,
                                              prescription::Findings& findings);

// The grid and the tree of boxes of a mesh whose vertices and facets are there.
void index_mesh(MeshStorage& storage);

// The place of a point in the cloud's file; the file as a whole where that has no lines. "line 3" or "point 3"; and what a
// message at that place begins with to tell of which point it speaks, "point 3: " or nothing.
prescription::Place place_of(const prescription::PointCloud& cloud, std::size_t point);
std::string name_of(const prescription::PointCloud& cloud, std::size_t point);
std::string before_what(const prescription::PointCloud& cloud, std::size_t point);

}  // namespace sagitta::scene
