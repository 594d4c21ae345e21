// SPDX-License-Identifier: Apache-2.0
// Zernike surfaces that fold under slanted light: gull wings, dimples, steep terms. The hit must be the one continuous with the base conic's,
// which the textbook follows in 64 bits of mantissa (textbook.h); where there is none, there is no point.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>

#include "tests/extreme/textbook.h"
#include "tests/support/prescriptions.h"

namespace sagitta::test {
namespace {

using Extended = long double;

struct Wild {
  std::mt19937_64 random{7};
  double uniform(double from, double to) { return std::uniform_real_distribution<double>(from, to)(random); }

  // Slopes from gentle to 10: terms of 10 um to 2 mm, up to order 6.
  prescription::Shape shape() {
    std::vector<std::pair<int, double>> terms;
    for (const int index : {3, 4, 5, 7, 8, 12, 24}) terms.push_back({index, uniform(-1, 1) * std::pow(10.0, uniform(1, 3.3))});
    return zernike_shape(uniform(0, 1) < .5 ? 10 : -10, uniform(-2, .5), uniform(2, 4), terms);
  }
  GlobalRay ray() {
    const double tilt = uniform(0, 1.2), azimuth = uniform(0, 6.283);
    const Vec3<double> d{std::sin(tilt) * std::cos(azimuth), std::sin(tilt) * std::sin(azimuth), std::cos(tilt)}, at{uniform(-3, 3), uniform(-3, 3), 0};
    return {at + -4.0 * d, normalized(d)};
  }
};

// A surface whose heights are counted.
struct Looks {
  const surface::Zernike& zernike;
  surface::Conic base = zernike.base;
  mutable int count = 0;

  template <class T>
  surface::Height<T> height(const T& x, const T& y) const {
    ++count;
    return zernike.height(x, y);
  }
  template <class T>
  T bound_within(const T& radius, int derivatives) const { return zernike.bound_within(radius, derivatives); }
  template <class T>
  T reach_from(const T& radius) const { return zernike.reach_from(radius); }

  // As Zernike::meet() looks: Newton's method, and where that does not settle it, step by safe step.
  surface::Crossing<double> meet(const Vec3<double>& p, const Vec3<double>& d) {
    count = 0;
    const auto start = base.meet(p, d);
    if (start.status != Status::ok) return start;
    surface::Zernike::Approach<double> approach;
    for (; count < surface::Zernike::most_looks && approach.state == approach.going; ++count)
      approach = zernike.look_at(start.point, d, approach, zernike.sum(start.point.x + approach.t * d.x, start.point.y + approach.t * d.y), count == 0);
    if (approach.state == approach.arrived && zernike.passes_no_other(start.point, d, approach)) return {start.path + approach.t, {}, {}, 0, Status::ok};
    return first_crossing(*this, start, d);
  }
};

// 2026-11-22: of these 40000 rays, 59 were given a point behind the hit (system 7, ray 31: path 2.219272533105815 for 4.814077458643277),
// 38 a point where the hit has ended at a fold, and 2148 that have a hit were lost as not_converged. On the same day, after the first mending,
// 3 were given a point behind two folds between two looks, where lambda falls and rises again.
TEST(Folds, HitIsTheOneContinuousWithTheBaseConics) {
  Wild wild;
  std::map<std::string, int> counts;
  std::vector<int> looks;
  for (int system = 0; system < 400; ++system) {
    const prescription::Shape shape = wild.shape();
    numerics::Arena arena;
    const auto zernike = surface::Zernike::from(shape.parameters, arena);
    const TextbookDeparture<Extended> exact{{shape}};
    Looks counted{zernike};
    for (int i = 0; i < 100; ++i) {
      const GlobalRay ray = wild.ray();
      const auto ours = zernike.meet(ray.p, ray.d);
      const auto truth = exact.meet(vec3_cast<Extended>(ray.p), vec3_cast<Extended>(ray.d));
      EXPECT_EQ(counted.meet(ray.p, ray.d).status, ours.status);
      looks.push_back(counted.count);
      ASSERT_EQ(ours.status, truth.status) << system << ' ' << i;
      ++counts[std::string(surface::status_names[static_cast<std::size_t>(ours.status)])];
      if (ours.status != Status::ok) continue;
      // f ends at the rounding of its terms, 8 eps of them, over its slope along the line; 8 ulp of the path
      const double terms = zernike.height(ours.point.x, ours.point.y).magnitude, eps = std::numeric_limits<double>::epsilon();
      ASSERT_NEAR(ours.path, static_cast<double>(truth.path), 8 * eps * (4 + std::abs(ours.path) + terms / std::abs(ours.along))) << system << ' ' << i;
    }
  }
  EXPECT_EQ(looks.size(), 40000u);
  EXPECT_GT(counts["ok"], 30000);
  EXPECT_GT(counts["not_converged"], 5000);
  EXPECT_LE(counts["ended at a fold between two looks"], 4);  // of 40000
  std::sort(looks.begin(), looks.end());
  double sum = 0;
  for (const int count : looks) sum += count;
  fmt::print("looks | 400 Zernike surfaces that fold, 40000 rays | mean {:.2f} | 99 % within {} | worst {} |\n", sum / static_cast<double>(looks.size()), looks[looks.size() * 99 / 100], looks.back());
  EXPECT_LT(looks.back(), surface::Zernike::most_looks + surface::most_first_crossing_looks);
}

// What a cornea costs: nothing, Newton's method settles every ray.
TEST(Folds, NewtonAloneSettlesCorneas) {
  numerics::Arena arena;
  const auto zernike = surface::Zernike::from(zernike_shape(7.8, -.25, 4, {{3, 1}, {4, -2}, {5, 3}, {7, 1.5}, {8, -1}, {12, 2}, {24, .3}}).parameters, arena);
  Looks counted{zernike};
  Wild wild;
  int worst = 0, total = 0;
  for (int i = 0; i < 10000; ++i) {
    const double tilt = wild.uniform(0, .7), x = wild.uniform(-2.5, 2.5), y = wild.uniform(-2.5, 2.5);
    const Vec3<double> d = normalized(Vec3<double>{0, std::sin(tilt), std::cos(tilt)});
    ASSERT_EQ(counted.meet(Vec3<double>{x, y, .5} + -3.0 * d, d).status, Status::ok);
    worst = std::max(worst, counted.count);
    total += counted.count;
  }
  fmt::print("looks | cornea, 10000 rays up to 40 degrees | mean {:.2f} | worst {} |\n", total / 1e4, worst);
  EXPECT_LE(worst, surface::Zernike::most_looks);
}

}  // namespace
}  // namespace sagitta::test
