// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "lib/scene/triangulate.h"
#include "lib/study/arrangement.h"
#include "lib/study/nearest_vertex.h"
#include "lib/study/uniform.h"
#include "lib/surface/facets.h"

namespace sagitta::study {
namespace {

using V = numerics::Vec3<double>;

std::shared_ptr<const scene::MeshStorage> mesh_of(const Arrangement& arrangement, std::uint64_t seed) {
  prescription::PointCloud cloud;
  for (const Site& site : sites_over_disc(arrangement, 5, seed)) cloud.points.push_back({site.x, site.y, .04 * (site.x * site.x + site.y * site.y)});
  return scene::triangulate(cloud).mesh;
}

struct Comparison {
  int rays = 0, none = 0, other = 0;
};
// Where the nearest vertex gives a facet, it is the one that the walk finds (or its neighbour across an edge that the ray meets to within
// rounding: the hits then agree); where it gives none, the walk finds one all the same.
void compare(const surface::Mesh& mesh, double tilt_deg, int rays, Uniform& u, Comparison& comparison) {
  const NearestVertex nearest(mesh);
  const surface::Facets facets{&mesh};
  for (int i = 0; i < rays; ++i) {
    const double tilt = tilt_deg * 3.14159265358979 / 180, azimuth = u(0, 6.28);
    const V d = numerics::normalized(V{std::sin(tilt) * std::cos(azimuth), std::sin(tilt) * std::sin(azimuth), std::cos(tilt)});
    const V p = V{u(-3, 3), u(-3, 3), 0} - 2.0 * d;
    const auto walked = facets.meet(p, d), found = nearest.meet(p, d);
    ASSERT_EQ(walked.status, surface::Status::ok);
    ++comparison.rays;
    comparison.none += nearest.facet_of(p, d) == surface::no_facet;
    EXPECT_EQ(found.status == surface::Status::ok, nearest.facet_of(p, d) != surface::no_facet);
    comparison.other += found.status == surface::Status::ok && !(norm(found.point - walked.point) < 1e-12);
  }
}

TEST(NearestVertex, MissesTheFacetOfOneAxialRayInTwentyOnRandomPoints) {
  Uniform u(22);
  Comparison comparison;
  for (std::uint64_t seed = 1; seed <= 25; ++seed) compare(mesh_of({ArrangementKind::random, 25}, seed)->mesh, 0, 4000, u, comparison);
  EXPECT_EQ(comparison.rays, 100000);
  EXPECT_EQ(comparison.other, 0);
  // 4.8 +- 0.3 %; the standard error of 100,000 rays on 25 clouds of 2000 points is below 0.1 %.
  EXPECT_NEAR(100.0 * comparison.none / comparison.rays, 4.8, .3);
}

// The facet is half of a square cell, and the corner that it lacks is the image of its right angle in the diagonal between them: a ray in the
// facet is nearer to the right angle.
TEST(NearestVertex, FindsAxialRaysOnASquareGrid) {
  Uniform u(23);
  Comparison comparison;
  compare(mesh_of({ArrangementKind::regular, 25}, 1)->mesh, 0, 20000, u, comparison);
  EXPECT_EQ(comparison.none, 0);
  EXPECT_EQ(comparison.other, 0);
}

TEST(NearestVertex, FindsNoOtherFacetThanTheWalkForTiltedRays) {
  Uniform u(24);
  Comparison comparison;
  compare(mesh_of({ArrangementKind::random, 25}, 7)->mesh, 30, 20000, u, comparison);
  EXPECT_EQ(comparison.other, 0);
  EXPECT_GT(comparison.none, 200);
  EXPECT_LT(comparison.none, 4000);
}

TEST(NearestVertex, FindsNothingBesideThePoints) {
  const auto storage = mesh_of({ArrangementKind::random, 25}, 1);
  const NearestVertex nearest(storage->mesh);
  EXPECT_EQ(nearest.facet_of({9, 9, 0}, {0, 0, 1}), surface::no_facet);
  EXPECT_EQ(nearest.meet({9, 9, 0}, {0, 0, 1}).status, surface::Status::outside_data);
  EXPECT_EQ(nearest.facet_of({NAN, 0, 0}, {0, 0, 1}), surface::no_facet);
}

}  // namespace
}  // namespace sagitta::study
