// SPDX-License-Identifier: Apache-2.0
#include "lib/study/nearest_vertex.h"

#include <limits>

namespace sagitta::study {

using numerics::Vec3;

NearestVertex::NearestVertex(const surface::Mesh& mesh) : mesh_(&mesh), first_(mesh.vertex_count + 1) {
  for (std::uint32_t f = 0; f < mesh.facet_count; ++f)
    for (const std::uint32_t v : mesh.corners[f]) ++first_[v + 1];
  for (std::uint32_t v = 0; v < mesh.vertex_count; ++v) first_[v + 1] += first_[v];
  around_.resize(first_.back());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (std::uint32_t f = 0; f < mesh.facet_count; ++f)
    for (const std::uint32_t v : mesh.corners[f]) around_[next[v]++] = f;
}

NearestVertex::Hit NearestVertex::find(const Vec3<double>& p, const Vec3<double>& d) const {
  std::uint32_t nearest = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::uint32_t v = 0; v < mesh_->vertex_count; ++v) {
    const Vec3<double> across = cross(mesh_->vertices[v] - p, d);
    const double square = dot(across, across);  // (1)
    if (square < least) least = square, nearest = v;
  }
  if (!(least < std::numeric_limits<double>::infinity())) return {};
  for (std::uint32_t i = first_[nearest]; i < first_[nearest + 1]; ++i) {
    const surface::Corners& corner = mesh_->corners[around_[i]];
    const Vec3<double>& v0 = mesh_->vertices[corner[0]];
    const Vec3<double> e1 = mesh_->vertices[corner[1]] - v0, e2 = mesh_->vertices[corner[2]] - v0, from = p - v0, q = cross(d, e2), r = cross(from, e1);
    const double determinant = dot(e1, q), u = dot(from, q) / determinant, v = dot(d, r) / determinant;
    if (u >= 0 && v >= 0 && u + v <= 1) return {around_[i], dot(e2, r) / determinant};  // (2)
  }
  return {};
}

std::uint32_t NearestVertex::facet_of(const Vec3<double>& p, const Vec3<double>& d) const { return find(p, d).facet; }

surface::Crossing<double> NearestVertex::meet(const Vec3<double>& p, const Vec3<double>& d) const {
  const Hit hit = find(p, d);
  if (hit.facet == surface::no_facet) return surface::no_crossing<double>(surface::Status::outside_data);
  const double a = mesh_->facets[hit.facet].slope_x, b = mesh_->facets[hit.facet].slope_y;
  return {hit.path, p + hit.path * d, {-a, -b, 1}, d.z - a * d.x - b * d.y, surface::Status::ok};
}

}  // namespace sagitta::study
