// SPDX-License-Identifier: Apache-2.0
#include "lib/scene/fit_zernike.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "lib/numerics/arena.h"
#include "lib/surface/zernike.h"
#include "tests/support/point_sets.h"

namespace sagitta::scene {
namespace {

using namespace sagitta::tests;
using numerics::ZernikeIndexing;
using ::testing::HasSubstr;
constexpr double infinity = std::numeric_limits<double>::infinity();

constexpr std::array indexings{ZernikeIndexing::osa, ZernikeIndexing::noll, ZernikeIndexing::fringe};

surface::Zernike traced(const ZernikeSurface& fitted, numerics::Arena& arena) {
  return surface::Zernike::from(zernike_shape(fitted).parameters, arena);
}

// A conic at height `vertex` with terms that no conic can take the place of on evenly spaced meridians: m is not 0.
double term_um(ZernikeIndexing indexing, int index) {
  return numerics::zernike_term(indexing, index).m == 0 ? 0 : std::cos(1.7 * index);
}
Height bumpy(ZernikeIndexing indexing, surface::Conic base, double vertex, double radius) {
  return [=](double x, double y) {
    double um = 0;
    for (int j = 0, first = numerics::first_zernike_index(indexing); j < 36; ++j)
      um += term_um(indexing, first + j) * numerics::zernike_value(indexing, numerics::zernike_term(indexing, first + j), x / radius, y / radius);
    return vertex + base.sag(x, y) + 1e-3 * um;
  };
}

// Rounding of heights up to 0.9 mm, 1e-16 mm, enlarged by the condition of the conic's fit (its columns 1, u and u^2 over
// (0, 9 mm^2): below 100) and of the terms' (asserted below 10), and the few hundred operations of QR: 1e-11 mm in height.
constexpr double rounding_um = 1e-8;

TEST(FitZernikeSurface, FindsAConicWithTermsInEveryIndexing) {
  const surface::Conic cornea{1 / 7.72, -0.26};
  int compared = 0;
  for (const ZernikeIndexing indexing : indexings) {
    for (const double vertex : {0.0, 0.25}) {
      const auto fit = fit_zernike_surface(cloud_of(polar_rings(20, 60, 3, true), bumpy(indexing, cornea, vertex, 3)), {36, 3, indexing});
      ASSERT_TRUE(fit.surface) << fit.reason;
      const ZernikeSurface& found = *fit.surface;
      EXPECT_LT(found.condition_number, 10);
      EXPECT_GE(found.condition_number, 1);
      EXPECT_EQ(found.point_count, 1201u);
      EXPECT_NEAR(found.radius_mm, 7.72, 1e-9);  // 1e-11 mm of 0.6 mm, times the radius
      EXPECT_NEAR(found.conic_constant, -0.26, 1e-8);
      EXPECT_NEAR(found.vertex_mm, vertex, 1e-11);
      ASSERT_EQ(found.coefficients_um.size(), 36u);
      for (int j = 0, first = numerics::first_zernike_index(indexing); j < 36; ++j, ++compared)
        EXPECT_NEAR(found.coefficients_um[static_cast<std::size_t>(j)], term_um(indexing, first + j) + (j == 0 ? 1e3 * vertex : 0), rounding_um) << j;
      EXPECT_LE(found.rms_um, rounding_um);
      EXPECT_LE(found.peak_to_valley_um, rounding_um);
      EXPECT_EQ(found.normalization_radius_mm, 3);
      // The coefficients are their own rms in the orthonormal indexings, and the conic leaves just that.
      EXPECT_GT(found.conic_rms_um, 1);
    }
  }
  EXPECT_EQ(compared, 216);
}

// What no conic can give goes into the terms whole: the surface is that of the points, whatever base was found. Of the
// difference between the base found and the true one the terms lack orders 8 and up, first the difference of
// a4 = 5/128 c^7 (1+K)^3 times u^4. Over u = 0 to R^2 a cubic leaves R^8/128 of u^4 at best; least squares within three
// times that, and the orders behind it add less than their first (u (1+K) c^2 < 0.2).
TEST(FitZernikeSurface, FindsASurfaceWithSphericalTermsBetweenItsPointsToo) {
  const surface::Conic cornea{1 / 7.72, -0.26};
  const auto height = [&](double x, double y) {
    double um = 0;
    for (int j = 0; j < 36; ++j) um += std::cos(1.7 * j) * numerics::zernike_value(ZernikeIndexing::osa, numerics::osa_term(j), x / 3, y / 3);
    return cornea.sag(x, y) + 1e-3 * um;
  };
  int layouts = 0;
  for (const Layout& layout : all_layouts(4000)) {
    const auto fit = fit_zernike_surface(cloud_of(layout.places, height), {36, 3});
    ASSERT_TRUE(fit.surface) << layout.name << ": " << fit.reason;
    numerics::Arena arena;
    const auto shape = traced(*fit.surface, arena);
    const auto a4 = [](double c, double K) { return 5.0 / 128 * std::pow(c, 7) * std::pow(1 + K, 3); };
    const double a4_difference = std::abs(a4(1 / fit.surface->radius_mm, fit.surface->conic_constant) - a4(cornea.curvature, cornea.conic_constant));
    const double bound = 2 * 3 * a4_difference * std::pow(3, 8) / 128;
    EXPECT_LT(bound, 1e-5);
    for (const Place2& p : uniform_random(500, 2.1, 5)) EXPECT_NEAR(shape.sag(p.x, p.y), height(p.x, p.y), bound) << layout.name;
    EXPECT_LE(fit.surface->rms_um, 1e3 * bound) << layout.name;
    EXPECT_GT(fit.surface->conic_rms_um, 1) << layout.name;
    ++layouts;
  }
  EXPECT_EQ(layouts, 6);
}

TEST(FitZernikeSurface, FindsConicsOfEveryKindAndTheirSpheres) {
  struct Case {
    double radius, K;
  };
  // The last: so steep that the rim stands at 70 degrees.
  for (const Case& one : {Case{7.8, 0}, Case{-7.8, 0}, Case{8, -1}, Case{-6.5, -0.5}, Case{9, -3}, Case{8, 2}, Case{1e4, 0}, Case{3.2, 0}}) {
    const auto cloud = cloud_of(uniform_random(3000, 3, 7), [&](double x, double y) { return -1.5 + surface::Conic{1 / one.radius, one.K}.sag(x, y); });
    const auto fit = fit_zernike_surface(cloud, {1, 3});
    ASSERT_TRUE(fit.surface) << fit.reason;
    const ZernikeSurface& found = *fit.surface;
    // 1e-14 mm rounding of heights of some mm, over the sag that the radius (sag 4.5/R) and K (sag 10/R^3) make.
    EXPECT_NEAR(found.radius_mm / one.radius, 1, 1e-12 * std::abs(one.radius)) << one.radius << ' ' << one.K;
    EXPECT_NEAR(found.conic_constant, one.K, one.radius == 1e4 ? 20 : 1e-9) << one.radius << ' ' << one.K;
    EXPECT_NEAR(found.vertex_mm, -1.5, 1e-12);
    EXPECT_NEAR(found.coefficients_um[0], -1500, 1e-9);
    EXPECT_LE(found.rms_um, 1e-9);
    if (one.K != 0) continue;
    EXPECT_NEAR(found.sphere_radius_mm / one.radius, 1, 1e-12 * std::abs(one.radius));
    EXPECT_LE(found.sphere_rms_um, 1e-9);
  }
}

TEST(FitZernikeSurface, FindsAPlane) {
  for (const double tilt : {0.0, 0.1}) {
    const auto fit = fit_zernike_surface(cloud_of(polar_rings(10, 40, 3, false), [&](double x, double y) { return 0.25 + tilt * (x - y / 2); }), {36, 3});
    ASSERT_TRUE(fit.surface) << fit.reason;
    EXPECT_EQ(fit.surface->radius_mm, infinity);
    EXPECT_EQ(fit.surface->sphere_radius_mm, infinity);
    EXPECT_EQ(fit.surface->conic_constant, 0);
    EXPECT_NEAR(fit.surface->coefficients_um[0], 250, rounding_um);
    EXPECT_NEAR(fit.surface->coefficients_um[1], -tilt * 3 / 4 * 1e3, rounding_um);  // Z1 = 2 y/R, Z2 = 2 x/R
    EXPECT_NEAR(fit.surface->coefficients_um[2], tilt * 3 / 2 * 1e3, rounding_um);
    for (std::size_t j = 3; j < 36; ++j) EXPECT_NEAR(fit.surface->coefficients_um[j], 0, rounding_um);
  }
}

// Noise of 1 um, so nothing fits: each fit must still be the best of its kind.
class NoisyPoints : public testing::Test {
 protected:
  NoisyPoints() : cloud(cloud_of(uniform_random(5000, 3, 21), [u = Uniform(22)](double x, double y) mutable {
    return surface::Conic{1 / 7.72, -0.26}.sag(x, y) + 2e-3 * x * x * y + u(-1e-3, 1e-3);
  })), result(fit_zernike_surface(cloud, {36, 3})) {}
  template <class Use>
  void for_each_point(Use&& use) const {
    for (const auto& p : cloud.points)
      if (std::hypot(p.x, p.y) <= 3) use(p);
  }
  double rms_um(double vertex, double radius, double K) const {
    double sum = 0;
    for_each_point([&](const auto& p) { sum += std::pow(p.z - vertex - surface::Conic{1 / radius, K}.sag(p.x, p.y), 2); });
    return 1e3 * std::sqrt(sum / static_cast<double>(result.surface->point_count));
  }
  PointCloud cloud;
  ZernikeSurfaceResult result;
};

TEST_F(NoisyPoints, NoSphereAndNoConicNearbyFitsBetter) {
  ASSERT_TRUE(result.surface);
  const ZernikeSurface& found = *result.surface;
  EXPECT_NEAR(rms_um(found.sphere_vertex_mm, found.sphere_radius_mm, 0), found.sphere_rms_um, 1e-9);
  EXPECT_NEAR(rms_um(found.vertex_mm, found.radius_mm, found.conic_constant), found.conic_rms_um, 1e-9);
  EXPECT_LT(found.conic_rms_um, found.sphere_rms_um);
  // Along each parameter the sum of squares is a parabola near its least value; its lowest point must be where the fit says,
  // to 1e-3 of a small step: the third order is that much smaller than the second, and rounding of the sum far below both.
  const auto is_lowest_at = [&](double vertex, double radius, double K, double to_vertex, double to_radius, double to_K) {
    const auto sum = [&](double t) { return std::pow(rms_um(vertex + t * to_vertex, radius + t * to_radius, K + t * to_K), 2); };
    const double before = sum(-1), here = sum(0), after = sum(1);
    EXPECT_GT(before + after - 2 * here, 1e-5 * here);
    EXPECT_NEAR((before - after) / 2 / (before + after - 2 * here), 0, 1e-3) << to_vertex << ' ' << to_radius << ' ' << to_K;
  };
  is_lowest_at(found.sphere_vertex_mm, found.sphere_radius_mm, 0, 1e-4, 0, 0);
  is_lowest_at(found.sphere_vertex_mm, found.sphere_radius_mm, 0, 0, 1e-3, 0);
  is_lowest_at(found.vertex_mm, found.radius_mm, found.conic_constant, 1e-4, 0, 0);
  is_lowest_at(found.vertex_mm, found.radius_mm, found.conic_constant, 0, 1e-3, 0);
  is_lowest_at(found.vertex_mm, found.radius_mm, found.conic_constant, 0, 0, 1e-2);
}

// A paraboloid steeper than any sphere that reaches its rim: full steps would leave the sphere behind.
TEST(FitZernikeSurface, FindsASphereWhereNoneFits) {
  const auto fit = fit_zernike_surface(cloud_of(uniform_random(3000, 3, 7), [](double x, double y) { return (x * x + y * y) / 2 / 1.2; }), {1, 3});
  ASSERT_TRUE(fit.surface) << fit.reason;
  EXPECT_GE(fit.surface->sphere_radius_mm, 2.99);
  EXPECT_LT(fit.surface->sphere_radius_mm, 3.3);
  EXPECT_GT(fit.surface->sphere_rms_um, 1);
  EXPECT_NEAR(fit.surface->radius_mm, 1.2, 1e-9);
  EXPECT_NEAR(fit.surface->conic_constant, -1, 1e-9);
}

// The residual of least squares is orthogonal to every term; with terms of rms 1 and a residual below 1 um the mean product
// is zero to rounding.
TEST_F(NoisyPoints, TheResidualIsOrthogonalToEveryTermAndItsRmsIsTold) {
  ASSERT_TRUE(result.surface);
  numerics::Arena arena;
  const auto shape = traced(*result.surface, arena);
  double squares = 0, low = infinity, high = -infinity;
  std::size_t count = 0;
  std::vector<double> products(36);
  for_each_point([&](const auto& p) {
    const double r = 1e3 * (p.z - shape.sag(p.x, p.y));
    squares += r * r;
    low = std::min(low, r);
    high = std::max(high, r);
    ++count;
    for (int j = 0; j < 36; ++j) products[static_cast<std::size_t>(j)] += r * numerics::zernike_value(ZernikeIndexing::osa, numerics::osa_term(j), p.x / 3, p.y / 3);
  });
  EXPECT_EQ(result.surface->point_count, count);
  EXPECT_GT(count, 3800u);
  EXPECT_NEAR(result.surface->rms_um, std::sqrt(squares / static_cast<double>(count)), 1e-12);
  EXPECT_NEAR(result.surface->rms_um, 1 / std::sqrt(3.0), 0.02);  // of even noise, +-1 um
  EXPECT_NEAR(result.surface->peak_to_valley_um, high - low, 1e-12);
  for (const double product : products) EXPECT_NEAR(product / static_cast<double>(count), 0, 1e-11);
}

TEST_F(NoisyPoints, HolesDoNotCountAndPointsBeyondTheCircleNeither) {
  ASSERT_TRUE(result.surface);
  auto more = cloud;
  for (int i = 0; i < 50; ++i) {
    more.points.push_back({0.02 * i, 0.5, std::numeric_limits<double>::quiet_NaN()});
    more.points.push_back({3.1 + i, 0, 1e12});
  }
  const auto again = fit_zernike_surface(more, {36, 3});
  ASSERT_TRUE(again.surface) << again.reason;
  EXPECT_EQ(again.surface->coefficients_um, result.surface->coefficients_um);
  EXPECT_EQ(again.surface->point_count, result.surface->point_count);
  EXPECT_EQ(again.surface->points.points.size(), result.surface->point_count + 50);
}

TEST(ZernikeShape, HoldsEveryParameterOfThePrescription) {
  const auto fit = fit_zernike_surface(cloud_of(polar_rings(10, 40, 3, false), sphere(8)), {3, 3, ZernikeIndexing::noll});
  ASSERT_TRUE(fit.surface);
  const prescription::Shape shape = zernike_shape(*fit.surface);
  EXPECT_EQ(shape.kind, "zernike");
  EXPECT_EQ(shape.parameters.number("radius_mm"), fit.surface->radius_mm);
  EXPECT_EQ(shape.parameters.number("conic_constant"), fit.surface->conic_constant);
  EXPECT_EQ(shape.parameters.number("normalization_radius_mm"), 3);
  EXPECT_EQ(shape.parameters.text("indexing"), "noll");
  const auto& list = shape.parameters.list("coefficients_um");
  ASSERT_EQ(list.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(list[i], std::pair(static_cast<int>(i) + 1, fit.surface->coefficients_um[i]));
}

// Every refusal with its text.
TEST(FitZernikeSurface, IsRefusedWithTheReason) {
  const Height flat = [](double, double) { return 0.0; };
  const auto reason = [&](const std::vector<Place2>& places, const ZernikeSurfaceRequest& request, const std::string& hint) {
    const auto fit = fit_zernike_surface(cloud_of(places, flat), request);
    EXPECT_FALSE(fit.surface);
    EXPECT_THAT(fit.hint, HasSubstr(hint));
    return fit.reason;
  };
  const auto rings = polar_rings(24, 180, 3, false);
  EXPECT_THAT(reason(rings, {0, 3}, "36"), HasSubstr("the terms of osa may be 1 to 1326, not 0"));
  EXPECT_THAT(reason(rings, {38, 3, ZernikeIndexing::fringe}, "36"), HasSubstr("the terms of fringe may be 1 to 37, not 38"));
  for (const double radius : {0.0, -1.0, infinity, std::nan("")}) EXPECT_THAT(reason(rings, {36, radius}, "3 mm"), HasSubstr("the radius must be positive"));
  EXPECT_THAT(reason(rings, {36, 0.1}, "the nearest lies 0.125 mm from it"), HasSubstr("no point lies within 0.1 mm of the surface's origin"));
  EXPECT_THAT(reason({}, {36, 3}, "no point with a height"), HasSubstr("no point lies within 3 mm"));
  EXPECT_THAT(reason(polar_rings(1, 1, 2, false), {36, 3}, "1 terms or fewer"), HasSubstr("1 point within 3 mm is too few for 36 terms"));
  EXPECT_THAT(reason(polar_rings(5, 7, 3, false), {36, 3}, "35 terms or fewer"), HasSubstr("35 points within 3 mm are too few for 36 terms"));
  EXPECT_THAT(reason(polar_rings(1, 180, 3, false), {36, 3}, "several rings"), HasSubstr("they lie on one ring, 3 to 3 mm from the origin"));
  EXPECT_THAT(reason(polar_rings(1, 180, 3, false), {1, 3}, "several rings"), HasSubstr("do not tell 1 term apart"));
  EXPECT_THAT(reason(polar_rings(3, 180, 3, false), {36, 3}, "fewer terms"), HasSubstr("they lie on 3 rings, and 4 are needed"));
  EXPECT_THAT(reason(rings, {6, 4}, "a radius of 3 mm or less"), HasSubstr("over all of the circle: the outermost lies 3 mm from the origin"));
  EXPECT_THAT(reason(polar_rings(24, 7, 3, false), {36, 3}, "fewer terms"), HasSubstr("a sector of 51 degrees holds none"));
  EXPECT_THAT(reason(regular_grid(8, 8, 2.1, 2.1), {60, 3}, "ask for fewer terms"), HasSubstr("they are too few, or lie on too few rings or lines"));
  std::vector<Place2> half, annulus;
  for (const Place2& p : rings) {
    if (p.x > 0) half.push_back(p);
    if (std::hypot(p.x, p.y) > 2) annulus.push_back(p);
  }
  EXPECT_THAT(reason(half, {36, 3}, "a radius within the data"), HasSubstr("beyond 2.1 mm from the origin a sector of 182 degrees holds none"));
  EXPECT_THAT(reason(annulus, {105, 3}, "nearer to the origin"), HasSubstr("the innermost lies 2.12 mm from the origin"));
  const auto far = fit_zernike_surface(cloud_of(rings, [](double x, double) { return x > 0 ? 0.0 : 1e10; }), {36, 3});
  EXPECT_THAT(far.reason, HasSubstr("is beyond +-1e9 mm"));
  EXPECT_THAT(fit_zernike_surface(cloud_of(rings, [](double, double) { return infinity; }), {36, 3}).reason, HasSubstr("is beyond +-1e9 mm"));
}

}  // namespace
}  // namespace sagitta::scene
