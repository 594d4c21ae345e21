// SPDX-License-Identifier: Apache-2.0
// From measured points to the facets between them: the Delaunay triangulation of their (x, y), without what is no
// surface. The only user of CGAL.
//
// Refused, with the line of the point: fewer than 3 places, all points on one straight line, two heights at one place,
// two heights so near one place that no slope can be told (more than 1e9), a coordinate beyond +-1e9 mm, points that
// all lie within 1e-6 mm. Repeated points merge, with a note; of a hole and a height at one place the height stays.
//
// Left out of the surface:
// - facets with a corner that is an explicit hole (z NaN);
// - facets with an edge longer than max_edge in (x, y);
// - slivers of the hull: peeling inward from the hull, a facet with an edge on the rim goes if its circumradius exceeds
//   twice the mean length of the Delaunay edges at its corners (the mean over its three corners of the mean at each, in
//   the whole triangulation). A rim is what borders on the outside, be it through facets left out for any reason; the
//   rim of a hole inside the surface is none.
//
// The same points in the same order give the same mesh. Where points lie on a common circle (a regular grid) the
// diagonal is arbitrary.
//
// Source: the peeling rule is this project's own (a rule by nearest-neighbour spacing would remove the apex of ring data and
// most of a scan); Delaunay triangulation by exact predicates, CGAL 5.5.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "lib/prescription/point_cloud.h"
#include "lib/surface/mesh.h"

namespace sagitta::scene {

// Owns the arrays that `mesh` looks at.
struct MeshStorage {
  std::vector<numerics::Vec3<double>> vertices;
  std::vector<surface::Corners> corners;
  std::vector<surface::Facet> facets;
  std::vector<std::uint32_t> grid;
  std::vector<surface::Box> boxes;
  surface::Mesh mesh;

  MeshStorage() = default;
  MeshStorage(const MeshStorage&) = delete;
  MeshStorage& operator=(const MeshStorage&) = delete;
};

struct Triangulation {
  std::shared_ptr<const MeshStorage> mesh;  // null exactly when there is an error among the findings
  prescription::Findings findings;          // at places in the cloud's file
};

Triangulation triangulate(const prescription::PointCloud& cloud,
                          double max_edge = std::numeric_limits<double>::infinity());

}  // namespace sagitta::scene
