// SPDX-License-Identifier: Apache-2.0
#include "lib/scene/smooth.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <limits>
#include <numbers>

#include "lib/prescription/cloud_reader.h"
#include "lib/scene/fit_patches.h"
#include "lib/scene/triangulate_smoothed.h"
#include "lib/surface/patches.h"
#include "tests/support/point_sets.h"

namespace sagitta::scene {
namespace {

using namespace tests;
constexpr double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();

// Numbers of a normal distribution, the same on every machine.
class Normal {
 public:
  explicit Normal(std::uint64_t seed) : uniform_(seed) {}
  double operator()() { return std::sqrt(-2 * std::log(1 - uniform_())) * std::cos(2 * std::numbers::pi * uniform_()); }

 private:
  Uniform uniform_;
};

PointCloud noisy(PointCloud cloud, double sigma, std::uint64_t seed) {
  Normal normal(seed);
  for (auto& p : cloud.points) p.z += sigma * normal();
  return cloud;
}

SmoothedTriangulation smoothed(const PointCloud& cloud, double rms) {
  auto result = triangulate_smoothed(std::make_shared<PointCloud>(cloud), inf, rms);
  EXPECT_TRUE(result.triangulation.mesh) << "not triangulated";
  return result;
}

// A cornea: 7.8 mm, with coma and trefoil of some um.
double cornea(double x, double y) {
  return sphere(7.8)(x, y) + 2e-4 * x * (x * x + y * y) - 1e-4 * (x * x * x - 3 * x * y * y) + 3e-5 * (x * x + y * y) * (x * x + y * y);
}

struct Errors {
  double sag = 0, slope = 0;  // rms against the exact surface, mm and 1
};
Errors errors_of(const Triangulation& made, const Height& exact, double radius) {
  const auto patches = fit_patches(made.mesh->mesh).patches;
  const surface::Patches c1{{&made.mesh->mesh}, patches.data()};
  Errors sums;
  int count = 0;
  const double h = 1e-4;  // slopes of the exact surface by differences, right to 1e-9
  for (double x = -radius; x <= radius; x += 0.0371)
    for (double y = -radius; y <= radius; y += 0.0373) {
      if (x * x + y * y > radius * radius) continue;
      const auto slope = c1.gradient(x, y);
      sums.sag += std::pow(c1.sag(x, y) - exact(x, y), 2);
      sums.slope += std::pow(slope.x - (exact(x + h, y) - exact(x - h, y)) / (2 * h), 2) + std::pow(slope.y - (exact(x, y + h) - exact(x, y - h)) / (2 * h), 2);
      ++count;
    }
  EXPECT_GT(count, 10000);
  return {std::sqrt(sums.sag / count), std::sqrt(sums.slope / count)};
}

// White noise of 0.25 um, that of real topographers, on 24 rings x 180 meridians: with smoothing by as much, what README
// states of the synthetic corneas below holds, 5 times less error of sag and 30 times less of slope.
TEST(Smoothing, brings_back_the_surface_under_noise) {
  const PointCloud cloud = noisy(cloud_of(polar_rings(24, 180, 4.5, false), cornea), 2.5e-4, 7);
  const Errors before = errors_of(smoothed(cloud, 0).triangulation, cornea, 3.5), after = errors_of(smoothed(cloud, 2.5e-4).triangulation, cornea, 3.5);
  std::printf("[ report   ] sag error %.4f -> %.4f um rms, slope error %.4f -> %.4f mrad rms\n", 1e3 * before.sag, 1e3 * after.sag, 1e3 * before.slope, 1e3 * after.slope);
  EXPECT_LT(5 * after.sag, before.sag);
  EXPECT_LT(30 * after.slope, before.slope);
}

// Counted independently: over the points of the surface, smoothed against given.
TEST(Smoothing, leaves_the_points_by_the_rms_that_is_asked_for) {
  for (const auto& layout : all_layouts(2500)) {
    const PointCloud cloud = noisy(cloud_of(layout.places, cornea), 3e-4, 3);
    for (const double rms : {1e-7, 3e-5, 3e-4, 1e-3}) {
      const auto result = smoothed(cloud, rms);
      ASSERT_TRUE(result.smoothing);
      double squares = 0, most = 0;
      int moved = 0;
      for (std::size_t i = 0; i < cloud.points.size(); ++i) {
        EXPECT_EQ(result.cloud->points[i].x, cloud.points[i].x);
        EXPECT_EQ(result.cloud->points[i].y, cloud.points[i].y);
        const double residual = result.cloud->points[i].z - cloud.points[i].z;
        squares += residual * residual;
        most = std::max(most, std::abs(residual));
        moved += residual != 0;
      }
      const auto vertex_count = result.triangulation.mesh->mesh.vertex_count;
      EXPECT_LE(static_cast<std::uint32_t>(moved), vertex_count);
      EXPECT_GT(static_cast<std::uint32_t>(moved), vertex_count * 9 / 10);
      EXPECT_NEAR(std::sqrt(squares / vertex_count), rms, 1e-5 * rms) << layout.name;  // the header's 1e-6, and rounding of 1e-16 mm in 1e-7
      EXPECT_NEAR(result.smoothing->residual_rms, std::sqrt(squares / vertex_count), 1e-6 * rms);
      EXPECT_NEAR(result.smoothing->residual_max, most, 1e-6 * rms);
      EXPECT_EQ(result.smoothing->requested, rms);
      EXPECT_TRUE(std::isfinite(result.smoothing->lambda));
    }
  }
}

// The smoothing spline in the plane waves of an unbounded grid, q points per mm^2: (1) multiplies a wave of wave number k
// by 1/(1 + lambda k^4/q), whichever way it runs. Spacing h: differences see k^4 too small by (k h)^2/6 (each second
// derivative by (k h)^2/12), 1.6 % for k h = 0.31; the fits over both rings' distances add as much again. The rim is kept
// away by ten decay lengths (lambda/q)^(1/4) sqrt(2) = 0.4 mm.
TEST(Smoothing, damps_waves_as_the_spline_of_thin_plates_does) {
  const double h = 0.1, q = 1 / (h * h), amplitude = 1e-3;
  for (const double angle : {0.0, 0.4, std::numbers::pi / 4}) {
    const double k = 3.1, kx = k * std::cos(angle), ky = k * std::sin(angle);
    const auto wave = [&](double x, double y) { return amplitude * std::cos(kx * x + ky * y); };
    const auto result = smoothed(cloud_of(regular_grid(121, 121, 6, 6), wave), 0.3 * amplitude);
    const double factor = 1 / (1 + result.smoothing->lambda * std::pow(k, 4) / q);
    double along = 0, whole = 0;
    int count = 0;
    for (const auto& p : result.cloud->points) {
      if (std::max(std::abs(p.x), std::abs(p.y)) > 2) continue;
      along += p.z * wave(p.x, p.y);
      whole += wave(p.x, p.y) * wave(p.x, p.y);
      ++count;
    }
    EXPECT_EQ(count, 41 * 41);
    EXPECT_GT(factor, 0.3);
    EXPECT_LT(factor, 0.8);
    EXPECT_NEAR(along / whole / factor, 1, 0.03) << angle;
  }
}

TEST(Smoothing, by_nothing_is_bit_identical_to_none) {
  const PointCloud cloud = noisy(cloud_of(polar_rings(12, 60, 4.5, true), cornea), 2.5e-4, 7);
  const auto none = triangulate(cloud);
  const auto result = smoothed(cloud, 0);
  EXPECT_FALSE(result.smoothing);
  ASSERT_EQ(result.triangulation.mesh->vertices.size(), none.mesh->vertices.size());
  EXPECT_EQ(std::memcmp(result.triangulation.mesh->vertices.data(), none.mesh->vertices.data(), none.mesh->vertices.size() * sizeof(none.mesh->vertices[0])), 0);
}

// A sphere is its own best-fit sphere, a plane its own plane: nothing to smooth, whatever is allowed. 1e-14 of the size.
TEST(Smoothing, leaves_spheres_and_planes_as_they_are) {
  for (const Height& shape : {Height(sphere(7.8)), Height(sphere(-30)), Height([](double x, double y) { return 0.2 * x - 0.1 * y + 3; })}) {
    const PointCloud cloud = cloud_of(uniform_random(800, 3, 4), shape);
    const auto result = smoothed(cloud, 1e-3);
    EXPECT_LT(result.smoothing->residual_max, 1e-13);
    EXPECT_EQ(result.smoothing->lambda, inf);
  }
}

// More than the limit leaves: the limit, a sphere plus a plane, and the points stay within the request.
TEST(Smoothing, ends_at_the_limit_and_comes_near_it) {
  const PointCloud cloud = noisy(cloud_of(uniform_random(1500, 4, 9), cornea), 3e-4, 5);
  const auto limit = smoothed(cloud, 1);
  EXPECT_EQ(limit.smoothing->lambda, inf);
  EXPECT_LT(limit.smoothing->residual_rms, 0.1);
  for (const double share : {0.5, 0.9, 0.99, 0.999}) {
    const auto near = smoothed(cloud, share * limit.smoothing->residual_rms);
    EXPECT_TRUE(std::isfinite(near.smoothing->lambda));
    EXPECT_NEAR(near.smoothing->residual_rms, share * limit.smoothing->residual_rms, 1e-5 * limit.smoothing->residual_rms) << share;
  }
}

// Two islands, z = 0.1 y and z = -0.1 y: by symmetry the best sphere is the plane z = 0, and each island a plane of its own.
TEST(Smoothing, has_a_limit_for_every_piece_of_the_surface) {
  auto places = regular_grid(11, 11, 1, 1);
  for (Place2& p : places) p.x -= 3;
  for (const Place2& p : regular_grid(11, 11, 1, 1)) places.push_back({p.x + 3, p.y});
  places.push_back({0, 5});  // no part of the surface: it stays
  const PointCloud cloud = cloud_of(places, [](double x, double y) { return x < 0 ? 0.1 * y : -0.1 * y; });
  const auto result = triangulate_smoothed(std::make_shared<PointCloud>(cloud), 0.5, 1e-3);
  EXPECT_EQ(result.triangulation.mesh->mesh.facet_count, 400u);
  EXPECT_LT(result.smoothing->residual_max, 1e-14);
  EXPECT_EQ(result.cloud->points.back(), cloud.points.back());
}

TEST(Smoothing, turns_with_the_points) {
  for (const auto& places : {uniform_random(1500, 4, 21), scan_lines(30, 400, 4, 22)}) {  // one even, one 20 times denser along x
    const PointCloud cloud = noisy(cloud_of(places, cornea), 2.5e-4, 6);
    PointCloud turned = cloud;
    const double c = std::cos(0.7), s = std::sin(0.7);
    for (auto& p : turned.points) p = {c * p.x - s * p.y, s * p.x + c * p.y, p.z};
    const auto a = smoothed(cloud, 2.5e-4), b = smoothed(turned, 2.5e-4);
    // The rms is met to 1e-6, where lambda changes by 1e-3 of itself at most, and the smoothed heights (of 1e-3 mm over the
    // sphere) by 1e-5 of that.
    int compared = 0;
    for (std::size_t i = 0; i < places.size(); ++i) {
      if (std::hypot(places[i].x, places[i].y) > 3.5) continue;
      EXPECT_NEAR(a.cloud->points[i].z, b.cloud->points[i].z, 1e-8);
      ++compared;
    }
    EXPECT_GT(compared, 800);
  }
}

TEST(Smoothing, keeps_holes_missing_sectors_and_repeated_points) {
  PointCloud cloud = noisy(cloud_of(polar_rings(20, 90, 4, false), cornea), 2.5e-4, 2);
  int holes = 0;
  for (auto& p : cloud.points) {
    const bool lid = p.y > 2.8, sector = p.x > 1 && std::abs(p.y) < 0.4 * p.x - 0.3;
    if (lid || sector) p.z = nan, ++holes;
  }
  EXPECT_GT(holes, 200);
  for (const std::size_t i : {5u, 700u}) cloud.points.push_back(cloud.points[i]), cloud.lines.push_back(0);
  const auto none = smoothed(cloud, 0), result = smoothed(cloud, 2.5e-4);
  const surface::Mesh &before = none.triangulation.mesh->mesh, &after = result.triangulation.mesh->mesh;
  ASSERT_EQ(before.facet_count, after.facet_count);
  for (std::uint32_t f = 0; f < before.facet_count; ++f) ASSERT_EQ(before.corners[f], after.corners[f]);
  for (std::size_t i = 0; i < cloud.points.size(); ++i) EXPECT_EQ(std::isnan(cloud.points[i].z), std::isnan(result.cloud->points[i].z));
  EXPECT_EQ(result.cloud->points[cloud.points.size() - 2], result.cloud->points[5]);
  EXPECT_EQ(result.cloud->points[cloud.points.size() - 1], result.cloud->points[700]);
  EXPECT_NE(result.cloud->points[5].z, cloud.points[5].z);
  EXPECT_NEAR(result.smoothing->residual_rms, 2.5e-4, 1e-9);
  EXPECT_EQ(result.triangulation.findings.all().size(), none.triangulation.findings.all().size());  // told once
}

// A quadratic cannot be told from four points: they stay. Scales far from a cornea's.
TEST(Smoothing, takes_what_is_small_and_what_is_out_of_scale) {
  const auto four = smoothed(cloud_of({{0, 0}, {1, 0}, {0, 1}, {1, 1}}, [](double x, double y) { return x * y; }), 0.01);
  EXPECT_EQ(four.smoothing->residual_max, 0);
  for (const double scale : {1e-6, 1e-3, 1e6, 1e8}) {
    PointCloud cloud = noisy(cloud_of(uniform_random(300, 4, 9), cornea), 3e-4, 5);
    for (auto& p : cloud.points) p = scale * p;
    const auto result = smoothed(cloud, 3e-4 * scale);
    ASSERT_TRUE(result.smoothing) << scale;
    EXPECT_NEAR(result.smoothing->residual_rms / scale, 3e-4, 1e-8) << scale;
  }
}

// The synthetic corneas with noise in height and radius, not part of the project: against the clean ones, traced as they
// are (right to 0.02 um inside 2.5 mm). Smoothed by what the noise amounts to, over the points themselves.
TEST(Smoothing, brings_back_the_synthetic_corneas) {
  const char* given = std::getenv("SAGITTA_SHARED");
  const std::filesystem::path folder = std::filesystem::path(given ? given : SAGITTA_SOURCE_DIR "/../shared") / "data/synthetic";
  if (!std::filesystem::exists(folder / "normal_clean.csv")) GTEST_SKIP() << "no corneas in " << folder;
  const auto read = [&](const std::string& name) {
    prescription::Findings findings;
    return prescription::read_cloud({(folder / name).string(), "xyz", true}, findings);
  };
  for (const std::string name : {"normal", "keratoconus", "postlasik"}) {
    const auto clean = read(name + "_clean.csv"), measured = read(name + "_noisy.csv");
    ASSERT_TRUE(clean && measured);
    const Triangulation exact_mesh = triangulate(*clean);
    const auto patches = fit_patches(exact_mesh.mesh->mesh).patches;
    const surface::Patches exact{{&exact_mesh.mesh->mesh}, patches.data()};
    const auto sag = [&](double x, double y) { return exact.sag(x, y); };
    double squares = 0;
    int count = 0;
    for (const auto& p : measured->points) {
      const double noise = p.z - exact.sag(p.x, p.y);
      if (!std::isnan(noise)) squares += noise * noise, ++count;
    }
    EXPECT_GT(count, 3900);
    const double rms = std::sqrt(squares / count);
    const Errors before = errors_of(smoothed(*measured, 0).triangulation, sag, 2.5), after = errors_of(smoothed(*measured, rms).triangulation, sag, 2.5);
    std::printf("[ report   ] %s: noise %.3f um rms; sag error %.4f -> %.4f um rms, slope error %.4f -> %.4f mrad rms\n", name.c_str(), 1e3 * rms, 1e3 * before.sag,
                1e3 * after.sag, 1e3 * before.slope, 1e3 * after.slope);
    // Against the noise itself, and the slope that it has over 0.1 mm, not against what c1 makes of it: that averages too.
    EXPECT_LT(3.3 * after.sag, rms) << name;
    EXPECT_LT(3.3 * after.slope, rms / 0.1) << name;
  }
}

}  // namespace
}  // namespace sagitta::scene
