// SPDX-License-Identifier: Apache-2.0
// Aspheres and polynomials in x and y: exact cases, other formulas, blocks.
#include "lib/surface/asphere.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>

#include "lib/study/fifty_digits_internal.h"
#include "lib/surface/shapes.h"
#include "tests/support/given_shape.h"

namespace sagitta::surface {
namespace {

using namespace sagitta::tests;
using Fifty = study::FiftyDigits;
constexpr double eps = 0x1p-52, infinity = std::numeric_limits<double>::infinity();

Asphere asphere(double radius, double K, Coefficients coefficients, numerics::Arena& arena) {
  return made<Asphere>({{{"radius_mm", radius}, {"conic_constant", K}}, std::move(coefficients)}, arena);
}

// r^2 alone is a paraboloid of curvature 2 a_2: Zemax's parameter 1, which some readers take for r^4.
TEST(Asphere, SquareTermOnAPlaneIsTheParaboloid) {
  numerics::Arena arena;
  const Asphere surface = asphere(infinity, 0, {{2, .03125}}, arena);
  const Conic paraboloid{.0625, -1};
  EXPECT_EQ(surface.vertex_curvature(), .0625);
  for (double x = -8; x <= 8; x += .5)
    for (double y = -8; y <= 8; y += .5) {
      EXPECT_EQ(surface.sag(x, y), .03125 * (x * x + y * y));
      const Vec3<double> p{x, y, -3}, d = normalized(Vec3<double>{.2, -.3, 1});
      // either iteration or root is off by a few roundings of the path of some 10 mm
      EXPECT_NEAR(surface.meet(p, d).path, paraboloid.meet(p, d).path, 16 * eps * 10);
    }
}

TEST(Asphere, IsTheSumOfItsPowersEvenAndOdd) {
  numerics::Arena arena;
  const Coefficients given{{2, -3e-3}, {3, 2e-3}, {5, -1e-4}, {6, 3e-6}, {9, 1e-8}, {40, 1e-34}};
  const Asphere surface = asphere(-11, -.7, given, arena);
  for (const auto& [x, y] : {std::pair{0.0, 0.0}, {1.0, 2.0}, {-3.0, .5}, {4.0, -4.0}}) {
    const Fifty X(x), Y(y), r = sqrt(Fifty(X * X + Y * Y));
    Fifty sum = Conic{1 / -11.0, -.7}.sag(X, Y), sizes = 0;
    for (const auto& [power, a] : given) {
      const Fifty term = a * pow(r, power);
      sum += term, sizes += abs(term);
    }
    EXPECT_NEAR(static_cast<double>(Fifty(surface.sag(X, Y) - sum)), 0, 1e-45);
    EXPECT_NEAR(surface.sag(x, y), static_cast<double>(sum), 4 * eps * std::abs(static_cast<double>(sum)) + surface.sum_rounding(x, y).value);
    EXPECT_NEAR(static_cast<double>(surface.size_of_terms(X, Y)), static_cast<double>(sizes), 1e-15);
  }
  EXPECT_EQ(surface.gradient(0.0, 0.0).x, 0);
  EXPECT_EQ(surface.gradient(0.0, 0.0).y, 0);
}

TEST(Asphere, BoundsOfItsSlopesHold) {
  numerics::Arena arena;
  const Asphere surface = asphere(infinity, 0, {{2, 1e-2}, {3, -2e-3}, {4, 3e-4}, {7, 1e-6}}, arena);
  for (double r = .25; r < 6; r += .25) {
    const double steepest = 2e-2 * r + 6e-3 * r * r + 12e-4 * r * r * r + 7e-6 * std::pow(r, 6);
    EXPECT_NEAR(surface.steepest_squared_within(r * r), steepest * steepest, 1e-14 * steepest * steepest);
    EXPECT_NEAR(surface.bound_within(r, 2), 2e-2 + 12e-3 * r + 36e-4 * r * r + 42e-6 * std::pow(r, 5), 1e-14);
    EXPECT_GT(surface.reach_from(r), r);
  }
}

TEST(Asphere, WithoutPowersIsItsConic) {
  numerics::Arena arena;
  EXPECT_TRUE(std::holds_alternative<Conic>(least_form(asphere(9, -.5, {}, arena))));
  EXPECT_TRUE(std::holds_alternative<Sphere>(least_form(asphere(9, 0, {{4, 0}}, arena))));
  EXPECT_TRUE(std::holds_alternative<Plane>(least_form(asphere(infinity, 3, {}, arena))));
  EXPECT_TRUE(std::holds_alternative<Asphere>(least_form(asphere(infinity, 3, {{6, 1e-9}}, arena))));
}

// The numbers of the terms, by Zemax's list: x, y, x^2, x y, y^2, x^3, x^2 y, x y^2, y^3, x^4 ...
TEST(XyPolynomial, CountsItsTermsAsZemaxAndCodeVDo) {
  numerics::Arena arena;
  int j = 0;
  for (int n = 1; n <= XyPolynomial::highest_degree; ++n)
    for (int k = 0; k <= n; ++k) {
      const auto term = made<XyPolynomial>({{{"radius_mm", infinity}, {"normalization_radius_mm", 2}}, {{++j, 3}}}, arena);
      EXPECT_EQ(term.sag(4.0, 2.0), 3 * std::pow(2, n - k)) << j;
      EXPECT_EQ(term.sag(2.0, 4.0), 3 * std::pow(2, k)) << j;
      EXPECT_EQ(term.polynomial.degree, n);
    }
  EXPECT_EQ(j, 230);
}

// x^2 + y^2 is the paraboloid too; turned by 90 degrees, x and y change places.
TEST(XyPolynomial, IsTheParaboloidAndTurnsWithItsTerms) {
  numerics::Arena arena;
  const auto round = made<XyPolynomial>({{{"radius_mm", infinity}}, {{3, .03125}, {5, .03125}}}, arena);
  const Vec3<double> p{2, -3, -5}, d = normalized(Vec3<double>{.1, .25, 1});
  EXPECT_NEAR(round.meet(p, d).path, (Conic{.0625, -1}.meet(p, d).path), 16 * eps * 10);
  EXPECT_EQ(round.vertex_curvature(), .0625);
  const auto one = made<XyPolynomial>({{{"radius_mm", 30}}, {{2, .02}, {3, 1e-3}, {7, 3e-4}, {9, 1e-4}}}, arena);
  const auto turned = made<XyPolynomial>({{{"radius_mm", 30}}, {{1, .02}, {5, 1e-3}, {8, 3e-4}, {6, 1e-4}}}, arena);
  EXPECT_NEAR(one.meet(p, d).path, turned.meet(Vec3<double>{p.y, p.x, p.z}, Vec3<double>{d.y, d.x, d.z}).path, 16 * eps * 10);
  EXPECT_TRUE(std::holds_alternative<Sphere>(least_form(made<XyPolynomial>({{{"radius_mm", 30}}, {{4, 0}}}, arena))));
}

// Blocks: the same bits as line by line, of every status.
template <class Shape>
void expect_same_bits(const Shape& shape) {
  std::mt19937_64 engine(3);
  const auto u = [&](double low, double high) { return low + (high - low) * static_cast<double>(engine() >> 11) * 0x1p-53; };
  const auto lines = std::make_unique<BlockOfLines>();
  const auto crossings = std::make_unique<BlockOfCrossings>();
  int hits = 0, lost = 0;
  for (int count = block_capacity; count > 0; count -= 5) {
    lines->count = count;
    for (int i = 0; i < count; ++i) {
      const Vec3<double> d = normalized(Vec3<double>{u(-1, 1), u(-1, 1), u(-1, 1)}), p = Vec3<double>{u(-9, 9), u(-9, 9), 0} - u(-9, 9) * d;
      lines->x[i] = p.x, lines->y[i] = p.y, lines->z[i] = p.z, lines->l[i] = d.x, lines->m[i] = d.y, lines->n[i] = d.z, lines->travels[i] = true;
    }
    shape.meet_block(*lines, *crossings);
    for (int i = 0; i < count; ++i) {
      const auto alone = shape.meet(Vec3<double>{lines->x[i], lines->y[i], lines->z[i]}, Vec3<double>{lines->l[i], lines->m[i], lines->n[i]});
      EXPECT_EQ(crossings->status[i], static_cast<int>(alone.status));
      ++(alone.status == Status::ok ? hits : lost);
      if (alone.status != Status::ok) continue;
      EXPECT_EQ(crossings->path[i], alone.path);
      EXPECT_EQ(crossings->z[i], alone.point.z);
      EXPECT_EQ(-crossings->slope_x[i], alone.normal.x);
      EXPECT_EQ(-crossings->slope_y[i], alone.normal.y);
    }
  }
  EXPECT_GT(hits, 1500);
  EXPECT_GT(lost, 300);
}
TEST(Asphere, BlocksHaveTheSameBitsAsLineByLine) {
  numerics::Arena arena;
  expect_same_bits(asphere(12, -.8, {{4, 2e-4}, {6, -3e-6}, {8, 1e-8}}, arena));
  expect_same_bits(asphere(12, .8, {{3, 2e-3}, {4, -2e-4}, {5, 1e-5}}, arena));
  expect_same_bits(made<XyPolynomial>({{{"radius_mm", 20}}, {{1, .1}, {4, .02}, {7, 1e-3}, {12, -1e-4}}}, arena));
}

}  // namespace
}  // namespace sagitta::surface
