// SPDX-License-Identifier: Apache-2.0
// Biconics and toroids: Zemax's values, limits, cylinders, equators.
#include "lib/surface/biconic.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <random>

#include "lib/surface/refraction.h"
#include "lib/surface/shapes.h"
#include "tests/support/given_shape.h"

namespace sagitta::surface {
namespace {

using namespace sagitta::tests;
using V = Vec3<double>;
constexpr double eps = 0x1p-52, infinity = std::numeric_limits<double>::infinity();

Toroid toroid(double rotation, double radius, double K, Coefficients coefficients, numerics::Arena& arena) {
  return made<Toroid>({{{"radius_rotation_mm", rotation}, {"radius_mm", radius}, {"conic_constant", K}}, std::move(coefficients)}, arena);
}

struct Ray {
  V p, d;
};
template <class Shape>
Ray through(const Shape& shape, const Ray& ray, double index_before, double index_after, double thickness) {
  const auto hit = shape.meet(ray.p, ray.d);
  EXPECT_EQ(hit.status, Status::ok);
  const V d = refract<double, false>(ray.d, hit.normal, hit.along, IndexRatio<double>::of(index_before, index_after));
  return {{hit.point.x, hit.point.y, hit.point.z - thickness}, d};
}

// G1, G2: glass of 1.5 and 5 mm with a plane back, 10 mm to the image.
TEST(Toroid, RefractsAsZemaxDoes) {
  numerics::Arena arena;
  const Toroid front = toroid(100, 50, -.5, {{2, .05}, {4, .0002}}, arena);
  const auto image_of = [&](const V& from) {
    const Ray glass = through(front, {from, {0, 0, 1}}, 1, 1.5, 5), air = through(Plane{}, glass, 1.5, 1, 10);
    return Ray{Plane{}.meet(air.p, air.d).point, air.d};
  };
  EXPECT_NEAR(image_of({0, -5, 0}).p.y, -0.8123193233401276, 1e-11);
  EXPECT_NEAR(image_of({0, -5, 0}).d.y, 0.3251509839270260, 1e-11);
  EXPECT_NEAR(image_of({-5, 0, 0}).p.x, -4.668385225648558, 1e-11);
  EXPECT_NEAR(image_of({-5, 0, 0}).d.x, 0.02502086086422164, 1e-11);
}

TEST(Toroid, HasTheSagOfZemax) {  // G3
  numerics::Arena arena;
  const Toroid surface = toroid(-50, 40, -.5, {{2, 5e-5}, {4, 5e-6}}, arena);
  EXPECT_NEAR(surface.sag(2.5, 0.0), -6.253911140455271e-2, 1e-14);
  EXPECT_NEAR(surface.sag(0.0, 2.5), 7.867099677109624e-2, 1e-14);
  EXPECT_NEAR(surface.sag(5.0, 2.5), -1.715614452665938e-1, 1e-14);
  EXPECT_NEAR(surface.sag(2.5, -2.5), 1.623025381703616e-2, 1e-14);
  EXPECT_EQ(surface.vertex_curvature(), 1 / 40.0 + 2 * 5e-5);
}

// A ring turned about its own diameter is the sphere; a straight curve turned is the cylinder along y.
TEST(Toroid, OfEqualRadiiIsTheSphereAndOfAStraightCurveACylinder) {
  numerics::Arena arena;
  const Toroid ball = toroid(10, 10, 0, {}, arena), barrel = toroid(12, infinity, 0, {}, arena);
  const Biconic cylinder = Biconic::of({1 / 12.0, 0}, {0, 0});
  for (double x = -5; x <= 5; x += .5)
    for (double y = -5; y <= 5; y += .5) {
      const V p{x, y, -4}, d = normalized(V{.2, .1, 1});
      const auto on_ball = ball.meet(p, d);
      ASSERT_EQ(on_ball.status, Status::ok);
      EXPECT_NEAR(on_ball.path, (Sphere{.1}.meet(p, d).path), 16 * eps * 20 * norm(on_ball.normal) / std::abs(on_ball.along));
      EXPECT_NEAR(barrel.meet(p, d).path, cylinder.meet(p, d).path, 16 * eps * 20);
    }
  EXPECT_TRUE(std::holds_alternative<Sphere>(least_form(ball)));
}

// Where half the ring ends, its rays do: 1 part in 1e9 inside and outside.
TEST(Toroid, EndsWhereHalfTheRingEnds) {
  numerics::Arena arena;
  const Toroid ring = toroid(10, 40, 0, {}, arena);
  const double g = ring.sag(0.0, 3.0), rim = 10 - g;
  EXPECT_EQ(ring.meet(V{rim * (1 - 1e-9), 3, -5}, V{0, 0, 1}).status, Status::ok);
  EXPECT_NE(ring.meet(V{rim * (1 + 1e-9), 3, -5}, V{0, 0, 1}).status, Status::ok);
  EXPECT_TRUE(std::isnan(ring.sag(rim * 1.001, 3.0)));
  EXPECT_TRUE(std::isnan(toroid(1, 10, 0, {}, arena).sag(0.5, 6.0)));  // the curve, 2 mm high there, is beyond the line at 1 mm
}

TEST(Biconic, OfEqualSectionsIsTheConicToTwoUlp) {  // A27
  std::mt19937_64 engine(5);
  const auto u = [&](double low, double high) { return low + (high - low) * static_cast<double>(engine() >> 11) * 0x1p-53; };
  int hits = 0;
  for (int i = 0; i < 20000; ++i) {
    const Conic conic{1 / (u(0, 1) < .5 ? u(5, 50) : -u(5, 50)), u(-3, 2)};
    const Biconic biconic = Biconic::of(conic, conic);
    const V d = normalized(V{u(-.5, .5), u(-.5, .5), 1}), p = V{u(-4, 4), u(-4, 4), 0} - u(0, 10) * d;
    const auto a = biconic.meet(p, d), b = conic.meet(p, d);
    ASSERT_EQ(a.status, b.status);
    if (a.status != Status::ok) continue;
    ++hits;
    const auto traced = least_form(biconic);  // the very same: 0 ulp
    ASSERT_TRUE(std::holds_alternative<Conic>(traced));
    EXPECT_EQ(std::get<Conic>(traced).meet(p, d).path, b.path);
    // itself, it looks where the conic is met, and may take a step of a few roundings of the heights there: 2 ulp on the slope of incidence
    EXPECT_NEAR(a.path, b.path, 4 * eps * (std::abs(b.path) + norm(b.point)) * norm(b.normal) / std::abs(b.along));
  }
  EXPECT_GT(hits, 18000);
}

// Its profile along x is the conic of x, along y that of y; between them it is no ellipsoid where the K differ, and no sum of both.
TEST(Biconic, HasItsTwoSectionsAndIsNoEllipsoid) {
  const Conic x{1 / 8.0, -.5}, y{1 / 7.0, .4};
  const Biconic surface = Biconic::of(x, y);
  for (double r = .5; r < 5; r += .5) {
    EXPECT_NEAR(surface.sag(r, 0.0), x.sag(r, 0.0), 4 * eps);
    EXPECT_NEAR(surface.sag(0.0, r), y.sag(0.0, r), 4 * eps);
  }
  EXPECT_GT(std::abs(surface.sag(3.0, 3.0) - surface.base.sag(3.0, 3.0)), .01);
  EXPECT_GT(std::abs(surface.sag(3.0, 3.0) - x.sag(3.0, 0.0) - y.sag(0.0, 3.0)), .01);
  // (1) with N = 9/8 + 9/7 and Q = .5*9/64 + 1.4*9/49, in exact fractions
  EXPECT_NEAR(surface.sag(3.0, 3.0), (135.0 / 56) / (1 + std::sqrt(1 - (9.0 / 128 + 9.0 / 35))), 4 * eps);
  EXPECT_EQ(surface.vertex_curvature(), 1 / 7.0);
}

// A28: n L stays, whatever the surface does to M; mirrored, L. The normal's x is exactly 0, so that an L of 0 stays exactly; another is off by no more than the
// step to unit length that every direction takes (refraction.h).
TEST(Biconic, CylinderLeavesTheDirectionAlongItAsItIs) {
  numerics::Arena arena;
  const Biconic biconic = Biconic::of({0, 0}, {1 / 10.0, -.5});
  const Toroid of_powers = toroid(infinity, 10, -.5, {{4, 1e-4}}, arena);
  int hits = 0;
  const auto check = [&](const auto& shape) {
    for (double x = -40; x <= 40; x += 4)
      for (double y = -6; y <= 6; y += .5)
        for (const double l : {0.0, .125, -.5}) {
          const V d{l, .1, std::sqrt(1 - l * l - .01)};
          const auto hit = shape.meet(V{x, y, -3}, d);
          ASSERT_EQ(hit.status, Status::ok);
          const IndexRatio<double> ratio = IndexRatio<double>::of(1, 1.5);
          EXPECT_EQ(hit.normal.x, 0);
          EXPECT_NEAR((refract<double, false>(d, hit.normal, hit.along, ratio).x), ratio.mu * l, 2 * eps * std::abs(l));
          EXPECT_NEAR((reflect<double, false>(d, hit.normal, hit.along).x), l, 2 * eps * std::abs(l));
          ++hits;
        }
  };
  check(biconic);
  check(of_powers);
  EXPECT_EQ(hits, 2 * 21 * 25 * 3);
}

TEST(Biconic, EndsAtTheEllipseOfItsEquator) {
  const Biconic surface = Biconic::of({1 / 8.0, 0}, {1 / 12.0, 0});
  for (const double angle : {0.0, .3, .9, 1.4, std::acos(0.0)}) {
    const double x = 8 * std::cos(angle), y = 12 * std::sin(angle), inside = 1 - 1e-9, outside = 1 + 1e-9;
    EXPECT_EQ(surface.meet(V{x * inside, y * inside, -2}, V{0, 0, 1}).status, Status::ok) << angle;
    EXPECT_NE(surface.meet(V{x * outside, y * outside, -2}, V{0, 0, 1}).status, Status::ok) << angle;
  }
}

// A biconic of equal radii is in the x-z plane the conic of K_x. 2026-11-23: from 38 degrees on not_converged, for the quadric of the smaller K is met beyond
// the equator (x 9.798, sag -8), though the hit is well before it (at 38 degrees x 9.19329, sag -5.233).
TEST(Biconic, IsMetUpToItsEquatorByRaysThatMeetItsQuadricBeyond) {
  const Biconic surface = Biconic::of({-1 / 12.0, .5}, {-1 / 12.0, -.5});
  const Conic section{-1 / 12.0, .5};
  int beyond = 0;
  for (double degrees = 1; degrees < 89; degrees += 1) {
    const double angle = degrees * M_PI / 180;
    const V p{0, 0, -17}, d{std::sin(angle), 0, std::cos(angle)};
    const auto expected = section.meet(p, d), hit = surface.meet(p, d);
    ASSERT_EQ(hit.status, expected.status) << degrees;
    if (expected.status != Status::ok) continue;
    beyond += !std::isfinite(surface.height(surface.base.meet(p, d).point.x, 0.0).z);
    // 16 roundings of 30 mm, which the oblique incidence magnifies
    EXPECT_NEAR(hit.path, expected.path, 16 * eps * 30 * norm(expected.normal) / std::abs(expected.along)) << degrees;
    EXPECT_GT(hit.along, 0);
  }
  EXPECT_EQ(beyond, 10);
}

// Where the sag is convex, a line crosses it once in its own sense, and that is the hit: of lines at all angles, those that samples along the line find, to
// their distance. What is nearer to the equator than three samples, they may not find.
TEST(Biconic, AndToroidAreMetWhereSamplesAlongTheLineFindThem) {
  numerics::Arena arena;
  const auto check = [](const char* name, const auto& shape, double radius, int least_from_beyond) {
    SCOPED_TRACE(name);
    std::mt19937_64 engine(3);
    const auto u = [&](double low, double high) { return low + (high - low) * static_cast<double>(engine() >> 11) * 0x1p-53; };
    int from_beyond = 0, hits = 0;
    for (int i = 0; i < 2000; ++i) {
      const double r = radius * std::sqrt(u(0, 1)), at = u(0, 2 * M_PI), tilt = u(0, 89) * M_PI / 180, azimuth = u(0, 2 * M_PI), sense = i % 3 == 0 ? -1 : 1;
      const V d = sense * V{std::sin(tilt) * std::cos(azimuth), std::sin(tilt) * std::sin(azimuth), std::cos(tilt)};
      const V p{r * std::cos(at), r * std::sin(at), u(-radius, radius)};
      const auto hit = shape.meet(p, d);
      const auto f_at = [&](double t) { return p.z + t * d.z - shape.height(p.x + t * d.x, p.y + t * d.y).z; };
      constexpr double step = .02;
      double found = infinity, before = f_at(-60);
      bool is_at_edge = false;
      for (double t = -60; t < 60; t += step) {
        const double f = f_at(t + step);
        if ((before < 0) != (f < 0) && (f > before) == (d.z > 0)) found = t, is_at_edge = std::isnan(f_at(t - 3 * step) + f_at(t + 3 * step));  // NaN is in no order
        before = f;
      }
      if (found < infinity && !is_at_edge) {
        ASSERT_EQ(hit.status, Status::ok) << i;
        EXPECT_NEAR(hit.path, found + step / 2, step) << i;
        ++hits;
        const auto on_base = shape.base.meet(p, d);
        from_beyond += std::isnan(shape.height(on_base.point.x, on_base.point.y).z);
      } else if (hit.status == Status::ok && found == infinity && std::abs(hit.path) < 59) {
        EXPECT_TRUE(std::isnan(f_at(hit.path - step) + f_at(hit.path + step))) << i;
      }
    }
    EXPECT_GT(hits, 800);
    EXPECT_GE(from_beyond, least_from_beyond);
  };
  check("retina", Biconic::of({-1 / 12.91, .27}, {-1 / 12.72, .25}), 11, 0);
  check("unlike retina", Biconic::of({-1 / 12.5, .2}, {-1 / 12.0, .1}), 11, 3);
  check("sections of unlike K", Biconic::of({-1 / 12.0, .5}, {-1 / 12.0, -.5}), 11, 30);
  check("long retina", Biconic::of({-1 / 20.0, .3}, {-1 / 8.0, -.3}), 15, 30);
  check("ring within", toroid(-11, -13, 0, {}, arena), 11, 10);
  check("ring without", toroid(-13, -11, 0, {}, arena), 11, 3);
  check("ring of a prolate curve", toroid(-12, -12, -.8, {}, arena), 11, 30);
}

// 2026-11-23: not_converged, where there is no surface.
TEST(Biconic, IsMissedByARayAlongItsAxisBeyondItsEquator) {
  EXPECT_EQ(Biconic::of({1 / 5.0, 2}, {-1 / 6.0, 1.5}).meet(V{3, 0, -2}, V{0, 0, 1}).status, Status::missed);
  EXPECT_EQ(Biconic::of({1 / 5.0, 2}, {1 / 6.0, 1.5}).meet(V{3, 0, -2}, V{0, 0, 1}).status, Status::missed);
}

TEST(Biconic, IsItsOwnMirrorImageInXAndInY) {
  const Biconic surface = Biconic::of({1 / 9.0, -2}, {-1 / 20.0, .5}), turned = Biconic::of({-1 / 20.0, .5}, {1 / 9.0, -2});
  const V p{1.5, -2, -4}, d = normalized(V{.2, .3, 1});
  const double path = surface.meet(p, d).path;
  EXPECT_EQ(surface.meet(V{-p.x, p.y, p.z}, V{-d.x, d.y, d.z}).path, path);
  EXPECT_EQ(surface.meet(V{p.x, -p.y, p.z}, V{d.x, -d.y, d.z}).path, path);
  EXPECT_NEAR(turned.meet(V{p.y, p.x, p.z}, V{d.y, d.x, d.z}).path, path, 8 * eps * 8);
}

}  // namespace
}  // namespace sagitta::surface
