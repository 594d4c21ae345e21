// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "lib/scene/mesh_internal.h"

namespace sagitta::scene {
namespace {

using Long = long double;
using numerics::Vec3;

// Whether the closed circumdisc lies in the window. From one corner, with b and c the others seen from there and L the longer
// of the two, the centre is at (c_y b.b - b_y c.c, b_x c.c - c_x b.b)/(2 b x c). The terms of the numerator are below L^3,
// those of b x c below L^2, and each is known to a few 2^-63 of itself. So where b x c > 1e-9 L^2 the centre is known to
// about 1e-9 (L + R), below 1e-8 R: the 1e-6 R that it is given is far more.
bool has_its_disc_within(const Rectangle& window, const Vec3<double>& v0, const Vec3<double>& v1, const Vec3<double>& v2) {
  const Long b_x = Long{v1.x} - v0.x, b_y = Long{v1.y} - v0.y, c_x = Long{v2.x} - v0.x, c_y = Long{v2.y} - v0.y;
  const Long bb = b_x * b_x + b_y * b_y, cc = c_x * c_x + c_y * c_y, twice_area = b_x * c_y - b_y * c_x;
  if (!(twice_area > 1e-9L * std::max(bb, cc))) return false;
  const Long x = (c_y * bb - b_y * cc) / (2 * twice_area), y = (b_x * cc - c_x * bb) / (2 * twice_area);
  const Long reach = std::sqrt(x * x + y * y) * (1 + 1e-6L);
  return v0.x + (x - reach) >= window.low_x && v0.x + (x + reach) <= window.high_x && v0.y + (y - reach) >= window.low_y &&
         v0.y + (y + reach) <= window.high_y;
}

}  // namespace

std::vector<char> known_facets(const prescription::PointCloud& places, const std::vector<RawFacet>& facets, const Rectangle& window) {
  std::vector<char> is_open(places.points.size(), false);  // vertices with a facet around them that is not certain, or none
  for (const RawFacet& facet : facets) {
    const auto& [v0, v1, v2] = facet.corner;
    const bool is_certain = has_its_disc_within(window, places.points[v0], places.points[v1], places.points[v2]);
    for (std::size_t i = 0; i < 3; ++i)
      if (!is_certain || facet.neighbour[i] == surface::no_facet) is_open[facet.corner[(i + 1) % 3]] = is_open[facet.corner[(i + 2) % 3]] = true;
  }
  std::vector<char> is_known(facets.size());
  std::transform(facets.begin(), facets.end(), is_known.begin(), [&](const RawFacet& facet) {
    return std::none_of(facet.corner.begin(), facet.corner.end(), [&](std::uint32_t v) { return is_open[v]; });
  });
  return is_known;
}

}  // namespace sagitta::scene
