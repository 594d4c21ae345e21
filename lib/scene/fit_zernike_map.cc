// SPDX-License-Identifier: Apache-2.0
#include "lib/scene/fit_zernike_map.h"

#include <array>
#include <cstdint>
#include <limits>

#include "lib/numerics/arena.h"
#include "lib/scene/triangulate.h"
#include "lib/surface/facets.h"
#include "lib/surface/zernike.h"

namespace sagitta::scene {

ResidualMapResult residual_map(const ZernikeSurface& surface) {
  if (const auto missing = missing_triangulation({surface.points.file})) {
    prescription::Findings findings;
    findings.note(missing->place, "no residual map, and no coverage: " + missing->what);
    return {std::nullopt, std::move(findings)};
  }
  Triangulation made = triangulate(surface.points);
  if (!made.mesh) return {std::nullopt, std::move(made.findings)};
  const surface::Mesh& mesh = made.mesh->mesh;
  const surface::Facets facets{&mesh};

  numerics::Arena arena;
  const auto fitted = surface::Zernike::from(zernike_shape(surface).parameters, arena);
  std::vector<double> residual_um;
  for (const auto& v : made.mesh->vertices) residual_um.push_back(1e3 * (v.z - fitted.sag(v.x, v.y)));

  // Between the corners of the facet at (x, y), by the areas opposite to them.
  const auto interpolated = [&](double x, double y) {
    const std::uint32_t at = facets.facet_at(x, y);
    if (at == surface::no_facet) return std::numeric_limits<double>::quiet_NaN();
    const auto& corner = mesh.corners[at];
    double sum = 0, area = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto &a = mesh.vertices[corner[(i + 1) % 3]], &b = mesh.vertices[corner[(i + 2) % 3]];
      const double weight = (a.x - x) * (b.y - y) - (a.y - y) * (b.x - x);
      sum += weight * residual_um[corner[i]];
      area += weight;
    }
    return sum / area;
  };

  ResidualMap map;
  const int half = (map.size - 1) / 2;
  map.pixel_mm = surface.normalization_radius_mm / half;
  map.residual_um.reserve(static_cast<std::size_t>(map.size) * static_cast<std::size_t>(map.size));
  int in_circle = 0, covered = 0;
  for (int j = half; j >= -half; --j) {
    for (int i = -half; i <= half; ++i) {
      const bool inside = i * i + j * j <= half * half;
      const double value = inside ? interpolated(i * map.pixel_mm, j * map.pixel_mm) : std::numeric_limits<double>::quiet_NaN();
      in_circle += inside;
      covered += value == value;
      map.residual_um.push_back(static_cast<float>(value));
    }
  }
  map.coverage = static_cast<double>(covered) / in_circle;
  return {std::move(map), std::move(made.findings)};
}

}  // namespace sagitta::scene
