// SPDX-License-Identifier: Apache-2.0
// Rays through the edges and vertices of hard triangulations: slivers, cocircular grids, rings, points that are nearly in line, coordinates of
// 1e6 mm with spacings of 1e-6.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lib/scene/triangulate.h"
#include "lib/surface/facets.h"
#include "tests/support/point_sets.h"

namespace sagitta::test {
namespace {

using tests::Place2, numerics::Vec3;
using surface::no_facet;

struct Cloud {
  const char* name;
  std::vector<Place2> places;
  double centre_x = 0, centre_y = 0, scale = 1;
};

std::vector<Cloud> hard_clouds() {
  std::vector<Place2> slivers, in_line, rings;
  for (int k = 0; k < 24; ++k)  // a round rim, for slivers on the hull are no surface
    for (auto* inside : {&slivers, &in_line}) inside->push_back({3 * std::cos(k * std::numbers::pi / 12), 3 * std::sin(k * std::numbers::pi / 12)});
  for (int i = -20; i <= 20; ++i)  // rows 1e-6 apart, columns 0.1: angles of 1e-5
    for (int j = -1; j <= 1; ++j) slivers.push_back({0.1 * i + 0.03 * j, 1e-6 * j});
  for (int i = -20; i <= 20; ++i) in_line.push_back({0.1 * i, 1e-9 * (i * i % 7)});
  rings.push_back({0, 0});
  for (int ring = 1; ring <= 6; ++ring)
    for (int k = 0; k < 24; ++k) rings.push_back({0.5 * ring * std::cos(k * std::numbers::pi / 12), 0.5 * ring * std::sin(k * std::numbers::pi / 12)});
  std::vector<Place2> far;
  for (int i = -5; i <= 5; ++i)
    for (int j = -5; j <= 5; ++j) far.push_back({1e6 + 1e-6 * i, 1e6 + 1e-6 * j});
  return {{"slivers of 1e-5", slivers},
          {"points 1e-9 out of line", in_line},
          {"cocircular grid", tests::regular_grid(13, 13, 3, 3)},
          {"rings", rings},
          {"1e6 mm away, 1e-6 apart", far, 1e6, 1e6, 1e-6}};
}

double paraboloid(double x, double y) { return 0.05 * (x * x + y * y) + 0.02 * x; }

// Point 4 of issue 6: from either facet of a shared edge or vertex the same point, within 8 ulp of the largest local coordinate over the
// cosine of incidence and the sine of the smallest angle; and no ray is lost between them.
TEST(Edges, RayThroughAnEdgeOrVertexFindsOnePointFromEitherFacet) {
  for (const Cloud& cloud : hard_clouds()) {
    const auto result = scene::triangulate(tests::cloud_of(cloud.places, [&](double x, double y) {
      return cloud.scale * paraboloid((x - cloud.centre_x) / cloud.scale, (y - cloud.centre_y) / cloud.scale);
    }));
    for (const auto& finding : result.findings.all()) ADD_FAILURE() << cloud.name << ' ' << format(finding);
    ASSERT_TRUE(result.mesh);
    const surface::Mesh& mesh = result.mesh->mesh;
    const surface::Facets facets{&mesh};
    tests::Uniform uniform(3);
    int asked = 0;
    double worst = 0;
    for (std::uint32_t f = 0; f < mesh.facet_count; ++f)
      for (std::size_t opposite = 0; opposite < 3; ++opposite) {
        const std::uint32_t other = mesh.facets[f].neighbour[opposite];
        if (other == no_facet || other < f) continue;
        const auto& a = mesh.vertices[mesh.corners[f][(opposite + 1) % 3]];
        const auto& b = mesh.vertices[mesh.corners[f][(opposite + 2) % 3]];
        for (const double share : {0.0, 0.25, 0.5, uniform(), 1.0}) {
          const Vec3<double> target = a + share * (b - a);
          const double tilt = uniform(0, 0.7), azimuth = uniform(0, 6.283);
          const Vec3<double> d = normalized(Vec3<double>{std::sin(tilt) * std::cos(azimuth), std::sin(tilt) * std::sin(azimuth), std::cos(tilt)});
          const Vec3<double> start = target - cloud.scale * d;
          const auto hit = facets.meet(start, d);
          const bool is_inner = share > 0 && share < 1;
          if (is_inner) { ASSERT_EQ(hit.status, surface::Status::ok) << cloud.name << " facet " << f << " share " << share; }
          const surface::AimedLine<double> line = surface::aim(mesh, start, d);
          const Vec3<double> one = line.o + judge(mesh.facets[f], line, mesh.extent).path * d, two = line.o + judge(mesh.facets[other], line, mesh.extent).path * d;
          double sine = 1, cosine = 1, largest = std::max(std::abs(target.x - mesh.centre.x), std::abs(target.y - mesh.centre.y));
          for (const std::uint32_t facet : {f, other}) {
            for (std::size_t k = 0; k < 3; ++k) {
              const auto corner = [&](std::size_t i) { return mesh.vertices[mesh.corners[facet][i % 3]]; };
              const Vec3<double> from = corner(k + 1) - corner(k), to = corner(k + 2) - corner(k);
              sine = std::min(sine, norm(cross(from, to)) / (norm(from) * norm(to)));
              const Vec3<double> local = corner(k) - mesh.centre;
              largest = std::max({largest, std::abs(local.x), std::abs(local.y), std::abs(local.z)});
            }
            const Vec3<double> normal = normalized(Vec3<double>{-mesh.facets[facet].slope_x, -mesh.facets[facet].slope_y, 1});
            cosine = std::min(cosine, std::abs(dot(normal, d)));
          }
          // The target itself is a rounded place, that far beside the edge: planes that meet at an angle part by it times their slopes' difference.
          const double bound = 8 * std::numeric_limits<double>::epsilon() * largest / (cosine * sine);
          const double beside = std::numeric_limits<double>::epsilon() * (std::abs(target.x) + std::abs(target.y)) *
                                (std::abs(mesh.facets[f].slope_x - mesh.facets[other].slope_x) + std::abs(mesh.facets[f].slope_y - mesh.facets[other].slope_y)) / cosine;
          ASSERT_LE(norm(one - two), bound + beside) << cloud.name << " facet " << f << " share " << share;
          worst = std::max(worst, norm(one - two) / (bound + beside));
          ++asked;
        }
      }
    EXPECT_GT(asked, 100) << cloud.name;
    fmt::print("edges | {} | {} rays | worst {:.2g} of the bound |\n", cloud.name, asked, worst);
  }
}

// The diagonals of a cocircular grid are fixed by the points' order alone, wherever the grid stands.
TEST(Edges, DiagonalsOfACocircularGridAreThoseOfItsOrder) {
  const auto corners_of = [](double at) {
    auto places = tests::regular_grid(9, 9, 4, 4);
    for (Place2& place : places) place.x += at, place.y -= at;
    const auto mesh = scene::triangulate(tests::cloud_of(places, [](double, double) { return 0; })).mesh;
    return std::vector<surface::Corners>(mesh->corners);
  };
  const auto first = corners_of(0);
  EXPECT_EQ(first.size(), 128u);
  EXPECT_EQ(corners_of(0), first);
  EXPECT_EQ(corners_of(1024), first);
}

// What cannot be a surface is refused with its reason.
TEST(Edges, PointsThatMakeNoSurfaceAreRefused) {
  const auto refusal = [](const std::vector<Place2>& places, double slope) {
    const auto result = scene::triangulate(tests::cloud_of(places, [&](double x, double) { return slope * x; }));
    EXPECT_FALSE(result.mesh);
    return result.findings.all().empty() ? std::string() : result.findings.all().front().what;
  };
  std::vector<Place2> line;
  for (int i = 0; i < 10; ++i) line.push_back({0.5 * i, 0.25 * i});
  EXPECT_NE(refusal(line, 0).find("straight line"), std::string::npos) << refusal(line, 0);
  std::vector<Place2> thin;  // slivers only, of a strip of 1e-6 mm
  for (int i = 0; i < 40; ++i) thin.push_back({0.1 * i, 1e-6 * (i % 3)});
  EXPECT_NE(refusal(thin, 0).find("slivers of the hull"), std::string::npos) << refusal(thin, 0);
  std::vector<Place2> tiny;
  for (int i = 0; i < 4; ++i) tiny.push_back({1e6 + 1e-7 * (i % 2), 1e6 + 1e-7 * (i / 2)});
  EXPECT_NE(refusal(tiny, 0).find("at least 1e-6 mm"), std::string::npos) << refusal(tiny, 0);
}

}  // namespace
}  // namespace sagitta::test
