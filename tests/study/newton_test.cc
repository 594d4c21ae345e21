// SPDX-License-Identifier: Apache-2.0
#include "lib/study/newton.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "lib/study/uniform.h"

namespace sagitta::test {
namespace {

using numerics::Vec3;
using study::meet_to_tolerance;
using study::NewtonHit;
using surface::Status;

constexpr double infinity = std::numeric_limits<double>::infinity();

struct Ray {
  Vec3<double> p, d;
};
// From the plane z = -3, within 1.4 mm of the axis, up to about 35 degrees off it.
Ray random_ray(study::Uniform& uniform) {
  return {{uniform(-1, 1), uniform(-1, 1), -3}, numerics::normalized(Vec3<double>{uniform(-.5, .5), uniform(-.5, .5), 1})};
}

// The start is the hit itself: one look, at a tolerance of 16 units in the last place of the 5 mm that are summed.
TEST(Newton, LooksOnceAtASphereAndAtAPlane) {
  study::Uniform uniform(1);
  for (int i = 0; i < 200; ++i) {
    const Ray ray = random_ray(uniform);
    const NewtonHit sphere = meet_to_tolerance(surface::Sphere{.1}, ray.p, ray.d, 16 * 4.4e-16);
    EXPECT_EQ(sphere.looks, 1);
    EXPECT_EQ(sphere.crossing.status, Status::ok);
    const NewtonHit plane = meet_to_tolerance(surface::Plane{}, ray.p, ray.d, 16 * 4.4e-16);
    EXPECT_EQ(plane.looks, 1);
    EXPECT_NEAR(plane.crossing.path, 3 / ray.d.z, 1e-14);
  }
}

// Along z the sag under the ray does not change: f is linear, and the second look is at the hit.
TEST(Newton, LooksTwiceAlongTheAxis) {
  study::Uniform uniform(2);
  const surface::Conic conic{.2, -4};
  int rays = 0;
  for (int i = 0; i < 200; ++i) {
    const Ray ray = random_ray(uniform);
    const double r_squared = ray.p.x * ray.p.x + ray.p.y * ray.p.y, departure = 3 * .008 * r_squared * r_squared / 8;
    if (departure < 1e-4) continue;
    const NewtonHit hit = meet_to_tolerance(conic, ray.p, {0, 0, 1}, 1e-12);
    EXPECT_EQ(hit.looks, 2);
    EXPECT_NEAR(hit.crossing.point.z, conic.sag(ray.p.x, ray.p.y), 1e-15);
    EXPECT_EQ(meet_to_tolerance(conic, ray.p, {0, 0, 1}, 1).looks, 1);
    ++rays;
  }
  EXPECT_GT(rays, 150);  // 14 % lie within .43 mm of the axis, where the departure is less
}

// On a paraboloid z = c r^2/2 the distance along z is a parabola in the path, f'' = -c (L^2 + M^2), and a step leaves of it
// exactly (f''/2) (f/f')^2: the order is 2, and looks can be counted by this alone.
TEST(Newton, StepsOnAParaboloidLeaveTheSquare) {
  study::Uniform uniform(3);
  const double c = .2;
  const surface::Conic paraboloid{c, -1};
  int steps = 0, rays = 0;
  for (int i = 0; i < 500; ++i) {
    const auto [p, d] = random_ray(uniform);
    const auto above = [&](const NewtonHit& hit) { return hit.crossing.point.z - c / 2 * (hit.crossing.point.x * hit.crossing.point.x + hit.crossing.point.y * hit.crossing.point.y); };
    NewtonHit at = meet_to_tolerance(paraboloid, p, d, infinity);  // the first look, whatever it sees
    ASSERT_EQ(at.looks, 1);
    double f = above(at);
    const auto next_of = [&](const NewtonHit& hit, double f_there) {
      const double slope = d.z - c * (hit.crossing.point.x * d.x + hit.crossing.point.y * d.y);
      return -c / 2 * (d.x * d.x + d.y * d.y) * std::pow(f_there / slope, 2);
    };
    for (int look = 2; std::abs(next_of(at, f)) > 1e-12; ++look) {
      const double expected = next_of(at, f);
      at = meet_to_tolerance(paraboloid, p, d, .999 * std::abs(f));  // one look further: the square is less
      EXPECT_EQ(at.looks, look);
      f = above(at);
      // Five millimetres are summed to a few units in the last place, 4e-16 and the like.
      EXPECT_NEAR(f, expected, 1e-14);
      // at a tolerance between this and the look before there are as many looks, and one more just below
      EXPECT_EQ(meet_to_tolerance(paraboloid, p, d, 1.001 * std::abs(f)).looks, look);
      EXPECT_EQ(meet_to_tolerance(paraboloid, p, d, .999 * std::abs(f)).looks, look + 1);
      ++steps;
    }
    ++rays;
  }
  EXPECT_EQ(rays, 500);
  EXPECT_GT(steps, 600);
}

// A ray that passes by the sphere of the vertex' curvature, R = 2, but not by the hyperboloid: it begins on the plane.
TEST(Newton, BeginsOnThePlaneWhereTheSphereIsMissed) {
  const surface::Conic hyperboloid{.5, -4};
  const Vec3<double> p{2.5, 0, -1};
  const NewtonHit hit = meet_to_tolerance(hyperboloid, p, {0, 0, 1}, 1e-12);
  EXPECT_EQ(hit.crossing.status, Status::ok);
  EXPECT_NEAR(hit.crossing.point.z, hyperboloid.sag(2.5, 0.0), 1e-15);
  EXPECT_EQ(hit.looks, 2);
  EXPECT_EQ(meet_to_tolerance(hyperboloid, p, {0, 0, 1}, infinity).crossing.point.z, 0);
}

}  // namespace
}  // namespace sagitta::test
