// SPDX-License-Identifier: Apache-2.0
#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include "lib/scene/delaunay.h"
#include "lib/surface/mesh.h"

namespace sagitta::scene {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Vertex = CGAL::Triangulation_vertex_base_with_info_2<std::uint32_t, Kernel>;
using Face = CGAL::Triangulation_face_base_with_info_2<std::uint32_t, Kernel>;
using Delaunay = CGAL::Delaunay_triangulation_2<Kernel, CGAL::Triangulation_data_structure_2<Vertex, Face>>;

}  // namespace

std::vector<RawFacet> delaunay(const std::vector<numerics::Vec3<double>>& points) {
  Delaunay triangulation;
  // Every 4^k-th point along the curve, k falling: each is near the one before, and the triangles are never far from
  // what they will be.
  const std::size_t count = points.size();
  std::size_t stride = 1;
  while (stride < count) stride *= 4;
  Delaunay::Face_handle near_last;
  const auto insert = [&](std::size_t i) {
    const auto vertex = triangulation.insert({points[i].x, points[i].y}, near_last);
    vertex->info() = static_cast<std::uint32_t>(i);
    near_last = vertex->face();
  };
  for (std::size_t before = 0; stride > 0; before = stride, stride /= 4) {
    for (std::size_t i = 0; i < count; i += stride) {
      if (before == 0 || i % before != 0) insert(i);
    }
  }
  std::vector<RawFacet> facets;
  if (triangulation.dimension() < 2) return facets;
  facets.reserve(triangulation.number_of_faces());
  std::uint32_t facet_count = 0;
  for (const auto face : triangulation.finite_face_handles()) face->info() = facet_count++;
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

std::string_view triangulator() { return "CGAL " CGAL_STRINGIZE(CGAL_VERSION); }

}  // namespace sagitta::scene
