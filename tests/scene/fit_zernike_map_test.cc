// SPDX-License-Identifier: Apache-2.0
#include "lib/scene/fit_zernike_map.h"

#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "lib/numerics/arena.h"
#include "lib/prescription/cloud_reader.h"
#include "lib/surface/zernike.h"
#include "tests/support/point_sets.h"

namespace sagitta::scene {
namespace {

using namespace sagitta::tests;

float at(const ResidualMap& map, double x, double y) {
  const int half = (map.size - 1) / 2;
  const int i = half + static_cast<int>(std::lround(x / map.pixel_mm)), j = half - static_cast<int>(std::lround(y / map.pixel_mm));
  return map.residual_um[static_cast<std::size_t>(j * map.size + i)];
}

// Three terms cannot follow a step of 2 um in z at y > 2: measured - fitted is larger there, and where it is depends on no
// convention but y up.
TEST(ResidualMap, ShowsMeasuredMinusFittedAtItsPlaceAndNothingElse) {
  auto cloud = cloud_of(regular_grid(61, 61, 3, 3), [](double, double y) { return y > 2 ? 2e-3 : 0.0; });
  for (auto& p : cloud.points)
    if (std::hypot(p.x - 1.5, p.y + 1) < 0.35) p.z = std::nan("");
  const auto fit = fit_zernike_surface(cloud, {1, 3});
  ASSERT_TRUE(fit.surface) << fit.reason;
  const auto made = residual_map(*fit.surface);
  ASSERT_TRUE(made.map);
  const ResidualMap& map = *made.map;
  EXPECT_EQ(map.size, 257);
  EXPECT_EQ(map.residual_um.size(), 257u * 257u);
  EXPECT_DOUBLE_EQ(map.pixel_mm, 3.0 / 128);
  EXPECT_GT(at(map, 0, 2.5), 0);
  EXPECT_TRUE(std::isnan(at(map, 1.5, -1)));   // a hole
  EXPECT_FALSE(std::isnan(at(map, -1.5, -1)));
  EXPECT_FALSE(std::isnan(at(map, -1.5, 1)));
  EXPECT_TRUE(std::isnan(at(map, 2.9, 2.9)));  // beyond the circle
  // Facets reach the circle but for less than a spacing, 0.1 mm; the hole is 0.6 to 0.9 mm wide.
  EXPECT_GT(map.coverage, 1 - 2 * 0.1 / 3 - 0.9 * 0.9 / (9 * 3.14));
  EXPECT_LT(map.coverage, 1 - 0.6 * 0.6 / 4 * 3.14 / (9 * 3.14));
  // At the points, which are at multiples of 0.1 mm, it is the residual itself: (0, 0) is one.
  numerics::Arena arena;
  const auto shape = surface::Zernike::from(zernike_shape(*fit.surface).parameters, arena);
  EXPECT_FLOAT_EQ(at(map, 0, 0), static_cast<float>(-1e3 * shape.sag(0.0, 0.0)));
}

// Inside a facet the map is linear: 1 um at one point of a plane and 0 around it is a pyramid.
TEST(ResidualMap, IsLinearBetweenThePoints) {
  auto cloud = cloud_of(regular_grid(13, 13, 3, 3), [](double, double) { return 0.0; });
  const auto fit = fit_zernike_surface(cloud, {1, 3.5});
  ASSERT_TRUE(fit.surface) << fit.reason;
  ZernikeSurface surface = *fit.surface;
  for (auto& p : surface.points.points)
    if (p.x == 0 && p.y == 0) p.z = 1e-3;
  const auto made = residual_map(surface);
  ASSERT_TRUE(made.map);
  for (const double share : {0.25, 0.5, 0.75}) {  // along the lines of the grid, which are edges whatever the diagonals
    const double x = made.map->pixel_mm * std::round(0.5 * share / made.map->pixel_mm);
    EXPECT_NEAR(at(*made.map, x, 0), 1 - x / 0.5, 1e-6);
    EXPECT_NEAR(at(*made.map, 0, -x), 1 - x / 0.5, 1e-6);
  }
  EXPECT_NEAR(at(*made.map, 0.6, 0), 0, 1e-12);
}

TEST(ResidualMap, SaysWhatTheTriangulationRefuses) {
  auto cloud = cloud_of(polar_rings(20, 60, 3, true), sphere(8));
  cloud.points.push_back(cloud.points[100]);
  cloud.points.back().z += 1e-3;
  cloud.lines.push_back(1202);
  const auto fit = fit_zernike_surface(cloud, {36, 3});
  ASSERT_TRUE(fit.surface);
  const auto made = residual_map(*fit.surface);
  EXPECT_FALSE(made.map);
  ASSERT_TRUE(made.findings.has_errors());
  EXPECT_THAT(made.findings.all().front().what, testing::HasSubstr("two heights at one place"));
  EXPECT_EQ(made.findings.all().front().place.line, 1202);
}

// The corneas of references.md, section 5.2, whose exact surfaces are known: in OSA axes, x to the examiner's right, sag
// into the eye, mm.
double normal_cornea(double x, double y) {
  constexpr double radius_x = 7.83, radius_y = 7.70, one_plus_K = 1 - 0.18;
  const double base = (x * x / radius_x + y * y / radius_y) /
                      (1 + std::sqrt(1 - one_plus_K * (x * x / (radius_x * radius_x) + y * y / (radius_y * radius_y))));
  struct Term {
    int n, m;
    double um;
  };
  double um = 0;
  for (const Term& t : {Term{3, -3, -.10}, Term{3, -1, -.35}, Term{3, 1, .12}, Term{3, 3, .05}, Term{4, -4, .03}, Term{4, -2, -.02},
                        Term{4, 2, -.04}, Term{4, 4, .04}, Term{5, -1, .02}, Term{5, 1, -.01}, Term{6, 0, .01}})
    um += t.um * numerics::zernike_value(numerics::ZernikeIndexing::osa, {t.n, t.m}, x / 3, y / 3);
  return base + 1e-3 * um;
}
double keratoconus(double x, double y) { return normal_cornea(x, y) - 25e-3 * std::exp(-(std::pow(x + 0.6, 2) + std::pow(y + 1.1, 2)) / 2); }

std::shared_ptr<const PointCloud> shared_cloud(const std::string& name, const std::string& format) {
  const char* given = std::getenv("SAGITTA_SHARED");
  const std::filesystem::path file = std::filesystem::path(given ? given : SAGITTA_SOURCE_DIR "/../shared") / "data" / name;
  if (!std::filesystem::exists(file)) return nullptr;
  prescription::Findings findings;
  return prescription::read_cloud({file.string(), format, format == "xyz"}, findings);
}

// Of both surfaces the 36 terms lack orders 8 and up: of the biconic below 1e-4 um (its astigmatism's 8th order), of the cone
// what is left anyway, 0.2 um rms.
TEST(FitZernikeSurface, FindsTheCorneasWhoseExactSurfaceIsKnown) {
  const auto normal = shared_cloud("synthetic/normal_clean.csv", "xyz"), cone = shared_cloud("synthetic/keratoconus_clean.csv", "xyz");
  if (!normal || !cone) GTEST_SKIP() << "data/synthetic is not there (the test data are optional)";
  const auto fit = fit_zernike_surface(*normal, {36, 3});
  ASSERT_TRUE(fit.surface) << fit.reason;
  numerics::Arena arena;
  const auto shape = surface::Zernike::from(zernike_shape(*fit.surface).parameters, arena);
  int compared = 0;
  for (const Place2& p : uniform_random(2000, 2.9, 31)) {
    if (std::hypot(p.x, p.y) > 2.8) continue;
    EXPECT_NEAR(shape.sag(p.x, p.y), normal_cornea(-p.x, p.y), 1e-6);  // local x points to the examiner's left
    ++compared;
  }
  EXPECT_GT(compared, 1300);
  EXPECT_LE(fit.surface->rms_um, 1e-3);
  EXPECT_LT(fit.surface->condition_number, 10);

  int points = 0;
  for (const auto& p : cone->points) {
    if (std::isnan(p.z) || std::hypot(p.x, p.y) > 3) continue;
    EXPECT_NEAR(p.z, keratoconus(-p.x, p.y), 2e-9);  // the file has 9 decimals, and so its x and y
    ++points;
  }
  EXPECT_GT(points, 2000);
  const auto of_the_cone = fit_zernike_surface(*cone, {36, 3});
  ASSERT_TRUE(of_the_cone.surface) << of_the_cone.reason;
  EXPECT_GT(of_the_cone.surface->rms_um, 0.1);  // rings lie closer around the apex than over the cone's flank
  EXPECT_LT(of_the_cone.surface->rms_um, 0.25);
}

// "Zernike residual 0.201 um rms after 36 terms" (references.md, 5.2) is over the area, so over an even grid.
TEST(FitZernikeSurface, LeavesOfAConeWhatIsPublished) {
  const auto fit = fit_zernike_surface(cloud_of(regular_grid(121, 121, 3, 3), [](double x, double y) { return keratoconus(-x, y); }), {36, 3});
  ASSERT_TRUE(fit.surface) << fit.reason;
  EXPECT_NEAR(fit.surface->rms_um, 0.201, 0.002);  // a percent: the grid's share of the rim
}

// As devices export them. What they leave is the noise of such a device and what 36 terms cannot follow: microns, not mm.
TEST(FitZernikeSurface, TakesRealAndNoisyCorneas) {
  struct Case {
    const char *name, *format;
    double most_rms_um;
  };
  int fitted = 0;
  for (const Case& one : {Case{"corneas/N01.txt", "cso", 1}, Case{"corneas/K02.txt", "cso", 2}, Case{"synthetic/normal_noisy.csv", "xyz", 0.5},
                          Case{"synthetic/keratoconus_noisy.csv", "xyz", 1}, Case{"synthetic/postlasik_clean.csv", "xyz", 2},
                          Case{"synthetic/postlasik_noisy.csv", "xyz", 2}}) {
    const auto cloud = shared_cloud(one.name, one.format);
    if (!cloud) continue;
    for (const int terms : {36, 66})
      for (const double radius : {2.0, 2.5, 3.0, 4.0}) {
        const auto fit = fit_zernike_surface(*cloud, {terms, radius});
        ASSERT_TRUE(fit.surface) << one.name << ' ' << radius << ": " << fit.reason;
        EXPECT_GT(fit.surface->radius_mm, 7) << one.name << ' ' << radius;  // of a cornea
        EXPECT_LT(fit.surface->radius_mm, 10) << one.name << ' ' << radius;
        EXPECT_LT(std::abs(fit.surface->conic_constant), 6) << one.name << ' ' << radius;
        EXPECT_LT(fit.surface->rms_um, one.most_rms_um) << one.name << ' ' << radius;
        EXPECT_LE(fit.surface->rms_um, fit.surface->conic_rms_um);
        EXPECT_LE(fit.surface->conic_rms_um, fit.surface->sphere_rms_um);
        const auto made = residual_map(*fit.surface);
        ASSERT_TRUE(made.map) << one.name;
        EXPECT_GT(made.map->coverage, 0.75) << one.name << ' ' << radius;
        ++fitted;
      }
  }
  if (fitted == 0) GTEST_SKIP() << "data/corneas and data/synthetic are not there (the test data are optional)";
  EXPECT_EQ(fitted, 48);
}

}  // namespace
}  // namespace sagitta::scene
