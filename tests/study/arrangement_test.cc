// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <set>
#include <utility>

#include "lib/study/arrangement.h"
#include "lib/study/uniform.h"
#include "lib/trace/pattern.h"

namespace sagitta::study {
namespace {

constexpr double density = 49, radius = 3, h = 1.0 / 7, pi = std::numbers::pi;
std::vector<Site> sites(ArrangementKind kind, std::uint64_t seed = 1) { return sites_over_disc({kind, density}, radius, seed); }

TEST(Uniform, HasTheNumbersThatTheStandardFixes) {
  Uniform u(std::mt19937_64::default_seed);
  for (int i = 1; i < 10000; ++i) u();
  EXPECT_EQ(u(), static_cast<double>(9981545732273789042u >> 11) * 0x1p-53);  // [rand.predef]: the 10000th number
}

TEST(Arrangements, AreNamedBothWays) {
  for (const auto name : arrangement_names) EXPECT_EQ(name_of(*arrangement_named(name)), name);
  EXPECT_FALSE(arrangement_named("hexagonal"));
}

TEST(Arrangements, HaveTheirDensityInsideTheDisc) {
  for (const auto kind : {ArrangementKind::regular, ArrangementKind::jittered, ArrangementKind::random}) {
    const auto places = sites(kind);
    // A cell of the grid counts for the disc or not by its own point: the cells that the circle crosses lie within h/sqrt 2 of it, for
    // jittered points within sqrt 2 h. That is less than 2 pi R 2 sqrt 2 h density of them.
    EXPECT_NEAR(static_cast<double>(places.size()), density * pi * radius * radius, 2 * pi * radius * 2 * std::numbers::sqrt2 * h * density)
        << name_of(kind);
    EXPECT_GT(places.size(), 1000u);
    for (const Site& site : places) EXPECT_LE(std::hypot(site.x, site.y), radius * (1 + 1e-15));
  }
}

TEST(Arrangements, OfOneSeedAreOne) {
  for (const auto kind : {ArrangementKind::jittered, ArrangementKind::random}) {
    const auto a = sites(kind, 5), b = sites(kind, 5), c = sites(kind, 6);
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) EXPECT_TRUE(a[i].x == b[i].x && a[i].y == b[i].y);
    EXPECT_NE(a.front().x, c.front().x);
  }
}

// From one generator the sites of a seed would be the places of the rays random:SEED.
TEST(Arrangements, OfASeedDoNotStandWhereItsRaysGo) {
  const auto rays = trace::pupil_points({trace::PatternKind::random, 3}, 1000);
  const auto places = sites_over_disc({ArrangementKind::random, 1000}, 1, 3);
  for (std::size_t i = 0; i < 1000; ++i) EXPECT_GT(std::hypot(rays[i].x - places[i].x, rays[i].y - places[i].y), 1e-6);
}

TEST(Arrangements, WithoutDensityOrRadiusAreEmpty) {
  EXPECT_TRUE(sites_over_disc({ArrangementKind::regular, 0}, 3, 1).empty());
  EXPECT_TRUE(sites_over_disc({ArrangementKind::random, std::nan("")}, 3, 1).empty());
  EXPECT_TRUE(sites_over_disc({ArrangementKind::rings, 10}, -1, 1).empty());
}

TEST(Regular, IsASquareGridOffEverySymmetryOfTheRays) {
  const auto places = sites(ArrangementKind::regular);
  int neighbours = 0;
  for (const Site& site : places) {
    // The shift's parts of h are .414 and .732: .268 h from the x axis at least, .414 h from the y axis, .318 h/sqrt 2 and
    // .146 h/sqrt 2 from the diagonals.
    for (const double distance : {site.x, site.y, (site.x - site.y) / std::numbers::sqrt2, (site.x + site.y) / std::numbers::sqrt2})
      EXPECT_GT(std::abs(distance), .1 * h);
    neighbours += static_cast<int>(std::count_if(places.begin(), places.end(), [&](const Site& other) {
      return std::abs(other.x - site.x - h) < 1e-12 && std::abs(other.y - site.y) < 1e-12;
    }));
  }
  EXPECT_NEAR(neighbours, static_cast<double>(places.size()), 2 * radius / h + 3);  // all but the last of each row
}

TEST(Jittered, HasEachPointInItsOwnCell) {
  const auto places = sites(ArrangementKind::jittered);
  std::set<std::pair<int, int>> cells;
  double sum = 0, squares = 0;
  for (const Site& site : places) {
    const double u = site.x / h - (std::numbers::sqrt2 - 1), v = site.y / h - (std::numbers::sqrt3 - 1);
    EXPECT_TRUE(cells.emplace(static_cast<int>(std::lround(u)), static_cast<int>(std::lround(v))).second);
    if (std::hypot(site.x, site.y) > radius - 2 * h) continue;  // cells that are there only if their point fell inside
    for (const double off : {u - std::round(u), v - std::round(v)}) sum += off, squares += off * off;
  }
  // Uniform over a unit: variance 1/12, that of the square 1/180. Five standard errors of some 2 x 1100 numbers.
  const double count = 2.0 * static_cast<double>(std::count_if(places.begin(), places.end(), [](const Site& site) { return std::hypot(site.x, site.y) <= radius - 2 * h; }));
  EXPECT_GT(count, 2000);
  EXPECT_NEAR(sum / count, 0, 5 / std::sqrt(12 * count));
  EXPECT_NEAR(squares / count, 1.0 / 12, 5 / std::sqrt(180 * count));
}

TEST(Random, IsUniformOverTheDisc) {
  const auto places = sites_over_disc({ArrangementKind::random, 1000}, radius, 3);
  ASSERT_EQ(static_cast<double>(places.size()), std::round(1000 * pi * radius * radius));
  // r^2/R^2 and the angle are uniform. Five standard errors.
  double squares = 0, x = 0, y = 0;
  const auto count = static_cast<double>(places.size());
  for (const Site& site : places) {
    const double r = std::hypot(site.x, site.y);
    squares += r * r / (radius * radius) / count;
    x += site.x / r / count, y += site.y / r / count;
  }
  EXPECT_NEAR(squares, .5, 5 / std::sqrt(12 * count));
  EXPECT_NEAR(x, 0, 5 / std::sqrt(2 * count));
  EXPECT_NEAR(y, 0, 5 / std::sqrt(2 * count));
}

TEST(Rings, AreThoseOfAPlacidoDevice) {
  const auto given = sites_over_disc({ArrangementKind::rings, 0, 24, 180}, 3.6, 1);
  ASSERT_EQ(given.size(), 24u * 180u);
  for (std::size_t i = 0; i < given.size(); ++i) {
    const auto ring = static_cast<double>(i / 180 + 1), angle = 2 * pi * static_cast<double>(i % 180) / 180;
    EXPECT_NEAR(given[i].x, 3.6 * ring / 24 * std::cos(angle), 1e-15);
    EXPECT_NEAR(given[i].y, 3.6 * ring / 24 * std::sin(angle), 1e-15);
  }
  EXPECT_DOUBLE_EQ(spacing_of({ArrangementKind::rings, 0, 24, 180}, 3.6), .15);
  const auto by_density = sites_over_disc({ArrangementKind::rings, 24 * 180 / (pi * 3.6 * 3.6)}, 3.6, 1);
  ASSERT_EQ(by_density.size(), given.size());
  EXPECT_EQ(by_density.back().x, given.back().x);
}

}  // namespace
}  // namespace sagitta::study
