// SPDX-License-Identifier: Apache-2.0
#include "lib/surface/refraction.h"

#include <gtest/gtest.h>

#include <boost/multiprecision/cpp_dec_float.hpp>
#include <random>

namespace sagitta::surface {
namespace {

using numerics::cross;
using numerics::dot;
using numerics::norm;
using numerics::Vec3;
using Real50 = boost::multiprecision::cpp_dec_float_50;

Vec3<double> random_direction(std::mt19937_64& generator) {
  std::normal_distribution<double> gauss;
  return normalized(Vec3<double>{gauss(generator), gauss(generator), gauss(generator)});
}

// freeform.md, acceptance figure 1: the law itself, n |d x n| conserved as a vector, on rays of both senses and both
// orders of index.
TEST(Refraction, obeys_snells_law_on_random_rays) {
  std::mt19937_64 generator(1);
  std::uniform_real_distribution<double> index(1, 2.5), length(0.2, 5);
  int refracted = 0, reflected = 0;
  for (int i = 0; i < 1000000; ++i) {
    const Vec3<double> d = random_direction(generator), unit_normal = random_direction(generator);
    const Vec3<double> normal = length(generator) * unit_normal;
    const double before = index(generator), after = index(generator);
    const double along = dot(d, normal);
    const Vec3<double> out = refract(d, normal, along, IndexRatio<double>::of(before, after));
    const Vec3<double> by_unit_normal = refract<double, true>(d, unit_normal, dot(d, unit_normal), IndexRatio<double>::of(before, after));
    const Vec3<double> tangential = before * cross(d, unit_normal);
    const double sine = norm(tangential) / after;
    if (std::abs(sine - 1) < 1e-13) continue;  // on the threshold either answer is right
    if (sine > 1) {
      ++reflected;
      ASSERT_TRUE(std::isnan(out.x) && std::isnan(out.y) && std::isnan(out.z));
      ASSERT_TRUE(std::isnan(by_unit_normal.x) && std::isnan(by_unit_normal.y) && std::isnan(by_unit_normal.z));
      continue;
    }
    ++refracted;
    for (const Vec3<double>& direction : {out, by_unit_normal}) {
      ASSERT_NEAR(norm(direction), 1, 1e-14);
      ASSERT_LE(norm(tangential - after * cross(direction, unit_normal)), 1e-14);
      ASSERT_GE(along * dot(direction, normal), 0);  // goes on to the same side
    }
  }
  EXPECT_GT(refracted, 700000);
  EXPECT_GT(reflected, 50000);
}

// A20: index ratio 1 + 1e-12 at 45 degrees bends by (1e-12) tan 45; relative check 1e-3 as the row states.
TEST(Refraction, nearly_equal_indices_bend_by_the_right_tiny_angle) {
  const double s = std::sqrt(0.5);
  const Vec3<double> d{s, 0, s}, normal{0, 0, 1};
  const double actual_excess = (1 + 1e-12) - 1;  // the double nearest 1 + 1e-12
  const auto ratio = IndexRatio<double>::of(1, 1 + 1e-12);
  for (const Vec3<double>& out : {refract(d, normal, s, ratio), refract<double, true>(d, normal, s, ratio)})
    EXPECT_NEAR(numerics::angle_between(out, d), actual_excess, 1e-3 * actual_excess);
}

// A10: near the critical angle, cos t = sqrt(1 - mu^2 sin^2) has the error 4e-16 / cos t from the radicand's rounding.
TEST(Refraction, critical_angle_is_approached_with_the_rounding_of_its_radicand) {
  const double critical = std::asin(1 / 1.5);
  int refracted = 0;
  for (const double excess : {1e-6, 1e-9, 1e-12, 1e-13, 1e-15}) {
    const double angle = critical * (1 - excess);
    const Vec3<double> d{std::sin(angle), 0, std::cos(angle)};
    const Vec3<double> out = refract(d, {0, 0, 1}, d.z, IndexRatio<double>::of(1.5, 1));
    const Real50 length = sqrt(Real50(d.x) * d.x + Real50(d.z) * d.z);
    const Real50 sine = Real50(1.5) * d.x / length;
    if (sine >= 1) continue;
    ++refracted;
    const double exact = static_cast<double>(sqrt((1 - sine) * (1 + sine)));
    EXPECT_NEAR(out.z, exact, 4e-16 / exact) << excess;
  }
  EXPECT_GE(refracted, 4);
  const double beyond = critical * (1 + 1e-12);
  EXPECT_TRUE(std::isnan(refract<double>({std::sin(beyond), 0, std::cos(beyond)}, {0, 0, 1}, std::cos(beyond),
                                         IndexRatio<double>::of(1.5, 1)).x));
}

// A29: incidence at 90 degrees minus 1e-8.
TEST(Refraction, grazing_ray_is_refracted) {
  const double graze = 1e-8 * 3.14159265358979323846 / 180;
  const Vec3<double> d{1, 0, std::sin(graze)};
  const Vec3<double> out = refract(d, {0, 0, 1}, d.z, IndexRatio<double>::of(1, 1.5));
  EXPECT_NEAR(out.z, std::sqrt(5.0) / 3, 1e-16 * 2);
  EXPECT_NEAR(out.x, 2.0 / 3, 2e-16);
}

TEST(Refraction, equal_indices_leave_the_direction) {
  const Vec3<double> d = normalized(Vec3<double>{0.1, -0.2, 1});
  const Vec3<double> out = refract(d, {0.3, 0.1, 2.0}, dot(d, {0.3, 0.1, 2.0}), IndexRatio<double>::of(1.5, 1.5));
  EXPECT_LE(norm(out - d), 2.3e-16);  // the step to unit length may round
}

// 1000 reflections between two mirrors: each rounding of the length stays a rounding.
TEST(Reflection, length_does_not_drift_over_many_surfaces) {
  Vec3<double> d = normalized(Vec3<double>{0.3, -0.2, 1});
  const Vec3<double> one = normalized(Vec3<double>{0.1, 0.7, 2}), other = normalized(Vec3<double>{-0.3, 0.2, 1});
  for (int i = 0; i < 1000; ++i) {
    d = reflect(d, one, dot(d, one));
    d = reflect(d, other, dot(d, other));
  }
  EXPECT_NEAR(norm(d), 1, 4e-16);
}

TEST(Reflection, keeps_the_angle_and_the_plane_of_incidence) {
  std::mt19937_64 generator(2);
  for (int i = 0; i < 10000; ++i) {
    const Vec3<double> d = random_direction(generator), normal = random_direction(generator);
    for (const Vec3<double>& out : {reflect(d, normal, dot(d, normal)), reflect<double, true>(d, normal, dot(d, normal))}) {
      EXPECT_NEAR(dot(out, normal), -dot(d, normal), 1e-15);
      EXPECT_LE(norm(cross(out, normal) - cross(d, normal)), 1e-15);
    }
  }
}

}  // namespace
}  // namespace sagitta::surface
