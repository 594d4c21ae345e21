// SPDX-License-Identifier: Apache-2.0
// The steps between the triangulation and the mesh, each in a file of its own.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "lib/scene/triangulate.h"

namespace sagitta::scene {

inline constexpr double steepest_slope = 1e9;

// One facet of the whole triangulation: corners are indices of the cloud's points, anticlockwise; neighbour[i] is
// across the edge opposite to corner[i], no_facet across the hull.
struct RawFacet {
  std::array<std::uint32_t, 3> corner, neighbour;
};

// What triangulates (triangulate.cc): the facets of the points `places` of the cloud, which are distinct in (x, y).
// None if all lie on a straight line.
std::vector<RawFacet> delaunay(const prescription::PointCloud& cloud, const std::vector<std::uint32_t>& places);

// Length of the edge in (x, y) opposite to corner i.
double edge_length(const prescription::PointCloud& cloud, const RawFacet& facet, int i);

// Turned so that corner[0] is opposite to the longest edge: cross products of the two edges from there lose least.
RawFacet from_widest_corner(const prescription::PointCloud& cloud, const RawFacet& facet);

// Leaves out what is no surface; the neighbours of those that stay are renumbered.
struct Trimmed {
  std::vector<RawFacet> facets;
  std::size_t holes = 0, long_edges = 0, slivers = 0;  // how many went, and why
};
Trimmed trim(const prescription::PointCloud& cloud, std::vector<RawFacet> facets, double max_edge);

// Vertices and facets in the order of a space-filling curve, with slopes, grid and base sphere. Facets without a slope
// are errors.
std::shared_ptr<const MeshStorage> build_mesh(const prescription::PointCloud& cloud, std::vector<RawFacet> facets,
                                              prescription::Findings& findings);

// The place of a point in the cloud's file; the file as a whole where that has no lines. "line 3" or "point 3"; and what a
// message at that place begins with to tell of which point it speaks, "point 3: " or nothing.
prescription::Place place_of(const prescription::PointCloud& cloud, std::size_t point);
std::string name_of(const prescription::PointCloud& cloud, std::size_t point);
std::string before_what(const prescription::PointCloud& cloud, std::size_t point);

}  // namespace sagitta::scene
