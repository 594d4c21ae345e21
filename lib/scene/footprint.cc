// SPDX-License-Identifier: Apache-2.0
#include "lib/scene/footprint.h"

#include <algorithm>
#include <cmath>

#include "lib/surface/facets.h"

namespace sagitta::scene {
namespace {

// Whether the straight edge a b meets the rectangle: unless it passes beside it, or all corners lie on one side of it.
bool meets(const Rectangle& rectangle, const Vec3<double>& a, const Vec3<double>& b) {
  Rectangle around;
  around.include(a.x, a.y);
  around.include(b.x, b.y);
  if (!rectangle.meets(around)) return false;
  const auto side = [&](double x, double y) { return (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x); };
  const auto [least, most] = std::minmax({side(rectangle.low_x, rectangle.low_y), side(rectangle.low_x, rectangle.high_y),
                                          side(rectangle.high_x, rectangle.low_y), side(rectangle.high_x, rectangle.high_y)});
  return !(least > 0 || most < 0);
}

}  // namespace

std::optional<Footprint> footprint_of(const std::vector<Line>& lines, double low_z, double high_z) {
  Footprint found;
  for (const auto& [point, d] : lines) {
    const Vec3<double> per_z{d.x / d.z, d.y / d.z, 1};
    for (const double z : {low_z, high_z}) {
      const Vec3<double> place = point + (z - point.z) * per_z;
      if (!std::isfinite(place.x) || !std::isfinite(place.y)) return std::nullopt;
      found.places.include(place.x, place.y);
    }
    found.tangents.include(per_z.x, per_z.y);
  }
  if (lines.empty()) return std::nullopt;
  const Rectangle& box = found.places;
  const double size = std::max(box.high_x - box.low_x, box.high_y - box.low_y);
  found.places = box.grown(footprint_margin * size + 1e-9 * (1 + std::abs(box.low_x) + std::abs(box.low_y) + high_z - low_z));
  return found;
}

bool settles(const surface::Mesh& mesh, const Footprint& footprint) {
  if (mesh.facet_count == 0) return false;
  const auto& [inner, tangents] = footprint;
  const auto around = [&](std::uint32_t f) {
    Rectangle box;
    for (const std::uint32_t v : mesh.corners[f]) box.include(mesh.vertices[v].x, mesh.vertices[v].y);
    return box;
  };
  Rectangle places = inner;
  for (std::uint32_t f = 0; f < mesh.facet_count; ++f)
    if (const Rectangle box = around(f); box.meets(inner)) places.include(box.low_x, box.low_y), places.include(box.high_x, box.high_y);
  for (std::uint32_t f = 0; f < mesh.facet_count; ++f) {
    if (!around(f).meets(places)) continue;
    const surface::Facet& facet = mesh.facets[f];
    const auto corner = [&](std::size_t i) -> const Vec3<double>& { return mesh.vertices[mesh.corners[f][i % 3]]; };
    // along = d_z (1 - slope . tangent); from zero by more than what counts as grazing (surface/facet_location.h)
    const double most = std::max(facet.slope_x * tangents.low_x, facet.slope_x * tangents.high_x) +
                        std::max(facet.slope_y * tangents.low_y, facet.slope_y * tangents.high_y);
    if (!(most <= 1 - 0x1p-10)) return false;
    for (std::size_t i = 0; i < 3; ++i)
      if (facet.neighbour[i] == surface::no_facet && meets(places, corner(i + 1), corner(i + 2))) return false;
  }
  // no rim passes through the footprint, so one place of it stands for all
  return surface::Facets{&mesh}.covers(places.low_x / 2 + places.high_x / 2, places.low_y / 2 + places.high_y / 2);
}

}  // namespace sagitta::scene
