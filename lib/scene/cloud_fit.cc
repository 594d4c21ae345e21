// SPDX-License-Identifier: Apache-2.0
#include "lib/scene/cloud_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "lib/scene/least_squares_internal.h"

namespace sagitta::scene {
namespace {

using numerics::Vec3;

// Second derivatives at the origin of the fitted polynomial in (x, y) of the given degree.
template <class Indices>
std::optional<VertexCurvatures> second_derivatives(const std::vector<Vec3<double>>& points, const Indices& used, double scale, int degree) {
  LeastSquares fit((degree + 1) * (degree + 2) / 2);
  for (const std::uint32_t i : used) {
    auto row = fit.next_row();
    const double x = points[i].x / scale, y = points[i].y / scale;
    Eigen::Index term = 0;
    double x_power = 1;
    for (int a = 0; a <= degree; ++a, x_power *= x) {
      double power = x_power;
      for (int b = 0; a + b <= degree; ++b, power *= y) row(term++) = power;
    }
    row(term) = points[i].z;
  }
  const auto solution = fit.solve();
  if (!solution) return std::nullopt;
  const auto per_square = [&](Eigen::Index of) { return 2 * (*solution)(of) / scale / scale; };
  return VertexCurvatures{per_square(2 * degree + 1), per_square(2)};  // terms run 1, y, y^2, ..., x, x y, ..., x^2, ...
}

// A radius about the origin within which there are likely `count` points and more, by a sample of them; infinite where the
// sample does not tell, or tells no more than `reach`.
double wider(const std::vector<Vec3<double>>& points, double reach, std::size_t count) {
  const std::vector<Vec3<double>> some = sample_of(points);
  if (some.empty()) return std::numeric_limits<double>::infinity();
  const std::size_t wanted = 16 + 2 * count * some.size() / points.size();
  if (wanted >= some.size()) return std::numeric_limits<double>::infinity();
  std::vector<double> distances(some.size());
  std::transform(some.begin(), some.end(), distances.begin(), [](const auto& p) { return std::hypot(p.x, p.y); });
  const auto at = distances.begin() + static_cast<std::ptrdiff_t>(wanted);
  std::nth_element(distances.begin(), at, distances.end());
  return *at > reach ? *at : std::numeric_limits<double>::infinity();
}

}  // namespace

std::vector<Vec3<double>> sample_of(const std::vector<Vec3<double>>& points) {
  constexpr std::size_t enough = 1 << 16;
  std::vector<Vec3<double>> some;
  for (std::size_t stride = 1 + points.size() / enough; some.empty() && stride > 0; stride /= 2)  // a sample may be all holes
    for (std::size_t i = 0; i < points.size(); i += stride)
      if (!std::isnan(points[i].z)) some.push_back(points[i]);
  return some;
}

surface::BaseSphere fit_base_sphere(const std::vector<Vec3<double>>& all_points, const Vec3<double>& centre) {
  std::vector<Vec3<double>> points = sample_of(all_points);
  for (auto& p : points) p = p - centre;
  double scale = 0;
  for (const auto& p : points) scale = std::max({scale, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  double mean = 0;
  LeastSquares sphere(4), plane(3);
  for (const auto& p : points) {
    const Vec3<double> q = (1 / scale) * p;
    mean += p.z / static_cast<double>(points.size());
    sphere.next_row() << dot(q, q) / 2, q.x, q.y, 1, q.z;
    plane.next_row() << q.x, q.y, 1, q.z;
  }
  if (const auto s = sphere.solve()) return {(*s)(0) / scale, (*s)(1), (*s)(2), (*s)(3) * scale};
  if (const auto s = plane.solve()) return {0, (*s)(0), (*s)(1), (*s)(2) * scale};
  return {0, 0, 0, mean};
}

VertexCurvatures vertex_curvatures(const prescription::PointCloud& cloud, double beam_radius) {
  const auto& points = cloud.points;
  const auto distance = [&](std::uint32_t i) { return std::hypot(points[i].x, points[i].y); };
  // Those within a radius, by passes that read on and do little: of a large cloud all but a few are far away.
  std::vector<std::uint32_t> near;
  const auto gather = [&](double radius) {
    near.clear();
    const double bound = radius * radius * (1 + 1e-12);
    for (std::uint32_t i = 0; i < points.size(); ++i) {
      const auto& p = points[i];
      if (p.x * p.x + p.y * p.y <= bound && !std::isnan(p.z)) near.push_back(i);
    }
  };
  constexpr double all = std::numeric_limits<double>::infinity();
  constexpr std::size_t least = 100;
  double reach = beam_radius >= 0 ? beam_radius / 2 : 0;
  gather(reach);
  std::size_t count = static_cast<std::size_t>(std::count_if(near.begin(), near.end(), [&](std::uint32_t i) { return distance(i) <= beam_radius / 2; }));
  for (count = std::max(count, least);; count *= 2) {
    while (near.size() < count && reach < all) gather(reach = wider(points, reach, count));
    count = std::min(count, near.size());
    const auto end = near.begin() + static_cast<std::ptrdiff_t>(count);
    const auto is_nearer = [&](std::uint32_t a, std::uint32_t b) {
      const double da = distance(a), db = distance(b);
      return da != db ? da < db : a < b;
    };
    if (count < near.size()) std::nth_element(near.begin(), end, near.end(), is_nearer);
    const std::vector<std::uint32_t> used(near.begin(), end);
    double scale = 0;
    for (const std::uint32_t i : used) scale = std::max(scale, distance(i));
    if (!(scale > 0)) break;
    if (const auto found = second_derivatives(points, used, scale, 4)) return *found;
    if (count < near.size() || reach < all) continue;
    if (const auto found = second_derivatives(points, used, scale, 2)) return *found;
    break;
  }
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  return {none, none};
}

}  // namespace sagitta::scene
