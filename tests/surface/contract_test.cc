// SPDX-License-Identifier: Apache-2.0
// The shapes' contract (crossing.h), asked of every kind that is given by a formula.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>
#include <string>

#include "lib/study/fifty_digits_internal.h"
#include "lib/surface/shapes.h"
#include "tests/support/given_shape.h"
#include "tests/support/sag_grids.h"

namespace sagitta::surface {
namespace {

using namespace sagitta::tests;
using Fifty = study::FiftyDigits;
using numerics::vec3_cast;
constexpr double eps = 0x1p-52, infinity = std::numeric_limits<double>::infinity();

struct Instance {
  std::string name;
  Shape shape;
  double radius;  // of the rays' places
  double steepest;  // of the surface within it, at most
};

std::vector<Instance> instances(numerics::Arena& arena) {
  std::vector<Instance> all{{"plane", Plane{}, 10, 0},
                            {"sphere", Sphere{-1 / 12.0}, 8, 1},
                            {"ellipsoid", Conic{1 / 7.72, -.26}, 5, 1},
                            {"hyperboloid", Conic{-1 / 6.0, -3.1}, 5, 1},
                            {"oblate", Conic{1 / 9.0, 1.5}, 4, 1}};
  const auto add = [&]<class S>(const char* name, std::type_identity<S>, GivenShape given, double radius, double steepest) {
    all.push_back({name, made<S>(std::move(given), arena), radius, steepest});
  };
  add("even asphere", std::type_identity<Asphere>{}, {{{"radius_mm", 12}, {"conic_constant", -.8}}, {{2, -3e-3}, {4, 2e-4}, {6, -3e-6}, {8, 1e-8}, {10, 2e-10}}}, 5, 1.5);
  add("odd asphere", std::type_identity<Asphere>{}, {{{"radius_mm", -9}, {"conic_constant", .3}}, {{3, 2e-3}, {4, 1e-4}, {5, -4e-5}, {8, 1e-7}}}, 4, 1.5);
  add("powers alone", std::type_identity<Asphere>{}, {{{"radius_mm", infinity}}, {{2, .03}, {7, 1e-6}}}, 5, 1.5);
  add("cornea", std::type_identity<Biconic>{}, {{{"radius_x_mm", 7.83}, {"radius_y_mm", 7.70}, {"conic_constant_x", -.18}, {"conic_constant_y", -.25}}, {}}, 5, 1.5);
  add("retina", std::type_identity<Biconic>{}, {{{"radius_x_mm", -12.91}, {"radius_y_mm", -12.72}, {"conic_constant_x", .27}, {"conic_constant_y", .25}}, {}}, 9, 1.8);
  add("cylinder", std::type_identity<Biconic>{}, {{{"radius_x_mm", infinity}, {"radius_y_mm", 10}, {"conic_constant_y", -.5}}, {}}, 6, 1);
  add("saddle", std::type_identity<Biconic>{}, {{{"radius_x_mm", 15}, {"radius_y_mm", -20}, {"conic_constant_x", -1}, {"conic_constant_y", .4}}, {}}, 6, 1);
  add("unlike sections", std::type_identity<Biconic>{}, {{{"radius_x_mm", 10}, {"radius_y_mm", 20}, {"conic_constant_x", -2}, {"conic_constant_y", .5}}, {}}, 6, 1);
  add("toroid", std::type_identity<Toroid>{}, {{{"radius_rotation_mm", 30}, {"radius_mm", 15}, {"conic_constant", -.5}}, {{2, 1e-3}, {3, 2e-4}, {4, -1e-5}}}, 5, 1);
  add("toroid bent two ways", std::type_identity<Toroid>{}, {{{"radius_rotation_mm", -50}, {"radius_mm", 40}, {"conic_constant", -.5}}, {{2, 5e-5}, {4, 5e-6}}}, 6, 1);
  add("cylinder of powers", std::type_identity<Toroid>{}, {{{"radius_rotation_mm", infinity}, {"radius_mm", infinity}}, {{2, .02}, {4, -1e-5}}}, 6, 1);
  add("barrel", std::type_identity<Toroid>{}, {{{"radius_rotation_mm", 20}, {"radius_mm", infinity}}, {}}, 8, 1);
  add("xy polynomial", std::type_identity<XyPolynomial>{}, {{{"radius_mm", 20}, {"conic_constant", -1}}, {{1, .01}, {2, -.02}, {3, 1e-3}, {4, 2e-3}, {5, -1e-3}, {7, 1e-4}, {14, 2e-5}}}, 5, 1);
  add("xy polynomial of a disc", std::type_identity<XyPolynomial>{}, {{{"radius_mm", infinity}, {"normalization_radius_mm", 5}}, {{3, .1}, {4, .2}, {12, -.05}, {27, .02}}}, 5, 1);
  add("zernike", std::type_identity<Zernike>{}, {{{"radius_mm", 7.8}, {"conic_constant", -.2}, {"normalization_radius_mm", 4}}, {{3, 20}, {5, -30}, {7, 10}, {12, 5}}}, 4, 1);
  // The origin on a node, in the middle of a cell, and beside the base of the whole sag.
  all.push_back({"grid", grid_on(sag_grid({49, 57, .5, .5}, [](double x, double y) { return of_waves(.2, x, y); }), arena, {1 / 15.0, -.5}), 5, 1});
  all.push_back({"grid of cells about the origin", grid_on(without_slopes(sag_grid({40, 36, .5, .625}, [](double x, double y) { return of_waves(.2, x, y); })), arena, {-1 / 20.0, 1}), 5, 1});
  all.push_back({"grid of all the sag", grid_on(without_slopes(sag_grid({65, 65, .25, .25}, [](double x, double y) { return of_sphere(-14, x, y); })), arena), 4.5, 1});
  add("zernike by recurrence", std::type_identity<Zernike>{}, {{{"radius_mm", 7.8}, {"normalization_radius_mm", 4}}, {{5, 30}, {110, .1}}}, 4, 1);
  return all;
}

struct Line {
  Vec3<double> start, d;
};
// To places within the radius, of tilts up to 40 degrees, of both senses, from up to 20 mm away.
std::vector<Line> lines_to(double radius, double tilt_deg, int count) {
  std::mt19937_64 engine(7);
  const auto u = [&](double low, double high) { return low + (high - low) * static_cast<double>(engine() >> 11) * 0x1p-53; };
  std::vector<Line> lines;
  for (int i = 0; i < count; ++i) {
    const double r = radius * std::sqrt(u(0, 1)), at = u(0, 2 * M_PI), tilt = i % 4 == 0 ? 0 : u(0, tilt_deg) * M_PI / 180, azimuth = u(0, 2 * M_PI);
    Vec3<double> d{std::sin(tilt) * std::cos(azimuth), std::sin(tilt) * std::sin(azimuth), std::cos(tilt)};
    if (i % 3 == 0) d = -d;
    lines.push_back({Vec3<double>{r * std::cos(at), r * std::sin(at), 0} - u(-20, 20) * d, d});
  }
  return lines;
}

template <class Check>
void for_each_instance(const Check& check) {
  numerics::Arena arena;
  std::set<std::size_t> kinds;
  for (const Instance& instance : instances(arena)) {
    SCOPED_TRACE(instance.name);
    kinds.insert(instance.shape.index());
    std::visit([&]<class S>(const S& shape) {
      if constexpr (is_analytic<S>) check(shape, instance);
    }, instance.shape);
  }
  EXPECT_EQ(kinds.size(), 9u);  // all but those that are made of points
}

TEST(Contract, VertexIsAtTheOriginAndItsCurvatureIsTheSecondDerivative) {
  for_each_instance([](const auto& shape, const Instance& instance) {
    if (instance.name.starts_with("zernike") || instance.name.ends_with("about the origin")) return;  // piston moves it, as the terms and nodes say
    EXPECT_EQ(shape.sag(0.0, 0.0), 0);
    const Fifty h("1e-12");
    const Fifty second = (shape.sag(Fifty(0), h) - 2 * shape.sag(Fifty(0), Fifty(0)) + shape.sag(Fifty(0), Fifty(-h))) / (h * h);
    EXPECT_NEAR(shape.vertex_curvature(), static_cast<double>(second), 1e-11);  // h times the third derivative
    const Fifty second_x = (shape.sag(h, Fifty(0)) - 2 * shape.sag(Fifty(0), Fifty(0)) + shape.sag(Fifty(-h), Fifty(0))) / (h * h);
    EXPECT_NEAR(vertex_curvature_x(surface::Shape(shape)), static_cast<double>(second_x), 1e-11);
  });
}

TEST(Contract, GradientIsTheDifferenceOfTheSag) {
  int count = 0;
  for_each_instance([&](const auto& shape, const Instance& instance) {
    for (const Line& line : lines_to(instance.radius, 0, 200)) {
      const Fifty x(line.start.x), y(line.start.y), h("1e-18");
      const auto gradient = shape.gradient(line.start.x, line.start.y);
      const double along_x = static_cast<double>(Fifty((shape.sag(Fifty(x + h), y) - shape.sag(Fifty(x - h), y)) / (2 * h)));
      const double along_y = static_cast<double>(Fifty((shape.sag(x, Fifty(y + h)) - shape.sag(x, Fifty(y - h))) / (2 * h)));
      // some 30 roundings of terms of the size of the slopes, magnified beside the rim by 1/(1 + slope^2)
      const double tolerance = 100 * eps * (1 + along_x * along_x + along_y * along_y);
      EXPECT_NEAR(gradient.x, along_x, tolerance) << line.start.x << " " << line.start.y;
      EXPECT_NEAR(gradient.y, along_y, tolerance) << line.start.x << " " << line.start.y;
      EXPECT_LT(std::hypot(along_x, along_y), 3);
      ++count;
    }
  });
  EXPECT_EQ(count, 200 * 24);
}

// The hit is where 50 digits find it. The line is off by the rounding of its start and of its nearest point, some eps of 40 mm; that moves the hit by 1/cos I,
// the surface's own rounding by as much again.
TEST(Contract, HitLiesOnTheLineAndOnTheSurfaceAsInFiftyDigits) {
  int hits = 0, others = 0;
  for_each_instance([&](const auto& shape, const Instance& instance) {
    int here = 0;
    for (const Line& line : lines_to(instance.radius, 40, 1000)) {
      const auto crossing = shape.meet(line.start, line.d);
      const auto exact = shape.meet(vec3_cast<Fifty>(line.start), normalized(vec3_cast<Fifty>(line.d)));
      EXPECT_EQ(crossing.status, exact.status);
      if (crossing.status != Status::ok) {
        ++others;
        EXPECT_TRUE(std::isnan(crossing.path));
        continue;
      }
      ++here;
      const double per_cosine = norm(crossing.normal) / std::abs(crossing.along);
      const double tolerance = 16 * eps * 60 * per_cosine;
      EXPECT_NEAR(crossing.path, static_cast<double>(exact.path), tolerance);
      EXPECT_NEAR(static_cast<double>(Fifty(shape.sag(exact.point.x, exact.point.y) - exact.point.z)), 0, 1e-40);
      EXPECT_GT(crossing.along * line.d.z, 0);  // in the line's own sense
      EXPECT_GT(crossing.normal.z, 0);
      const auto slope = shape.gradient(exact.point.x, exact.point.y);
      EXPECT_NEAR(-crossing.normal.x / crossing.normal.z, static_cast<double>(slope.x), tolerance * (1 + instance.steepest));
      EXPECT_NEAR(-crossing.normal.y / crossing.normal.z, static_cast<double>(slope.y), tolerance * (1 + instance.steepest));
    }
    EXPECT_GT(here, 800);
    hits += here;
  });
  EXPECT_EQ(hits + others, 1000 * 24);
}

// A line turned round crosses in the other sense: where it crosses once, at the same place.
TEST(Contract, ReversedLineFindsTheSamePoint) {
  int count = 0;
  for_each_instance([&](const auto& shape, const Instance& instance) {
    for (const Line& line : lines_to(instance.radius, 30, 300)) {
      const auto there = shape.meet(line.start, line.d);
      if (there.status != Status::ok) continue;
      const auto back = shape.meet(line.start + 50.0 * line.d, -line.d);
      ASSERT_EQ(back.status, Status::ok);
      EXPECT_NEAR(50 - back.path, there.path, 16 * eps * 80 * norm(there.normal) / std::abs(there.along));
      ++count;
    }
  });
  EXPECT_GT(count, 250 * 24);
}

TEST(Contract, WhatMeetsNothingIsAStatusAndNoNumberOfAHitIsNaN) {
  int hits = 0, lost = 0;
  for_each_instance([&](const auto& shape, const Instance& instance) {
    for (const Line& line : lines_to(6 * instance.radius, 89.9, 3000)) {
      const auto crossing = shape.meet(line.start, line.d);
      if (crossing.status != Status::ok) {
        EXPECT_TRUE(std::isnan(crossing.path));
        EXPECT_TRUE(crossing.status == Status::missed || crossing.status == Status::not_converged || (crossing.status == Status::outside_data && instance.name.starts_with("grid")));
        ++lost;
        continue;
      }
      ++hits;
      const Vec3<double>&p = crossing.point, &n = crossing.normal;
      EXPECT_TRUE(std::isfinite(crossing.path + p.x + p.y + p.z + n.x + n.y + n.z + crossing.along));
    }
  });
  EXPECT_EQ(hits + lost, 3000 * 24);
  EXPECT_GT(hits, 10000);
  EXPECT_GT(lost, 3000);
}

// What keeps the iterations from stepping over a crossing: the bounds of slopes and second derivatives hold wherever they are asked for, to 1e-9.
TEST(Contract, BoundsOfSlopesAndSecondDerivativesHold) {
  int slopes = 0, bends = 0;
  for_each_instance([&]<class S>(const S& shape, const Instance& instance) {
    const Fifty h("1e-15");
    std::mt19937_64 engine(9);
    const auto u = [&](double low, double high) { return low + (high - low) * static_cast<double>(engine() >> 11) * 0x1p-53; };
    for (const Line& line : lines_to(.9 * instance.radius, 89, 500)) {
      const Vec3<Fifty> at = vec3_cast<Fifty>(Vec3<double>{line.start.x, line.start.y, 0}), d = vec3_cast<Fifty>(line.d);
      if constexpr (requires { shape.bend_on(at, d, h); }) {  // of a grid, beyond its rim too
        const auto height = [&](const Fifty& t) { return shape.height(Fifty(at.x + t * d.x), Fifty(at.y + t * d.y)).z; };
        const auto second = [&](double t) { return std::abs(static_cast<double>(Fifty((height(t + h) - 2 * height(t) + height(t - h)) / (h * h)))); };
        const double length = u(0, .3), bound = shape.bend_on(vec3_cast<double>(at), line.d, length);
        if (!std::isfinite(bound)) continue;
        for (const double t : {-length, -.5 * length, 0.0, .7 * length, length}) EXPECT_LE(second(t), bound * (1 + 1e-9) + 1e-15);
        ++bends;
      }
      if constexpr (requires { shape.sum_of_polynomial(h, h); }) {
        const auto sum = shape.sum(line.start.x, line.start.y);
        const double r_squared = line.start.x * line.start.x + line.start.y * line.start.y;
        EXPECT_LE(sum.along_x * sum.along_x + sum.along_y * sum.along_y, shape.steepest_squared_within(r_squared) * (1 + 1e-9));
        const auto of_sum = [&](const Fifty& t) { return shape.sum(Fifty(at.x + t * d.x), Fifty(at.y + t * d.y)).value; };
        const double sine = std::hypot(line.d.x, line.d.y), bend = std::abs(static_cast<double>(Fifty((of_sum(h) - 2 * of_sum(0) + of_sum(-h)) / (h * h))));
        EXPECT_LE(bend, shape.bound_within(std::sqrt(r_squared), 2) * (1 + 1e-9) * sine * sine + 1e-15);
        const Fifty w("1e-10");  // its square times the fifth derivative is what the quotient is off by
        const double third = std::abs(static_cast<double>(Fifty((of_sum(2 * w) - 2 * of_sum(w) + 2 * of_sum(-w) - of_sum(-2 * w)) / (2 * w * w * w))));
        EXPECT_LE(third, shape.bound_within(std::sqrt(r_squared), 3) * (1 + 1e-9) * sine * sine * sine + 1e-13);
        ++slopes;
      }
    }
  });
  EXPECT_EQ(slopes, 7 * 500);
  EXPECT_GT(bends, 12 * 400);
}

// On surfaces that fold under slanted lines: the hit is the one continuous with the base's, by small steps from there to where lambda = g/(g - f)
// (first_crossing.h) comes to 1, stops to rise, or the surface ends. 2026-11-22: lambda was looked at where a step ends alone, and one line of the polynomial
// was given a hit 8.9 mm behind its fold.
TEST(Contract, HitIsTheOneContinuousWithTheBase) {
  numerics::Arena arena;
  const auto asphere = made<Asphere>({{{"radius_mm", 12}, {"conic_constant", -.8}}, {{4, 6e-3}, {6, -3e-4}, {7, 1e-6}}}, arena);
  const auto xy = made<XyPolynomial>({{{"radius_mm", 20}}, {{4, .1}, {6, .02}, {8, -.03}, {12, .004}}}, arena);
  const auto biconic = Biconic::of({1 / 9.0, .3}, {1 / 20.0, -1.5});
  const auto toroid = made<Toroid>({{{"radius_rotation_mm", 25}, {"radius_mm", -30}}, {{2, .2}, {4, -.02}, {6, 4e-4}}}, arena);
  const auto check = [](const char* name, const auto& shape, int least_slow, int least_outside = 0) {
    SCOPED_TRACE(name);
    int agree = 0, differ = 0, hits = 0, folded = 0, slow = 0, outside = 0;
    for (const Line& line : lines_to(6, 88, 2000)) {
      const auto start = shape.base.meet(line.start, line.d);
      if (start.status != Status::ok) continue;
      const auto crossing = shape.meet(line.start, line.d);
      const auto f_at = [&](double t) { return start.point.z + t * line.d.z - shape.height(start.point.x + t * line.d.x, start.point.y + t * line.d.y).z; };
      const auto g_at = [&](double t) { return start.point.z + t * line.d.z - shape.base.sag(start.point.x + t * line.d.x, start.point.y + t * line.d.y); };
      // Of a hit of the base beyond the surface's rim the way begins at the rim, on the side where it leads inward.
      const auto sense_at = [&](double t) { return (f_at(t) < 0) == (start.along > 0) ? 1 : -1; };
      double t = 0;
      for (int k = 1; std::isnan(f_at(t)) && k < 400000; ++k)
        if (const double beside = (k % 2 == 0 ? 1 : -1) * 1e-4 * k; !std::isnan(f_at(beside)) && sense_at(beside) * beside > 0) t = beside;
      const double f_0 = f_at(t), step = sense_at(t) * 2e-4;
      double lambda = 0;
      bool is_hit = false;
      for (int k = 0; k < 200000; ++k) {
        t += step;
        const double f = f_at(t), next = g_at(t) / (g_at(t) - f);
        is_hit = f * f_0 <= 0;
        if (is_hit || !(next > lambda) || !(std::abs(t) < 40)) break;
        lambda = next;
      }
      bool same = is_hit ? crossing.status == Status::ok && std::abs(crossing.path - start.path - t) <= 2 * std::abs(step) : crossing.status != Status::ok;
      if constexpr (requires { shape.has_data(t, t); })  // where there are none, there is no hit, though there may be a surface for rays to pass over
        if (const Vec3<double> at = start.point + t * line.d; is_hit && !shape.has_data(at.x, at.y)) same = crossing.status == Status::outside_data, ++outside;
      ++(same ? agree : differ);
      ++(is_hit ? hits : folded);
      slow += crossing.status == Status::ok && std::abs(crossing.path - start.path) > .5;
    }
    EXPECT_GT(hits, 900);
    EXPECT_GT(slow, least_slow);
    EXPECT_GT(agree, 1500);
    EXPECT_EQ(differ, 0) << hits << " hits, " << folded << " folded";
    EXPECT_GE(outside, least_outside);
  };
  check("asphere", asphere, 100);
  check("xy polynomial", xy, 100);
  check("biconic", biconic, 20);
  check("toroid", toroid, 100);
  SagGrid waves = sag_grid({23, 23, .5, .5}, [](double x, double y) { return of_waves(.8, x, y); });
  check("grid", grid_on(with_hole(with_hole(std::move(waves), 15, 11), 14, 11), arena, {1 / 20.0, 0}), 100, 50);
}

}  // namespace
}  // namespace sagitta::surface
