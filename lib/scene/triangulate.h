// SPDX-License-Identifier: Apache-2.0
// From measured points to the facets between them: the Delaunay triangulation of their (x, y), without what is no
// surface. The only user of CGAL.
//
// Refused, with the line of the point: fewer than 3 places, all points on one straight line, two heights at one place,
// two heights so near one place that no slope can be told (more than 1e9), a coordinate beyond +-1e9 mm, points that
// all lie within 1e-6 mm; and any points by a build without a triangulation (delaunay.h). Repeated points merge, with a note; of a hole and a height at one place the height stays.
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
#include <optional>
#include <vector>

#include "lib/prescription/point_cloud.h"
#include "lib/scene/rectangle.h"
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
  std::size_t place_count = 0;              // that were triangulated
};

Triangulation triangulate(const prescription::PointCloud& cloud,
                          double max_edge = std::numeric_limits<double>::infinity());

// An error at `place`, where points are asked to be triangulated, in a build that cannot; none in one that can.
std::optional<prescription::Finding> missing_triangulation(const prescription::Place& place);

// Where the whole cloud lies. All that steers a ray depends on it, and not on the facets at hand: part of a cloud's facets
// give a ray the same bits as all of them.
struct CloudExtent {
  Rectangle places;                // of all points, holes too
  numerics::Vec3<double> low, high;  // of the points, holes not counted
  numerics::Vec3<double> centre;   // medians, which a stray point far away does not move
  double reach;                    // the largest distance of a coordinate from the centre's
  surface::BaseSphere base;
};
CloudExtent extent_of(const prescription::PointCloud& cloud);

// A part: the places within a window alone are triangulated, and of the facets those are kept that the triangulation of the
// whole cloud has as well, and keeps. Their order, their corners and their planes are the same, bit for bit. That holds
// because
// - a facet whose closed circumdisc lies in the window is a facet of the whole: no other point is in the disc, and of points
//   on its circle the tie is broken by these points alone. (The disc is computed to within 1e-9 of itself, and counts as
//   1e-6 larger; a facet too thin for that is not taken.) If that goes for all facets around each of its corners, a facet is
//   `known`: so are the edges at its corners, and whether it is a sliver;
// - what is known and stays here stays in the whole: a facet is peeled only if it is a sliver and a chain of facets that
//   went leads from it to the outside. The chain either is known to its end, or comes to a facet that is not known; as that
//   counts as outside here, and what is known is judged here as there, the chain goes here too.
// What is not known may be missing here, so a rim here need not be one of the whole cloud.
// The coordinates are legal (within +-1e9 mm), `extent` is that of the whole cloud, and other findings are those of the
// places in the window only.
Triangulation triangulate_part(const prescription::PointCloud& cloud, const CloudExtent& extent, const Rectangle& window, double max_edge);
bool has_legal_coordinates(const prescription::PointCloud& cloud);

// The mesh without the facets that are marked; vertices keep their numbers.
std::shared_ptr<const MeshStorage> without_facets(const MeshStorage& mesh, const std::vector<char>& is_dropped);

}  // namespace sagitta::scene
