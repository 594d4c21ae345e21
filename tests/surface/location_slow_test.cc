// SPDX-License-Identifier: Apache-2.0
// Acceptance figure 2 of freeform.md in full: where a ray meets the facets, against testing all of them.
#include <gtest/gtest.h>

#include <cstdio>
#include <numbers>

#include "lib/scene/triangulate.h"
#include "lib/surface/conic.h"
#include "lib/trace/trace.h"
#include "tests/support/all_facets.h"
#include "tests/support/point_sets.h"

namespace sagitta::surface {
namespace {

using namespace sagitta::tests;
using V = Vec3<double>;
using Storage = std::shared_ptr<const scene::MeshStorage>;

constexpr double tilts[] = {0, 20, 40, 60};

Storage mesh_of(const std::vector<Place2>& places, const tests::Height& height) {
  const scene::Triangulation result = scene::triangulate(cloud_of(places, height));
  for (const auto& finding : result.findings.all()) ADD_FAILURE() << format(finding);
  return result.mesh;
}

V direction(double tilt_deg, double azimuth) {
  const double t = tilt_deg * std::numbers::pi / 180;
  return {std::sin(t) * std::cos(azimuth), std::sin(t) * std::sin(azimuth), std::cos(t)};
}

// A surface that is no sphere, so that the prediction by the best sphere is only near.
double cornea(double x, double y) { return Conic{1 / 12.0, -0.3}.sag(x, y) + 0.01 * std::sin(1.3 * x) * std::cos(0.9 * y); }

scene::Scene scene_of(const Facets& facets) {
  scene::Scene scene;
  scene.surfaces.emplace_back().shape = facets;
  scene.surfaces.back().image = true;
  return scene;
}

// What the program's two ways say: Facets::meet for one ray, and the kernel for a batch.
struct Answers {
  int hits = 0, outside = 0, disagreements = 0, of_the_kernel = 0, undecidable = 0, several = 0;
};
// Positions up to 40 mm are rounded to 7e-15, a few times, divided by the cosine of incidence (0.05 at least where a ray
// is judged: below that the tolerance grows with the facet's own rounding, which `judge` knows).
Real path_tolerance(const AllFacets::Verdict& verdict) {
  Real largest = 0;
  for (const auto& c : verdict.candidates) largest = std::max(largest, c.rounding);
  return 1e-12L + largest;
}
Answers against_all(const Facets& facets, const AllFacets& all, const std::vector<V>& starts, const std::vector<V>& directions) {
  Answers answers;
  trace::RayBatch batch(starts.size());
  for (std::size_t i = 0; i < starts.size(); ++i) batch.set(i, starts[i], directions[i], 0);
  trace::trace_surface(scene_of(facets), {0.5, {1, 1}}, 1, batch);
  for (std::size_t i = 0; i < starts.size(); ++i) {
    const auto crossing = facets.meet(starts[i], directions[i]);
    const auto verdict = all.judge(starts[i], directions[i]);
    answers.undecidable += !verdict.decidable;
    answers.several += verdict.crossings > 1;
    const bool hit = crossing.status == Status::ok;
    (hit ? answers.hits : answers.outside) += 1;
    const auto agrees = [&](bool met, double path) {
      return met ? verdict.may_hit && verdict.has_path(path, path_tolerance(verdict)) : !verdict.must_hit;
    };
    answers.disagreements += !agrees(hit, crossing.path) || !(hit || crossing.status == Status::outside_data);
    const bool kernel_hit = batch.status(i) == Status::ok;
    answers.of_the_kernel += !agrees(kernel_hit, dot(batch.position(i) - starts[i], directions[i])) ||
                             !(kernel_hit || batch.status(i) == Status::outside_data);
  }
  return answers;
}

std::string name_of(std::size_t layout) {
  static const char* const names[] = {"regular", "uniform_random", "rectangles", "scan_lines", "rings_with_apex", "rings_without_apex"};
  return names[layout];
}
class LocationByLayout : public testing::TestWithParam<std::size_t> {};
INSTANTIATE_TEST_SUITE_P(Layouts, LocationByLayout, testing::Range<std::size_t>(0, 6), [](const auto& one) { return name_of(one.param); });

// 1e5 rays a tilt, one in five travelling to -z, started up to 20 mm before or behind; 8 % are aimed beside the data.
TEST_P(LocationByLayout, agrees_with_testing_all_facets) {
  constexpr std::size_t rays = 100000;
  const Storage storage = mesh_of(all_layouts(10000)[GetParam()].places, cornea);
  const Facets facets{&storage->mesh};
  const AllFacets all(storage->mesh);
  for (const double tilt : tilts) {
    Uniform u(7);
    std::vector<V> starts, directions;
    for (std::size_t i = 0; i < rays; ++i) {
      const double x = u(-5.2, 5.2), y = u(-5.2, 5.2), back = u(-20, 20);
      const V forward = direction(tilt, u(0, 2 * std::numbers::pi)), d = i % 5 == 0 ? -forward : forward;
      directions.push_back(d);
      starts.push_back(V{x, y, cornea(x, y)} - back * d);
    }
    const Answers answers = against_all(facets, all, starts, directions);
    std::printf("[ report   ] %s, tilt %g: %d hits, %d outside, %d disagreements, %d of the kernel, %d cross several facets\n", name_of(GetParam()).c_str(),
                tilt, answers.hits, answers.outside, answers.disagreements, answers.of_the_kernel, answers.several);
    EXPECT_EQ(answers.disagreements, 0) << tilt;
    EXPECT_EQ(answers.of_the_kernel, 0) << tilt;
    EXPECT_LE(answers.undecidable, 1) << tilt;  // 1e5 rays come within 1e-12 of an edge with probability 1e-6
    EXPECT_GT(answers.hits, 60000) << tilt;
    EXPECT_GT(answers.outside, 1000) << tilt;
  }
}

// Rays exactly through vertices and edges, at tilts up to 60 degrees: none is lost inside, and on the rim what is said is
// one of the two things that rounding allows.
TEST_P(LocationByLayout, judges_rays_through_edges_and_vertices) {
  const Storage storage = mesh_of(all_layouts(900)[GetParam()].places, cornea);
  const Facets facets{&storage->mesh};
  const AllFacets all(storage->mesh);
  const Mesh& mesh = storage->mesh;
  std::vector<bool> on_rim(mesh.vertex_count, false);
  for (const auto& edge : rim_edges(mesh)) on_rim[edge[0]] = on_rim[edge[1]] = true;
  Uniform u(31);
  std::vector<V> starts, directions;
  int lost = 0, inside = 0;
  const auto aim = [&](const V& target, double tilt, bool is_inside) {
    const V d = direction(tilt, u(0, 2 * std::numbers::pi));
    starts.push_back(target - u(-20, 20) * d);
    directions.push_back(d);
    const auto [slope_x, slope_y] = facets.gradient(target.x, target.y);
    if (!is_inside || !(d.z - slope_x * d.x - slope_y * d.y > 0.3)) return;  // nearby facets may face away
    ++inside;
    lost += facets.meet(starts.back(), d).status != Status::ok;
  };
  for (std::uint32_t f = 0; f < mesh.facet_count; ++f) {
    const auto corner = mesh.corners[f];
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = corner[i], b = corner[(i + 1) % 3];
      for (const double tilt : tilts) {
        aim(mesh.vertices[a], tilt, !on_rim[a]);
        aim(0.5 * (mesh.vertices[a] + mesh.vertices[b]), tilt, !(on_rim[a] && on_rim[b]));
      }
    }
  }
  const Answers answers = against_all(facets, all, starts, directions);
  std::printf("[ report   ] %s: %zu rays through vertices and edges, %d lost of %d inside, %d hits, %d outside\n", name_of(GetParam()).c_str(), starts.size(),
              lost, inside, answers.hits, answers.outside);
  EXPECT_EQ(lost, 0);
  EXPECT_EQ(answers.disagreements, 0);
  EXPECT_EQ(answers.of_the_kernel, 0);
  EXPECT_GT(inside, 15000);
  EXPECT_GT(answers.undecidable, 15000);  // these are the rays that cannot be told by luck
}

// Rays that graze the edge of the data: aimed at the rim and up to 1e-3 mm inside or outside it, down to one ulp.
TEST_P(LocationByLayout, finds_rays_at_the_rim_or_calls_them_outside) {
  const Storage storage = mesh_of(all_layouts(900)[GetParam()].places, cornea);
  const Facets facets{&storage->mesh};
  const AllFacets all(storage->mesh);
  const Mesh& mesh = storage->mesh;
  Uniform u(41);
  std::vector<V> starts, directions;
  for (const auto& edge : rim_edges(mesh)) {
    const V &a = mesh.vertices[edge[0]], &b = mesh.vertices[edge[1]];
    const V outward = normalized(V{b.y - a.y, a.x - b.x, 0});
    for (const double offset : {0.0, 1e-15, 1e-14, 1e-13, 1e-12, 1e-9, 1e-6, 1e-3})
      for (const double side : {-1.0, 1.0})
        for (const double tilt : tilts) {
          const double s = u();
          const V d = direction(tilt, u(0, 2 * std::numbers::pi));
          starts.push_back(a + s * (b - a) + side * offset * outward - u(-20, 20) * d);
          directions.push_back(d);
        }
    // along the rim's own facet, nearly: incidence from 80 to 90 degrees
    for (int i = 0; i < 8; ++i) {
      const V along = normalized(b - a), d = normalized(along + std::pow(10, u(-6, -0.8)) * V{0, 0, 1});
      starts.push_back(a + u() * (b - a) - u(-20, 20) * d);
      directions.push_back(d);
    }
  }
  const Answers answers = against_all(facets, all, starts, directions);
  std::printf("[ report   ] %s: %zu rays at the rim, %d hits, %d outside, %d disagreements, %d of the kernel\n", name_of(GetParam()).c_str(), starts.size(),
              answers.hits, answers.outside, answers.disagreements, answers.of_the_kernel);
  EXPECT_EQ(answers.disagreements, 0);
  EXPECT_EQ(answers.of_the_kernel, 0);
  EXPECT_GT(answers.hits, 1000);
  EXPECT_GT(answers.outside, 1000);
}

// Facets tested a ray, by Facets::find's own count: over the rays that hit, and over all. At 1e6 points some hundred rays a
// tilt are also compared with all 2e6 facets.
void count_visits(std::size_t layout, int points) {
  const Storage storage = mesh_of(all_layouts(points)[layout].places, cornea);
  ASSERT_TRUE(storage);
  const Facets facets{&storage->mesh};
  const AllFacets all(storage->mesh);
  for (const double tilt : tilts) {
    Uniform u(8);
    std::int64_t of_hits = 0, of_all = 0, hits = 0;
    constexpr int rays = 100000;
    const int compared = static_cast<int>(std::clamp<std::int64_t>(200'000'000 / points, 20, 1000));
    std::vector<V> starts, directions;
    for (int i = 0; i < rays; ++i) {
      const double x = u(-5, 5), y = u(-5, 5);
      const V d = direction(tilt, u(0, 2 * std::numbers::pi)), start = V{x, y, cornea(x, y)} - 30 * d;
      std::int64_t visits = 0;
      const auto found = facets.find(start, d, [&] { ++visits; });
      of_all += visits;
      if (found.facet != no_facet) of_hits += visits, ++hits;
      if (i < compared) starts.push_back(start), directions.push_back(d);
    }
    const double mean_of_hits = static_cast<double>(of_hits) / static_cast<double>(hits), mean = static_cast<double>(of_all) / rays;
    std::printf("[ report   ] %s, %d points, tilt %g: facets visited %.3f by rays that hit (%lld), %.3f by all\n", name_of(layout).c_str(), points, tilt,
                mean_of_hits, static_cast<long long>(hits), mean);
    EXPECT_GT(hits, rays / 2) << tilt;
    EXPECT_LE(mean_of_hits, 5) << tilt;
    EXPECT_LE(mean, 5) << tilt;
    const Answers answers = against_all(facets, all, starts, directions);
    EXPECT_EQ(answers.disagreements, 0) << tilt;
    EXPECT_EQ(answers.of_the_kernel, 0) << tilt;
  }
}

TEST_P(LocationByLayout, visits_five_facets_at_most_at_any_density) {
  for (const int points : {1000, 10000, 100000, 1000000}) count_visits(GetParam(), points);
}

TEST(Location, visits_five_facets_at_most_at_1e7_random_points) { count_visits(1, 10000000); }
TEST(Location, visits_five_facets_at_most_at_1e7_points_on_scan_lines) { count_visits(3, 10000000); }

}  // namespace
}  // namespace sagitta::surface
