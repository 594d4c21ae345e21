// SPDX-License-Identifier: Apache-2.0
// What is triangulated of a cloud within a window, facet by facet, against the whole cloud: the same corners in the same
// order, the same planes, the same interpolants, to the last bit.
#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <map>

#include "lib/scene/fit_patches.h"
#include "lib/scene/fit_radial.h"
#include "lib/scene/triangulate.h"
#include "tests/support/point_sets.h"

namespace sagitta::scene {
namespace {

using namespace sagitta::tests;
using surface::no_facet;
using Triangle = std::array<std::array<double, 3>, 3>;  // corners in their order

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double inf = std::numeric_limits<double>::infinity();

Triangle triangle_of(const MeshStorage& mesh, std::size_t facet) {
  Triangle result;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto& v = mesh.vertices[mesh.corners[facet][i]];
    result[i] = {v.x, v.y, v.z};
  }
  return result;
}

// Points that grow denser toward the middle, with a rim of long slivers; some are holes, some are there twice.
std::vector<Place2> comet(int count, std::uint64_t seed) {
  Uniform u(seed);
  std::vector<Place2> places;
  for (int i = 0; i < count; ++i) {
    const double r = 5 * std::pow(u(), 2.0), angle = u(0, 2 * std::numbers::pi);
    places.push_back({r * std::cos(angle), r * std::sin(angle)});
  }
  return places;
}

struct Sample {
  std::string name;
  PointCloud cloud;
  double max_edge;
};
std::vector<Sample> samples() {
  std::vector<Sample> result;
  std::vector<Layout> layouts = all_layouts(900);
  for (std::uint64_t seed = 1; seed <= 4; ++seed) layouts.push_back({"comet", comet(300, seed)}), layouts.push_back({"sparse", uniform_random(200, 5, seed)});
  layouts.push_back({"regular, few", regular_grid(18, 18, 5, 5)});
  Uniform u(99);
  for (const Layout& layout : layouts)
    for (const double max_edge : {inf, 0.9}) {
      PointCloud cloud = cloud_of(layout.places, [&](double x, double y) { return sphere(12)(x, y) + 1e-3 * u(-1, 1); });
      for (auto& p : cloud.points)
        if (max_edge < inf && u() < 0.01) p.z = nan;
      if (max_edge < inf) cloud.points.push_back(cloud.points[7]);
      result.push_back({layout.name, std::move(cloud), max_edge});
    }
  return result;
}

Rectangle random_window(Uniform& u) {
  const double x = u(-4, 4), y = u(-4, 4), wide = u(0.5, 3.5), high = u(0.5, 3.5);
  return {x - wide, y - wide, x + wide, y + high};
}

// whole_of[f]: the facet of the whole cloud that facet f of the part is.
std::vector<std::uint32_t> match(const MeshStorage& part, const std::map<Triangle, std::uint32_t>& whole, const std::string& where) {
  std::vector<std::uint32_t> whole_of;
  for (std::size_t f = 0; f < part.facets.size(); ++f) {
    const auto found = whole.find(triangle_of(part, f));
    if (found == whole.end()) {
      ADD_FAILURE() << where << ": the whole cloud has no such facet";
      return {};
    }
    whole_of.push_back(found->second);
  }
  EXPECT_TRUE(std::is_sorted(whole_of.begin(), whole_of.end())) << where;
  return whole_of;
}

template <surface::RadialFunction function>
int compare_radial(const MeshStorage& part, const MeshStorage& whole, const std::vector<std::uint32_t>& whole_of) {
  const auto few = fit_radial<function>(part.mesh, {2, 0.3}), all = fit_radial<function>(whole.mesh, {2, 0.3});
  int compared = 0;
  for (std::size_t f = 0; f < whole_of.size(); ++f) {
    if (few.reaches_rim[f]) continue;
    const auto &p = few.patches[f], &q = all.patches[whole_of[f]];
    EXPECT_EQ(p.node_count, q.node_count);
    EXPECT_TRUE(p.x == q.x && p.y == q.y && p.a == q.a && p.b == q.b && p.c == q.c);
    for (std::uint32_t k = 0; k < std::min(p.node_count, q.node_count); ++k) {
      EXPECT_EQ(few.weights[p.first + k], all.weights[q.first + k]);
      EXPECT_TRUE(part.vertices[few.nodes[p.first + k]] == whole.vertices[all.nodes[q.first + k]]);
    }
    ++compared;
  }
  return compared;
}

TEST(TriangulatePart, EveryFacetIsOneOfTheWholeCloudWithTheSameBits) {
  Uniform u(5);
  int parts = 0, facets = 0, patches = 0, radials = 0, missing_inside = 0;
  for (const Sample& sample : samples()) {
    const auto whole = triangulate(sample.cloud, sample.max_edge).mesh;
    ASSERT_TRUE(whole) << sample.name;
    const PatchFit all = fit_patches(whole->mesh, 1);
    std::map<Triangle, std::uint32_t> numbers;
    for (std::uint32_t f = 0; f < whole->facets.size(); ++f) numbers[triangle_of(*whole, f)] = f;
    const CloudExtent extent = extent_of(sample.cloud);
    for (int k = 0; k < 40; ++k) {
      const Rectangle window = random_window(u);
      const auto part = triangulate_part(sample.cloud, extent, window, sample.max_edge).mesh;
      if (!part) continue;
      ++parts;
      const auto whole_of = match(*part, numbers, sample.name);
      if (whole_of.size() != part->facets.size()) return;
      std::vector<char> is_here(whole->facets.size(), false);
      for (std::size_t f = 0; f < whole_of.size(); ++f) {
        const surface::Facet &p = part->facets[f], &q = whole->facets[whole_of[f]];
        is_here[whole_of[f]] = true;
        ASSERT_EQ(std::memcmp(&p, &q, offsetof(surface::Facet, neighbour)), 0) << sample.name;
        for (int i = 0; i < 3; ++i) ASSERT_TRUE(p.neighbour[i] == no_facet || whole_of[p.neighbour[i]] == q.neighbour[i]) << sample.name;
        ++facets;
      }
      const PatchFit few = fit_patches(part->mesh, 1);
      for (std::size_t f = 0; f < whole_of.size(); ++f) {
        const auto& c = part->corners[f];
        if (few.reaches_rim[c[0]] || few.reaches_rim[c[1]] || few.reaches_rim[c[2]]) continue;
        ASSERT_EQ(std::memcmp(&few.patches[f], &all.patches[whole_of[f]], sizeof few.patches[f]), 0) << sample.name;
        ++patches;
      }
      if (k == 0) {
        radials += compare_radial<surface::RadialFunction::cubic>(*part, *whole, whole_of);
        radials += compare_radial<surface::RadialFunction::thin_plate>(*part, *whole, whole_of);
        radials += compare_radial<surface::RadialFunction::multiquadric>(*part, *whole, whole_of);
      }
      // On even points what lies three distances (1 mm) inside the window is there.
      if (sample.name == "regular")
        for (std::size_t f = 0; f < is_here.size(); ++f) {
          const auto corners = triangle_of(*whole, f);
          const Rectangle inside = window.grown(-1);
          const bool far_inside = std::all_of(corners.begin(), corners.end(), [&](const auto& v) { return inside.contains(v[0], v[1]) && std::abs(v[0]) < 4.6 && std::abs(v[1]) < 4.6; });
          missing_inside += far_inside && !is_here[f];
        }
    }
  }
  EXPECT_EQ(missing_inside, 0);
  EXPECT_GT(parts, 800);
  EXPECT_GT(facets, 90000);
  EXPECT_GT(patches, 12000);
  EXPECT_GT(radials, 1000);
}

// Many small clouds with windows over their hull, where facets are peeled: whether one is a sliver depends on edges that the
// window may not know.
TEST(TriangulatePart, WhatIsPeeledInTheWholeCloudIsNotInThePart) {
  Uniform u(6);
  int facets = 0;
  for (std::uint64_t seed = 1; seed <= 1500; ++seed) {
    const PointCloud cloud = cloud_of(comet(80, seed), sphere(12));
    const auto whole = triangulate(cloud).mesh;
    if (!whole) continue;
    std::map<Triangle, std::uint32_t> numbers;
    for (std::uint32_t f = 0; f < whole->facets.size(); ++f) numbers[triangle_of(*whole, f)] = f;
    const CloudExtent extent = extent_of(cloud);
    for (int k = 0; k < 8; ++k) {
      const double x = u(-5, 5), y = u(-5, 5), wide = u(2, 8), high = u(2, 8);
      const auto part = triangulate_part(cloud, extent, {x - wide, y - high, x + wide, y + high}, inf).mesh;
      if (!part) continue;
      if (match(*part, numbers, std::to_string(seed)).size() != part->facets.size()) return;
      facets += static_cast<int>(part->facets.size());
    }
  }
  EXPECT_GT(facets, 100000);
}

TEST(TriangulatePart, LeavingOutFacetsKeepsTheOthers) {
  const auto mesh = triangulate(cloud_of(regular_grid(11, 11, 5, 5), sphere(20))).mesh;
  std::vector<char> is_dropped(mesh->facets.size());
  for (std::size_t f = 0; f < is_dropped.size(); ++f) is_dropped[f] = triangle_of(*mesh, f)[0][0] < -2;
  const auto fewer = without_facets(*mesh, is_dropped);
  EXPECT_EQ(fewer->mesh.facet_count, static_cast<std::uint32_t>(std::count(is_dropped.begin(), is_dropped.end(), false)));
  EXPECT_LT(fewer->mesh.facet_count, 160u);
  const surface::Facets facets{&fewer->mesh};
  EXPECT_TRUE(facets.covers(1.3, 0.4));
  EXPECT_FALSE(facets.covers(-3.3, 0.4));
}

}  // namespace
}  // namespace sagitta::scene
