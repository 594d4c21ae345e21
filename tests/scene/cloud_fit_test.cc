// SPDX-License-Identifier: Apache-2.0
#include "lib/scene/cloud_fit.h"

#include <gtest/gtest.h>

#include <limits>

#include "lib/surface/conic.h"
#include "tests/support/point_sets.h"

namespace sagitta::scene {
namespace {

using namespace sagitta::tests;
using V = numerics::Vec3<double>;

double quartic(double x, double y) {
  return 1 + 0.1 * x - 0.2 * y + 0.05 * x * x + 0.03 * x * y + 0.07 * y * y + 0.01 * y * y * y - 0.002 * x * x * y * y +
         0.003 * y * y * y * y;
}

TEST(VertexCurvature, OfAQuarticIsExact) {
  for (const Layout& layout : all_layouts(2000)) {
    // 1e-12: the fit solves for terms of size 1 in heights rounded to 2e-16, at a condition below 1e3.
    EXPECT_NEAR(vertex_curvatures(cloud_of(layout.places, quartic), 4).y, 0.14, 1e-12) << layout.name;
    EXPECT_NEAR(vertex_curvatures(cloud_of(layout.places, quartic), 1e9).y, 0.14, 1e-12) << layout.name;
    EXPECT_NEAR(vertex_curvatures(cloud_of(layout.places, quartic), 4).x, 0.1, 1e-12) << layout.name;
  }
}

TEST(VertexCurvature, OfACorneaIsItsVertexCurvature) {
  const auto cornea = [](double x, double y) { return surface::Conic{1 / 7.72, -0.26}.sag(x, y); };
  // Within 1 mm what a quartic leaves out is the sixth order, c^5 r^6/16, about 2e-6 mm at the rim.
  EXPECT_NEAR(vertex_curvatures(cloud_of(polar_rings(24, 180, 5, false), cornea), 2).y, 1 / 7.72, 2e-6);
}

TEST(VertexCurvature, TakesTheNearestHundredWhereTheBeamHoldsFewer) {
  // Beyond the nearest hundred the surface is another one.
  const auto grid = regular_grid(41, 41, 20, 20);
  const auto cloud = cloud_of(grid, [](double x, double y) { return std::hypot(x, y) < 5.7 ? 0.05 * y * y : 77; });
  EXPECT_NEAR(vertex_curvatures(cloud, 1).y, 0.1, 1e-12);
  EXPECT_NEAR(vertex_curvatures(cloud, 0).y, 0.1, 1e-12);
  EXPECT_NEAR(vertex_curvatures(cloud, std::numeric_limits<double>::quiet_NaN()).y, 0.1, 1e-12);
  EXPECT_GT(std::abs(vertex_curvatures(cloud, 20).y - 0.1), 1e-3);
}

TEST(VertexCurvature, OfFewPointsIsAQuadraticsOrNone) {
  const auto quadratic = [](double x, double y) { return 0.3 * x * x + 0.2 * x * y + 0.05 * y * y - x; };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NEAR(vertex_curvatures(cloud_of(uniform_random(8, 1, 5), quadratic), 1).y, 0.1, 1e-12);
  EXPECT_NEAR(vertex_curvatures(cloud_of(uniform_random(8, 1, 5), quadratic), 1).x, 0.6, 1e-12);
  EXPECT_TRUE(std::isnan(vertex_curvatures(cloud_of(uniform_random(5, 1, 5), quadratic), 1).y));
  EXPECT_TRUE(std::isnan(vertex_curvatures(cloud_of({}, quadratic), 1).y));
  auto holes = cloud_of(uniform_random(20, 1, 5), quadratic);
  for (std::size_t i = 5; i < 20; ++i) holes.points[i].z = nan;
  EXPECT_TRUE(std::isnan(vertex_curvatures(holes, 1).y));
}

TEST(VertexCurvature, LooksFurtherWhereTheNearestPointsAreOneRing) {
  EXPECT_NEAR(vertex_curvatures(cloud_of(polar_rings(24, 256, 5, false), quartic), 0.1).y, 0.14, 1e-10);
}

TEST(BaseSphere, IsExactForASphereAndAPlane) {
  const auto cap = cloud_of(uniform_random(500, 3, 1), sphere(-7.8));
  const auto fit = fit_base_sphere(cap.points, {0.5, 0.2, -0.3});
  const surface::Conic exact{-1 / 7.8, 0};
  const auto plane = cloud_of(uniform_random(500, 3, 1), [](double x, double y) { return 0.1 * x + 0.5 * y - 2; });
  const auto flat = fit_base_sphere(plane.points, {0, 0, -2});
  EXPECT_NEAR(flat.c, 0, 1e-14);
  Uniform u(2);
  for (int i = 0; i < 100; ++i) {
    const V d = numerics::normalized(V{u(-1, 1), u(-1, 1), i % 2 ? 2.0 : -2.0}), p{u(-2, 2), u(-2, 2), u(-5, 5)};
    const auto right = exact.meet(p, d);
    ASSERT_EQ(right.status, surface::Status::ok);
    EXPECT_NEAR(fit.path(p - V{0.5, 0.2, -0.3}, d), right.path, 1e-12);
    EXPECT_NEAR(flat.path(p - V{0, 0, -2}, d), (0.1 * p.x + 0.5 * p.y - 2 - p.z) / (d.z - 0.1 * d.x - 0.5 * d.y), 1e-12);
  }
}

}  // namespace
}  // namespace sagitta::scene
