// SPDX-License-Identifier: Apache-2.0
#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <boost/iterator/transform_iterator.hpp>
#include <utility>

#include "lib/scene/mesh_internal.h"

namespace sagitta::scene {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Vertex = CGAL::Triangulation_vertex_base_with_info_2<std::uint32_t, Kernel>;
using Face = CGAL::Triangulation_face_base_with_info_2<std::uint32_t, Kernel>;
using Delaunay = CGAL::Delaunay_triangulation_2<Kernel, CGAL::Triangulation_data_structure_2<Vertex, Face>>;

}  // namespace

std::vector<RawFacet> delaunay(const prescription::PointCloud& cloud, const std::vector<std::uint32_t>& places) {
  const auto with_index = [&](std::uint32_t i) {
    return std::pair(Kernel::Point_2(cloud.points[i].x, cloud.points[i].y), i);
  };
  // A range of pairs is inserted in the order of a space-filling curve.
  const Delaunay triangulation(boost::make_transform_iterator(places.begin(), with_index),
                               boost::make_transform_iterator(places.end(), with_index));
  std::vector<RawFacet> facets;
  if (triangulation.dimension() < 2) return facets;
  facets.reserve(triangulation.number_of_faces());
  std::uint32_t count = 0;
  for (const auto face : triangulation.finite_face_handles()) face->info() = count++;
  for (const auto face : triangulation.finite_face_handles()) {
    RawFacet& facet = facets.emplace_back();
    for (int i = 0; i < 3; ++i) {
      const auto neighbour = face->neighbor(i);
      const auto k = static_cast<std::size_t>(i);
      facet.corner[k] = face->vertex(i)->info();
      facet.neighbour[k] = triangulation.is_infinite(neighbour) ? surface::no_facet : neighbour->info();
    }
  }
  return facets;
}

}  // namespace sagitta::scene
