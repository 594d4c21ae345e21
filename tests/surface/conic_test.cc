// SPDX-License-Identifier: Apache-2.0
#include "lib/surface/sphere.h"

#include <gtest/gtest.h>

#include <boost/multiprecision/cpp_dec_float.hpp>
#include <random>

#include "lib/surface/plane.h"

namespace sagitta::surface {
namespace {

using Real50 = boost::multiprecision::cpp_dec_float_50;
using numerics::vec3_cast;

TEST(Conic, three_four_five_hyperboloid_is_exact) {
  const Conic conic{0.25, -2};  // sag(3) = 1: 9/4 / (1 + sqrt(1 + 9/16))
  EXPECT_EQ(conic.sag(3.0, 0.0), 1.0);
  EXPECT_EQ(conic.gradient(3.0, 0.0).x, 0.6);
  const auto crossing = conic.meet(Vec3<double>{3, 0, -5}, Vec3<double>{0, 0, 1});
  EXPECT_EQ(crossing.path, 6.0);
  EXPECT_EQ(crossing.normal.x / crossing.normal.z, -0.6);
}

TEST(Conic, curvature_zero_is_the_plane) {
  const Vec3<double> p{1, 2, -3}, d{0.6, 0, 0.8};
  const auto conic = Conic{0, -0.7}.meet(p, d);
  const auto plane = Plane{}.meet(p, d);
  EXPECT_NEAR(conic.path, plane.path, 4e-16 * 3.75);  // one rounding of the path more, through e
  EXPECT_EQ(conic.normal.z, 1.0);
  EXPECT_EQ(Plane{}.meet(p, Vec3<double>{1, 0, 0}).status, Status::missed);
  EXPECT_EQ((Conic{0, 0}.meet(p, Vec3<double>{1, 0, 0}).status), Status::missed);
}

// A16: extreme radii. The axial ray's path is the sag of (1); its roundings are below 8 ulp.
TEST(Conic, sag_of_extreme_radii_keeps_its_digits) {
  struct Case {
    double radius, conic_constant, height;
    const char* exact;
  };
  const Case cases[] = {{1e12, 0, 10, "5.000000000000000000000125e-11"},
                        {1e12, -1, 10, "5e-11"},
                        {7.8, -0.26, 3, "0.5936398813092185299464728289720451334398"},
                        {1e-9, 0, 5e-10, "1.339745962155613532353627683e-10"},
                        {7.8, -1 + 1e-6, 4, "1.025641093073054602569888068093"},  // A17
                        {7.8, -1 - 1e-6, 4, "1.025640958209014413082996808706"},
                        {7.8, -1 + 1e-12, 4, "1.025641025641093073045735776496"},
                        {7.8, -1 - 1e-12, 4, "1.025641025640958209005546292519"},
                        {7.8, -1, 4, "1.0256410256410256410256410256410256410256"}};
  for (const Case& c : cases) {
    const Real50 exact(c.exact);
    const double tolerance = 8 * std::abs(std::nextafter(static_cast<double>(exact), 1e300) - static_cast<double>(exact));
    const Conic conic{1 / c.radius, c.conic_constant};
    EXPECT_NEAR(conic.sag(c.height, 0.0), static_cast<double>(exact), tolerance) << c.radius;
    const auto crossing = conic.meet(Vec3<double>{c.height, 0, 0}, Vec3<double>{0, 0, 1});
    EXPECT_NEAR(crossing.path, static_cast<double>(exact), tolerance) << c.radius;
  }
}

// A18: at the equator d(sag)/dr diverges, so a rounding eps r of the radius moves the sag by
// eps r c r / root, root = sqrt(1 - (1+K) c^2 r^2) = 1.4e-6: 3.5e-9 mm for 8 roundings.
TEST(Conic, oblate_conic_is_met_up_to_its_equator_and_missed_beyond) {
  const Conic conic{0.1, 0.96};
  const double equator = 50.0 / 7;
  const auto inside = conic.meet(Vec3<double>{0, equator * (1 - 1e-12), -1}, Vec3<double>{0, 0, 1});
  ASSERT_EQ(inside.status, Status::ok);
  EXPECT_NEAR(inside.path - 1, 5.102033600951212383971962188288743605491, 3.5e-9);
  const auto outside = conic.meet(Vec3<double>{0, equator * (1 + 1e-12), -1}, Vec3<double>{0, 0, 1});
  EXPECT_EQ(outside.status, Status::missed);
  EXPECT_TRUE(std::isnan(outside.path));
}

// A19: R = 10, K = -4 has its other vertex at z = -20/3; a line across the axis there meets that sheet only.
TEST(Conic, other_sheet_of_a_hyperboloid_is_a_miss) {
  const Conic conic{0.1, -4};
  EXPECT_EQ((conic.meet(Vec3<double>{0, 0, -8}, Vec3<double>{0, 1, 0}).status), Status::missed);
  EXPECT_EQ((conic.meet(Vec3<double>{0, -20, -9}, Vec3<double>{0, 0.999, std::sqrt(1 - 0.999 * 0.999)}).status), Status::missed);
  // a line that meets both sheets finds the vertex's
  const auto both = conic.meet(Vec3<double>{0, 0, -9}, Vec3<double>{0, 0, 1});
  ASSERT_EQ(both.status, Status::ok);
  EXPECT_EQ(both.path, 9.0);
}

TEST(Conic, far_side_of_a_sphere_is_a_miss) {
  // A line that passes the front hemisphere's rim by and would enter behind the equator.
  const Conic sphere{0.1, 0};
  EXPECT_EQ((sphere.meet(Vec3<double>{0, 11, 9}, Vec3<double>{0, -0.6, 0.8}).status), Status::missed);
  // travelling back (after a mirror) the same front hemisphere is met from inside
  const auto back = sphere.meet(Vec3<double>{0, 0, 10}, Vec3<double>{0, 0, -1});
  ASSERT_EQ(back.status, Status::ok);
  EXPECT_EQ(back.path, 10.0);
  EXPECT_LT(back.along, 0);
}

// Against the conic's template in 50 digits over wild lines. Bound: with |d| = 1 and all of (3) evaluated with
// relative error 4 eps of their largest terms, the hit has the backward error 16 eps S (S: distance scale) across the
// surface, divided by the cosine of incidence.
template <class Shape, class Make>
void expect_hits_within_bound(const Make& make) {
  std::mt19937_64 generator(20261122);
  std::uniform_real_distribution<double> unit(-1, 1);
  int hits = 0, status_differs = 0;
  for (int i = 0; i < 20000; ++i) {
    const double radius = std::copysign(std::pow(10, 3 * unit(generator)), unit(generator));
    const Conic conic{1 / radius, std::is_same_v<Shape, Conic> ? 3 * unit(generator) : 0};
    const Shape shape = make(conic);
    const double scale = std::abs(radius);
    const Vec3<double> target{0.5 * scale * unit(generator), 0.5 * scale * unit(generator), 0};
    const Vec3<double> d = normalized(Vec3<double>{unit(generator), unit(generator), 1.5 * unit(generator)});
    const Vec3<double> p = target + (3 * scale * unit(generator)) * d;
    const auto fast = shape.meet(p, d);
    const auto exact = conic.meet(vec3_cast<Real50>(p), vec3_cast<Real50>(d));
    if (fast.status != exact.status) {
      ++status_differs;
      continue;
    }
    if (fast.status != Status::ok) continue;
    ++hits;
    const double cosine = std::abs(static_cast<double>(exact.along / norm(exact.normal)));
    const double bound = 16 * 2.3e-16 * (norm(p) + scale + std::abs(fast.path)) / cosine;
    EXPECT_NEAR(fast.path, static_cast<double>(exact.path), bound) << i;
    // on the surface
    const Vec3<double> hit = p + fast.path * d;
    EXPECT_NEAR(hit.z, static_cast<double>(conic.sag(Real50(hit.x), Real50(hit.y))), 2 * bound / std::abs(fast.normal.z)) << i;
    // along = d.n: by (4) n changes with the hit by 1 + |1+K| <= 5 times |c|, the rest is the rounding of the root, as the hit's
    EXPECT_NEAR(fast.along, static_cast<double>(exact.along), 8 * bound / scale) << i;
  }
  EXPECT_GT(hits, 9000);
  EXPECT_LE(status_differs, 1);  // only a line within rounding of tangency may differ
}

TEST(Conic, hit_agrees_with_50_digits_within_its_derived_bound) {
  expect_hits_within_bound<Conic>([](const Conic& conic) { return conic; });
}
TEST(Sphere, hit_agrees_with_50_digits_within_its_derived_bound) {
  expect_hits_within_bound<Sphere>([](const Conic& conic) { return Sphere{conic.curvature}; });
}

}  // namespace
}  // namespace sagitta::surface
