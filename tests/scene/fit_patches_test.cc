// SPDX-License-Identifier: Apache-2.0
#include "lib/scene/fit_patches.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <numeric>

#include "lib/scene/cubic_fit.h"
#include "lib/surface/patches.h"
#include "tests/support/point_sets.h"

namespace sagitta::scene {
namespace {

using namespace sagitta::tests;
using surface::CloughTocherPatch;
using V = numerics::Vec3<double>;

double cubic(double x, double y) {
  return 0.3 + 0.1 * x - 0.2 * y + 0.06 * x * x + 0.01 * x * y + 0.07 * y * y + 0.003 * x * x * x - 0.002 * x * x * y +
         0.004 * x * y * y - 0.001 * y * y * y;
}

bool have_same_bits(const CloughTocherPatch& a, const CloughTocherPatch& b) { return std::memcmp(&a, &b, sizeof a) == 0; }

TEST(FitPatches, give_the_same_bits_on_any_number_of_threads) {
  for (const Layout& layout : all_layouts(20000)) {
    const auto mesh = triangulate(cloud_of(layout.places, sphere(9))).mesh;
    const PatchFit one = fit_patches(mesh->mesh, 1);
    for (const int thread_count : {2, 3, 8}) {
      const PatchFit several = fit_patches(mesh->mesh, thread_count);
      ASSERT_EQ(one.patches.size(), several.patches.size());
      EXPECT_TRUE(std::equal(one.patches.begin(), one.patches.end(), several.patches.begin(), have_same_bits)) << layout.name;
      EXPECT_EQ(one.reaches_rim, several.reaches_rim);
    }
  }
}

// The same mesh with its facets in another order: rings reach the vertices in another order, and other vertices share a
// vector, so that the fits' sums round otherwise. (Vertices keep their numbers.) Tolerance: by (3) of cubic_fit.h 1000 times
// the rounding of heights up to 1.6, 4e-13; e is an edge's length, at most 5, times a gradient's error over the spacing of
// the points that it was fitted to, a tenth of that or more.
TEST(FitPatches, depend_on_the_order_of_facets_by_rounding_alone) {
  for (const Layout& layout : all_layouts(3000)) {
    const auto storage = triangulate(cloud_of(layout.places, sphere(9))).mesh;
    std::vector<std::uint32_t> moved(storage->facets.size());
    std::iota(moved.begin(), moved.end(), 0u);
    std::shuffle(moved.begin(), moved.end(), std::mt19937_64(4));
    std::vector<surface::Facet> facets(moved.size());
    std::vector<surface::Corners> corners(moved.size());
    for (std::size_t f = 0; f < moved.size(); ++f) {
      facets[moved[f]] = storage->facets[f];
      corners[moved[f]] = storage->corners[f];
      for (std::uint32_t& next : facets[moved[f]].neighbour) next = next == surface::no_facet ? next : moved[next];
    }
    surface::Mesh shuffled = storage->mesh;
    shuffled.facets = facets.data();
    shuffled.corners = corners.data();
    const PatchFit straight = fit_patches(storage->mesh), other = fit_patches(shuffled);
    EXPECT_EQ(straight.reaches_rim, other.reaches_rim);
    double largest = 0;
    for (std::size_t f = 0; f < moved.size(); ++f) {
      const CloughTocherPatch &p = straight.patches[f], &q = other.patches[moved[f]];
      EXPECT_TRUE(p.x == q.x && p.y == q.y && p.z == q.z && p.m1_x == q.m1_x && p.m2_y == q.m2_y);
      for (const double d : {p.e01 - q.e01, p.e12 - q.e12, p.e20 - q.e20, p.e10 - q.e10, p.e21 - q.e21, p.e02 - q.e02, p.q0 - q.q0, p.q1 - q.q1, p.q2 - q.q2})
        largest = std::max(largest, std::abs(d));
    }
    EXPECT_LE(largest, 4e-12) << layout.name;
  }
}

// On every layout, also turned (so that narrow neighbourhoods lie aslant), stretched 30 times and far from the origin.
// Tolerance: the fit's coefficients are right to 1000 eps of the heights around (3), at most 1e-13 of them after the
// shift's rounding of heights near 20; slopes divide that by the least spacing across, 5e-3.
TEST(FitPatches, are_exact_for_cubics_on_every_layout) {
  for (const Layout& layout : all_layouts(5000)) {
    for (const double turn : {0.0, 0.7}) {
      std::vector<Place2> places;
      for (const Place2& p : layout.places) {
        const double x = p.x / 30, y = p.y;
        places.push_back({x * std::cos(turn) - y * std::sin(turn), x * std::sin(turn) + y * std::cos(turn)});
      }
      const auto storage = triangulate(cloud_of(turn == 0 ? layout.places : places, cubic)).mesh;
      const PatchFit fit = fit_patches(storage->mesh);
      int compared = 0;
      for (std::uint32_t f = 0; f < storage->mesh.facet_count; ++f) {
        const auto& corner = storage->corners[f];
        if (fit.reaches_rim[corner[0]] || fit.reaches_rim[corner[1]] || fit.reaches_rim[corner[2]]) continue;
        ++compared;
        const auto& p = fit.patches[f];
        const auto sheet = p.evaluate(p.x, p.y, storage->facets[f]);
        ASSERT_NEAR(sheet.z, cubic(p.x, p.y), 1e-12) << layout.name << ' ' << turn;
        ASSERT_NEAR(sheet.dz_dx, 0.1 + 0.12 * p.x + 0.01 * p.y + 0.009 * p.x * p.x - 0.004 * p.x * p.y + 0.004 * p.y * p.y, 1e-10)
            << layout.name << ' ' << turn;
        ASSERT_NEAR(sheet.dz_dy, -0.2 + 0.01 * p.x + 0.14 * p.y - 0.002 * p.x * p.x + 0.008 * p.x * p.y - 0.003 * p.y * p.y, 1e-10)
            << layout.name << ' ' << turn;
      }
      EXPECT_GT(compared, 700) << layout.name;  // stretched 30 times, neighbourhoods are wide and reach the rim
    }
  }
}

// Where all points lie on few lines the polynomial of the degree that they determine is exact.
TEST(FitPatches, fall_back_to_what_the_points_determine) {
  const auto quadratic = [](double x, double y) { return 0.1 * x - 0.2 * y + 0.06 * x * x + 0.01 * x * y + 0.07 * y * y; };
  const auto plane = [](double x, double y) { return 1 + 0.1 * x - 0.2 * y; };
  const auto check = [](const std::vector<Place2>& places, const Height& height) {
    const auto storage = triangulate(cloud_of(places, height)).mesh;
    const auto patches = fit_patches(storage->mesh).patches;
    for (std::size_t f = 0; f < patches.size(); ++f) {
      const CloughTocherPatch& p = patches[f];
      const auto sheet = p.evaluate(p.x, p.y, storage->facets[f]);
      EXPECT_NEAR(sheet.z, height(p.x, p.y), 1e-12);
    }
  };
  std::vector<Place2> three_lines, two_lines;
  for (int i = 0; i < 400; ++i)
    for (const double y : {-0.5, 0.1, 0.6}) {
      three_lines.push_back({0.01 * i, y});
      if (y > 0) two_lines.push_back({0.01 * i, y});
    }
  check(three_lines, quadratic);
  check(two_lines, plane);
  check(uniform_random(9, 1, 3), quadratic);
  check(uniform_random(3, 1, 3), plane);
}

// White noise of 1 um on rings 0.17 mm apart: the surface may not make much more of it, neither in the innermost and the
// outermost gap nor on the outermost ring, where all points lie on one side. (2026-11-22: 5.9 um rms and 34 um at worst on the
// outermost ring, since fits took up noise 1000 times.) By (3) of cubic_fit.h a slope is known to 8 of the noise
// over the spread of its points, which is more than a spacing: 8 of the noise a spacing; a patch's edge
// coefficient (2) is a third of that, weighted by 4/9 at most in a patch: with the vertices' own noise 2.2 at most, and 4.5
// times that is passed once in a hundred thousand samples.
TEST(FitPatches, keep_the_noise_of_rings_in_bounds_up_to_the_rim) {
  for (const int meridians : {64, 256}) {
    const auto places = polar_rings(24, meridians, 24 * 0.17, false);
    Uniform u(5);
    const auto normal = [&] { return std::sqrt(-2 * std::log(1 - u())) * std::cos(2 * std::numbers::pi * u()); };
    const auto clean = triangulate(cloud_of(places, sphere(7.8))).mesh;
    auto cloud = cloud_of(places, sphere(7.8));
    for (auto& p : cloud.points) p.z += 1e-3 * normal();
    const auto noisy = triangulate(cloud).mesh;
    const auto of_clean = fit_patches(clean->mesh).patches, of_noisy = fit_patches(noisy->mesh).patches;
    const surface::Patches one{{&clean->mesh}, of_clean.data()}, other{{&noisy->mesh}, of_noisy.data()};
    for (double r = 0.02; r < 24 * 0.17; r += 0.085) {
      double squares = 0, most = 0;
      int count = 0;
      for (int i = 0; i < 500; ++i) {
        const double angle = u(0, 2 * std::numbers::pi), x = r * std::cos(angle), y = r * std::sin(angle);
        if (!one.facets.covers(x, y)) continue;
        const double difference = 1e3 * (other.sag(x, y) - one.sag(x, y));
        squares += difference * difference;
        most = std::max(most, std::abs(difference));
        ++count;
      }
      ASSERT_GT(count, 20) << r;
      EXPECT_LE(std::sqrt(squares / count), 2.2) << meridians << " meridians, r " << r;
      EXPECT_LE(most, 10) << meridians << " meridians, r " << r;
    }
  }
}

// A vertex says that its neighbourhood reaches the rim exactly when a vertex of its two rings lies there: on a regular
// grid, one of the first or last three rows or columns.
TEST(FitPatches, tell_which_vertices_reach_the_rim) {
  const auto storage = triangulate(cloud_of(regular_grid(41, 41, 20, 20), sphere(50))).mesh;
  const PatchFit fit = fit_patches(storage->mesh);
  int inside = 0;
  for (std::size_t v = 0; v < storage->vertices.size(); ++v) {
    const V& p = storage->vertices[v];
    EXPECT_EQ(fit.reaches_rim[v], std::max(std::abs(p.x), std::abs(p.y)) > 17.5);
    inside += !fit.reaches_rim[v];
  }
  EXPECT_EQ(inside, 35 * 35);
}

// Across a gap of 10, over 20 times a neighbour's distance of 0.3: one such neighbour is a stray point, two are a line, along
// which all points within the longest edge count, as far as the rim, 8 away.
TEST(FitPatches, reach_beyond_two_rings_where_points_crowd_along_a_line) {
  std::vector<Place2> places;
  for (int j = -8; j <= 8; ++j)
    for (int i = -8; i <= 8; ++i) places.push_back({i <= 0 ? 1.0 * i : 9.0 + i, 1.0 * j});
  const auto middle_reaches_rim = [&] {
    const auto storage = triangulate(cloud_of(places, sphere(50))).mesh;
    const auto middle = std::find(storage->vertices.begin(), storage->vertices.end(), V{0, 0, 0});
    return fit_patches(storage->mesh).reaches_rim.at(static_cast<std::size_t>(middle - storage->vertices.begin()));
  };
  EXPECT_FALSE(middle_reaches_rim());
  places.push_back({0, 0.3});
  EXPECT_FALSE(middle_reaches_rim());
  places.push_back({0, -0.3});
  EXPECT_TRUE(middle_reaches_rim());
}

// A patch away from the rim knows nothing of what lies further: other heights there change no bit of it.
TEST(FitPatches, away_from_the_rim_depend_on_two_rings_alone) {
  auto cloud = cloud_of(regular_grid(41, 41, 20, 20), sphere(50));
  const auto before = triangulate(cloud).mesh;
  for (V& p : cloud.points)
    if (std::max(std::abs(p.x), std::abs(p.y)) > 9.5) p.z += 1 + 0.1 * p.x;
  const auto after = triangulate(cloud).mesh;
  const PatchFit one = fit_patches(before->mesh), other = fit_patches(after->mesh);
  int same = 0, others = 0;
  for (std::uint32_t f = 0; f < before->mesh.facet_count; ++f) {
    const auto& p = one.patches[f];
    const bool near = std::max(std::abs(p.x), std::abs(p.y)) < 7;
    (near ? same : others) += have_same_bits(p, other.patches[f]);
  }
  EXPECT_EQ(same, 2 * 14 * 14);
  EXPECT_LT(others, 2 * 20 * 20);
}

// A lane's bits depend on nothing in the other lane, nor on what was fitted before.
TEST(CubicFits, lanes_do_not_meet) {
  const auto points_of = [](int count, std::uint64_t seed) {
    std::vector<V> points;
    for (const Place2& p : uniform_random(count, 1, seed)) points.push_back({p.x, p.y, cubic(p.x, p.y) + 0.01 * std::sin(9 * p.x)});
    return points;
  };
  std::vector<std::uint32_t> numbers(40);
  std::iota(numbers.begin(), numbers.end(), 0u);
  const auto few = points_of(20, 1), many = points_of(40, 2);
  CubicFits alone, together;
  alone.put(0, {}, few.data(), std::span(numbers).first(20));
  const CubicFit expected = alone.solve()[0];
  EXPECT_EQ(expected.terms, CubicFit::cubic_terms);
  together.put(0, {}, many.data(), numbers);
  together.put(1, {}, few.data(), std::span(numbers).first(20));
  EXPECT_EQ(together.solve()[1].c, expected.c);
  together.put(0, {}, few.data(), std::span(numbers).first(20));
  const auto last = together.solve();
  EXPECT_EQ(last[0].c, expected.c);
  EXPECT_EQ(last[1].terms, 0);  // nothing was put there since
}

// (3) by hand: on a line nothing is determined; five points determine no cubic; on a circle around V
// u^3 + u v^2 is a multiple of u.
TEST(CubicFits, determine_as_many_terms_as_the_points_do) {
  const auto terms_of = [](const std::vector<Place2>& places) {
    std::vector<V> points;
    for (const Place2& p : places) points.push_back({p.x, p.y, cubic(p.x, p.y)});
    std::vector<std::uint32_t> numbers(points.size());
    std::iota(numbers.begin(), numbers.end(), 0u);
    CubicFits fits;
    fits.put(0, {}, points.data(), numbers);
    const CubicFit fit = fits.solve()[0];
    const auto slope = fit.gradient(0.3, 0.4);
    EXPECT_TRUE(std::isfinite(slope.x) && std::isfinite(slope.y));
    return fit.terms;
  };
  std::vector<Place2> circle, line, axis;
  for (int i = 0; i < 20; ++i) {
    circle.push_back({std::cos(0.314 * i), std::sin(0.314 * i)});
    line.push_back({0.1 * i - 0.77, 0.3 * (0.1 * i - 0.77)});
    axis.push_back({0, 0.1 * i - 0.77});
  }
  EXPECT_EQ(terms_of(uniform_random(20, 1, 3)), 9);
  EXPECT_EQ(terms_of(uniform_random(8, 1, 3)), 5);
  EXPECT_EQ(terms_of(uniform_random(4, 1, 3)), 2);
  EXPECT_EQ(terms_of(circle), 5);
  EXPECT_EQ(terms_of(line), 0);
  Uniform u(8);
  for (int round = 0; round < 100; ++round) {
    const double slope = u(-10, 10);
    std::vector<Place2> aslant;
    for (int i = 0; i < 20; ++i) aslant.push_back({u(-1, 1), 0});
    for (Place2& p : aslant) p.y = slope * p.x;  // rounded
    EXPECT_EQ(terms_of(aslant), 0);
  }
  EXPECT_EQ(terms_of(axis), 0);
  EXPECT_EQ(terms_of({}), 0);
}

}  // namespace
}  // namespace sagitta::scene
