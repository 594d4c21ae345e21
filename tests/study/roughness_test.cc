// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <boost/multiprecision/cpp_bin_float.hpp>

#include <array>
#include <cmath>
#include <numbers>

#include "lib/study/roughness.h"
#include "lib/study/uniform.h"

namespace sagitta::study {
namespace {

using Fifty = boost::multiprecision::number<boost::multiprecision::cpp_bin_float_50::backend_type, boost::multiprecision::et_off>;

// Over many surfaces at one place: each is one independent draw, and normal, so a mean over S of them has the standard error
// sqrt((1 + rho^2)/S) of s^2 for a product of correlation rho. Five of those; 64 waves are as normal as need be (their excess of -.02
// changes the error by a percent of itself).
TEST(Roughness, HasItsRmsAndCorrelationOverManySurfaces) {
  constexpr double rms = 3, length = .02;
  constexpr int surfaces = 4000;
  const std::array<double, 5> lags{0, .25, .5, 1, 2};  // of l
  std::array<double, lags.size()> product{};
  double mean = 0, slope_x = 0, slope_y = 0;
  for (std::uint64_t seed = 1; seed <= surfaces; ++seed) {
    const Roughness surface(rms, length, seed, 64);
    const double angle = static_cast<double>(seed);
    const auto here = surface.height(1.25, -.5);
    mean += here.z / rms / surfaces;
    slope_x += here.dz_dx * here.dz_dx * length * length / (2 * rms * rms) / surfaces;
    slope_y += here.dz_dy * here.dz_dy * length * length / (2 * rms * rms) / surfaces;
    for (std::size_t i = 0; i < lags.size(); ++i) {
      const double r = lags[i] * length;
      product[i] += here.z * surface.height(1.25 + r * std::cos(angle), -.5 + r * std::sin(angle)).z / (rms * rms) / surfaces;
    }
  }
  EXPECT_NEAR(mean, 0, 5 / std::sqrt(surfaces));
  EXPECT_NEAR(slope_x, 1, 5 * std::sqrt(2.0 / surfaces));  // <h_x^2> = 2 s^2/l^2
  EXPECT_NEAR(slope_y, 1, 5 * std::sqrt(2.0 / surfaces));
  for (std::size_t i = 0; i < lags.size(); ++i) {
    const double rho = std::exp(-lags[i] * lags[i]);
    EXPECT_NEAR(product[i], rho, 5 * std::sqrt((1 + rho * rho) / surfaces)) << lags[i];
  }
}

// Over one surface: pairs 1000 l apart are independent. The header's error of 256 waves, .0027 rms of s^2 (over surfaces and lags), three
// times, beside five standard errors of the samples. 256 independent waves would be off by .034 rms: a drawing that is not even is seen.
TEST(Roughness, KeepsItsCorrelationOnEverySurface) {
  constexpr int samples = 100000;
  for (const std::uint64_t seed : {1, 2, 3}) {
    const double length = seed == 1 ? .001 : 1;  // mm: 1 um and 1000 um
    const Roughness surface(1, length, seed);
    Uniform u(seed + 100);
    std::vector<Site> here, there;
    for (int i = 0; i < samples; ++i) {
      here.push_back({u(-1e5, 1e5) * length, u(-1e5, 1e5) * length});
      there.push_back({here.back().x + .6 * length, here.back().y + .8 * length});  // one l away
    }
    const auto at_here = heights(surface, here, 2), at_there = heights(surface, there, 2);
    double square = 0, product = 0;
    for (std::size_t i = 0; i < here.size(); ++i) square += at_here[i] * at_here[i] / samples, product += at_here[i] * at_there[i] / samples;
    EXPECT_NEAR(square, 1, 5 * std::sqrt(2.0 / samples)) << seed;
    EXPECT_NEAR(product, std::exp(-1), 5 * std::sqrt((1 + std::exp(-2)) / samples) + 3 * .0027) << seed;
  }
}

TEST(Roughness, HasTheGradientOfItsHeight) {
  const Roughness surface(.0001, .001, 4);
  Uniform u(1);
  for (int i = 0; i < 20; ++i) {
    const Fifty x = u(-12, 12), y = u(-12, 12), step = 1e-18;  // central: off by step^2 times the third derivative, 1e-36 x 1e6
    const auto at = surface.height(x, y);
    EXPECT_LT(abs((surface.height(Fifty(x + step), y).z - surface.height(Fifty(x - step), y).z) / (2 * step) - at.dz_dx), 1e-25);
    EXPECT_LT(abs((surface.height(x, Fifty(y + step)).z - surface.height(x, Fifty(y - step)).z) / (2 * step) - at.dz_dy), 1e-25);
    EXPECT_LE(abs(at.z), at.magnitude);
  }
}

TEST(Roughness, IsTheSameInDoubleAndInFiftyDigits) {
  const Roughness surface(.0001, .001, 9);
  Uniform u(2);
  // A phase of up to |k| |p| = 8e3/mm x 17 mm = 1.4e5 has three roundings of 2e5 eps/2; 256 of them, in the worst case, of the amplitude
  // s sqrt(2/256).
  const double bound = .0001 * std::sqrt(2.0 / 256) * 256 * 3 * 2e5 * 1.2e-16;
  for (int i = 0; i < 20; ++i) {
    const double x = u(-12, 12), y = u(-12, 12);
    EXPECT_LT(abs(Fifty(surface.height(x, y).z) - surface.height(Fifty(x), Fifty(y)).z), bound);
  }
}

TEST(Roughness, HasTheSameHeightsOnAnyNumberOfThreads) {
  const Roughness surface(1, 1, 5);
  std::vector<Site> places;
  Uniform u(3);
  for (int i = 0; i < 10000; ++i) {
    const double x = u(-5, 5), y = u(-5, 5);
    places.push_back({x, y});
  }
  const auto one = heights(surface, places, 1), three = heights(surface, places, 3);
  EXPECT_EQ(one, three);
  for (std::size_t i = 0; i < places.size(); i += 1000) EXPECT_EQ(one[i], surface.height(places[i].x, places[i].y).z);
  EXPECT_NE(one, heights(Roughness(1, 1, 6), places, 1));
}

}  // namespace
}  // namespace sagitta::study
