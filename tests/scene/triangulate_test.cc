// SPDX-License-Identifier: Apache-2.0
#include "lib/scene/triangulate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <set>

#include "lib/surface/facets.h"
#include "tests/support/point_sets.h"

namespace sagitta::scene {
namespace {

using namespace sagitta::tests;
using surface::Facets;
using surface::Status;
using testing::HasSubstr;
using V = numerics::Vec3<double>;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

PointCloud cloud_of_points(std::vector<V> points) {
  PointCloud cloud;
  cloud.file = "points.xyz";
  cloud.points = std::move(points);
  for (std::size_t i = 0; i < cloud.points.size(); ++i) cloud.lines.push_back(static_cast<std::uint32_t>(10 + i));
  return cloud;
}

// The only finding, as text.
std::string told(const Triangulation& result) {
  EXPECT_EQ(result.findings.all().size(), 1u);
  EXPECT_EQ(result.mesh == nullptr, result.findings.has_errors());
  return result.findings.all().empty() ? "" : format(result.findings.all()[0]);
}

const auto flat = [](double, double) { return 0.0; };

TEST(Triangulate, RefusesWhatSpansNoSurface) {
  EXPECT_THAT(told(triangulate(cloud_of_points({}))), HasSubstr("points.xyz:1:1: error: 0 places: a surface needs at least 3"));
  EXPECT_THAT(told(triangulate(cloud_of_points({{0, 0, 0}, {1, 0, 0}}))), HasSubstr("error: 2 places: a surface needs at least 3"));
  EXPECT_THAT(told(triangulate(cloud_of_points({{0, 0, 0}, {1, 1, 0}, {2, 2, 5}, {3, 3, 1}}))),
              HasSubstr("error: all points lie on one straight line in (x, y)"));
  EXPECT_THAT(told(triangulate(cloud_of_points({{0, 0, 0}, {1e-7, 0, 0}, {0, 1e-7, 0}}))),
              HasSubstr("error: all points lie within 1e-07 mm"));
  EXPECT_THAT(told(triangulate(cloud_of_points({{0, 0, 0}, {1, 0, 0}, {0, 1, 2e9}}))),
              HasSubstr("points.xyz:12:1: error: the point (0, 1, 2e+09) is beyond +-1e9 mm"));
  EXPECT_THAT(told(triangulate(cloud_of_points({{0, 0, 0}, {nan, 0, 0}, {0, 1, 0}, {1, 1, 1}}))),
              HasSubstr("points.xyz:11:1: error: the point (nan, 0, 0)"));
  EXPECT_THAT(told(triangulate(cloud_of_points({{0, 0, nan}, {1, 0, 0}, {0, 1, 0}}))),
              HasSubstr("error: no facet is left between the points: 1 touch a hole, 0 have"));
}

TEST(Triangulate, RefusesTwoHeightsAtOnePlaceAndNamesBothLines) {
  EXPECT_THAT(told(triangulate(cloud_of_points({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0.5}}))),
              HasSubstr("points.xyz:13:1: error: two heights at one place (1, 0): 0.5 here and 0 in line 11"));
  // As good as one place: 1e-13 mm apart.
  EXPECT_THAT(told(triangulate(cloud_of_points({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1e-13, 0, 0.5}, {0.5, -1, 0}, {-1, -1, 0}}))),
              AllOf(HasSubstr("points.xyz:13:1: error: two points so near one place"), HasSubstr("line 10")));
  const Triangulation many = triangulate(cloud_of_points(std::vector<V>{{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {1, 0, 1}, {0, 1, 0}}));
  EXPECT_EQ(many.findings.error_count(), 2);
}

TEST(Triangulate, MergesRepeatedPointsWithANote) {
  const Triangulation result = triangulate(cloud_of_points({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {1, 0, 0}, {-0.0, 0, nan}}));
  EXPECT_THAT(told(result), HasSubstr("points.xyz:14:1: note: 2 points repeat another, the first one here: merged"));
  ASSERT_TRUE(result.mesh);
  EXPECT_EQ(result.mesh->facets.size(), 2u);
  EXPECT_EQ(result.mesh->vertices.size(), 4u);
}

TEST(Triangulate, LeavesOutFacetsAroundAHoleAndNoMore) {
  auto grid = cloud_of(regular_grid(11, 11, 5, 5), sphere(20));
  const auto whole = triangulate(grid).mesh;
  ASSERT_EQ(whole->facets.size(), 200u);
  grid.points[60].z = nan;  // the middle
  const auto holed = triangulate(grid).mesh;
  std::size_t around = 0;
  for (const auto& corners : whole->corners) {
    around += std::any_of(corners.begin(), corners.end(), [&](std::uint32_t v) { return whole->vertices[v] == V{0, 0, 0}; });
  }
  EXPECT_EQ(holed->facets.size(), 200 - around);
  EXPECT_EQ(holed->vertices.size(), 120u);  // and no place without a facet
  const Facets facets{&holed->mesh};
  EXPECT_FALSE(facets.covers(0.1, 0.1));
  EXPECT_EQ(facets.meet(V{0.1, 0.1, -3}, V{0, 0, 1}).status, Status::outside_data);
  EXPECT_TRUE(facets.covers(1.01, 0));
}

TEST(Triangulate, LeavesOutLongEdges) {
  std::vector<Place2> two = regular_grid(5, 5, 1, 1);
  for (const Place2& p : regular_grid(5, 5, 1, 1)) two.push_back({p.x + 3, p.y});
  const auto cloud = cloud_of(two, sphere(20));
  EXPECT_TRUE((Facets{&triangulate(cloud).mesh->mesh}.covers(1.5, 0.1)));
  const auto apart = triangulate(cloud, 0.8).mesh;
  EXPECT_EQ(apart->facets.size(), 64u);
  EXPECT_FALSE((Facets{&apart->mesh}.covers(1.5, 0.1)));
}

TEST(Triangulate, PeelsSliversOfTheHull) {
  // The points between the corners lie a little inside: slivers close the hull along all four sides.
  std::vector<Place2> places = regular_grid(11, 11, 5, 5);
  for (Place2& p : places) {
    const bool corner = std::abs(p.x) == 5 && std::abs(p.y) == 5;
    if (std::abs(p.x) == 5 && !corner) p.x *= 1 - 1e-3 * (1 - p.y * p.y / 25);
    if (std::abs(p.y) == 5 && !corner) p.y *= 1 - 1e-3 * (1 - p.x * p.x / 25);
  }
  const auto mesh = triangulate(cloud_of(places, flat)).mesh;
  EXPECT_EQ(mesh->facets.size(), 200u);
  EXPECT_FALSE((Facets{&mesh->mesh}.covers(0.1, 4.999)));
}

TEST(Triangulate, PeelsExactlyWhereTheCircumradiusExceedsTwiceTheMeanEdge) {
  // Base 2, height t: circumradius (1 + t^2)/(2 t), mean edge at the corners (2 + 2 sqrt(1 + t^2))/3: they are as 2 : 1
  // at t = 0.19269.
  const auto triangle = [](double t) { return cloud_of_points({{-1, 0, 0}, {1, 0, 0}, {0, t, 0}}); };
  EXPECT_TRUE(triangulate(triangle(0.1928)).mesh);
  EXPECT_THAT(told(triangulate(triangle(0.1926))), HasSubstr("1 are slivers of the hull"));
}

TEST(Triangulate, TakesTheMeanOfAllEdgesAtACorner) {
  // The same triangle on another one, 200 high, below: at the base's ends meet edges of 2, s = sqrt(1 + t^2) and
  // L = sqrt(40001), at the top two of s. (1 + t^2)/(2 t) is twice the mean of those means at t = 0.0055013.
  const auto kite = [](double t) { return triangulate(cloud_of_points({{-1, 0, 0}, {1, 0, 0}, {0, t, 0}, {0, -200, 0}})).mesh->facets.size(); };
  EXPECT_EQ(kite(0.005507), 2u);
  EXPECT_EQ(kite(0.005496), 1u);
}

TEST(Triangulate, PeelsBehindFacetsThatAreGone) {
  // A flat triangle, 0.0052 high, whose long side faces a point 200 away, and others above: its circumradius, 96, exceeds twice
  // the mean of its corners' mean edges, 70, but it borders on the hull only if the long facet below is a hole.
  const auto facets = [](double z) {
    return triangulate(cloud_of_points({{-1, 0, 0}, {1, 0, 0}, {0, 0.0052, 0}, {-2, 2, 0}, {2, 2, 0}, {0, -200, z}})).mesh->facets.size();
  };
  EXPECT_EQ(facets(0), 5u);
  EXPECT_EQ(facets(nan), 3u);
}

TEST(Triangulate, KeepsTheDiscInsideTheInnermostRing) {
  // freeform.md: a rule by spacing would remove the apex of ring data.
  const auto mesh = triangulate(cloud_of(polar_rings(24, 180, 5, false), sphere(8))).mesh;
  const Facets facets{&mesh->mesh};
  Uniform u(4);
  for (int i = 0; i < 1000; ++i) {
    const double r = 0.999 * 5 * std::cos(std::numbers::pi / 180) * std::sqrt(u()), angle = u(0, 7);
    EXPECT_TRUE(facets.covers(r * std::cos(angle), r * std::sin(angle)));
  }
}

TEST(Triangulate, DoesNotPeelTheRimsOfHolesInside) {
  // A hole whose rim has facets of an obtuse kind: they stay, because no hull borders on them.
  std::vector<V> points;
  for (const Place2& p : regular_grid(21, 21, 10, 10)) {
    if (std::hypot(p.x, p.y) >= 4) points.push_back({p.x, p.y, 0});
  }
  const auto plain = triangulate(cloud_of_points(points)).mesh;
  points.push_back({0, 0, nan});
  const auto holed = triangulate(cloud_of_points(points)).mesh;
  const auto is_near = [](const MeshStorage& mesh) {
    return std::count_if(mesh.corners.begin(), mesh.corners.end(), [&](const auto& corners) {
      return std::all_of(corners.begin(), corners.end(), [&](auto v) { return std::hypot(mesh.vertices[v].x, mesh.vertices[v].y) < 5; });
    });
  };
  EXPECT_GT(is_near(*plain), is_near(*holed));
  EXPECT_GT(is_near(*holed), 0);
  EXPECT_FALSE((Facets{&holed->mesh}.covers(0.5, 0.5)));
}

TEST(Triangulate, GivesTheSameMeshForTheSamePoints) {
  for (const Layout& layout : all_layouts(2000)) {
    const auto cloud = cloud_of(layout.places, sphere(9));
    const auto one = triangulate(cloud).mesh, other = triangulate(cloud).mesh;
    EXPECT_EQ(one->vertices, other->vertices);
    ASSERT_EQ(one->facets.size(), other->facets.size());
    for (std::size_t f = 0; f < one->facets.size(); ++f) {
      const auto &a = one->facets[f], &b = other->facets[f];
      ASSERT_TRUE(std::equal(a.neighbour, a.neighbour + 3, b.neighbour) && a.slope_x == b.slope_x && a.slope_y == b.slope_y);
    }
    EXPECT_EQ(one->corners, other->corners);
    EXPECT_EQ(one->grid, other->grid);
  }
}

struct ByPlace {
  bool operator()(const std::array<V, 3>& a, const std::array<V, 3>& b) const { return key(a) < key(b); }
  static std::array<double, 6> key(const std::array<V, 3>& t) { return {t[0].x, t[0].y, t[1].x, t[1].y, t[2].x, t[2].y}; }
};
// As triples of places, each from its first corner on.
std::set<std::array<V, 3>, ByPlace> facets_of(const std::vector<Place2>& places) {
  const auto mesh = triangulate(cloud_of(places, flat)).mesh;
  std::set<std::array<V, 3>, ByPlace> facets;
  for (const auto& [a, b, c] : mesh->corners) facets.insert({mesh->vertices[a], mesh->vertices[b], mesh->vertices[c]});
  return facets;
}

// The facets and their first corners are a function of the set of points, be they cocircular: in another order they are
// the same, and a part of the points has the same ones, away from its own hull. (In the last layout two edges of every
// facet are the longest.)
TEST(Triangulate, GivesTheSameFacetsForTheSamePointsInAnyOrderOrPart) {
  std::vector<Layout> layouts = all_layouts(4000);
  layouts.push_back({"rows in turn moved by half", {}});
  for (int j = -20; j < 20; ++j)
    for (int i = -50; i < 50; ++i) layouts.back().places.push_back({0.0625 * i + 0.03125 * (j % 2), 0.25 * j});
  for (const Layout& layout : layouts) {
    std::vector<Place2> places = layout.places;
    const auto straight = facets_of(places);
    EXPECT_GT(straight.size(), 7000u);
    std::shuffle(places.begin(), places.end(), std::mt19937_64(3));
    EXPECT_EQ(facets_of(places), straight) << layout.name;
    std::erase_if(places, [](const Place2& p) { return p.x > 2.55 || p.y > 3.1; });
    int near = 0;
    for (const auto& facet : facets_of(places)) {
      if (!std::all_of(facet.begin(), facet.end(), [](const V& v) { return std::abs(v.x) < 1.5 && std::abs(v.y) < 2; })) continue;
      ++near;
      EXPECT_TRUE(straight.contains(facet)) << layout.name;
    }
    EXPECT_GT(near, 500);
  }
}

// What rays rely on: orientation, neighbours that are each other's, boxes that hold what is below them.
void expect_sound(const MeshStorage& storage) {
  const auto& mesh = storage.mesh;
  ASSERT_EQ(mesh.facet_count, storage.facets.size());
  for (std::uint32_t f = 0; f < mesh.facet_count; ++f) {
    const auto& facet = mesh.facets[f];
    for (int i = 0; i < 3; ++i) {
      ASSERT_LT(mesh.corners[f][i], mesh.vertex_count);
      if (facet.neighbour[i] == surface::no_facet) continue;
      ASSERT_LT(facet.neighbour[i], mesh.facet_count);
      const auto& next = mesh.facets[facet.neighbour[i]];
      const auto back = std::find(next.neighbour, next.neighbour + 3, f) - next.neighbour;
      ASSERT_LT(back, 3);
      const auto &here = mesh.corners[f], &there = mesh.corners[facet.neighbour[i]];
      ASSERT_EQ(here[(i + 1) % 3], there[(back + 2) % 3]);
      ASSERT_EQ(here[(i + 2) % 3], there[(back + 1) % 3]);
    }
    ASSERT_TRUE(std::isfinite(facet.slope_x) && std::isfinite(facet.slope_y));
    for (const std::uint32_t v : mesh.corners[f]) {
      const V corner = mesh.vertices[v] - mesh.centre;
      ASSERT_GE(mesh.grid.cell(corner.x, corner.y), 0);
      std::uint32_t begin = 0, size = (mesh.facet_count + surface::Mesh::leaf_size - 1) / surface::Mesh::leaf_size;
      for (std::uint32_t box = f / surface::Mesh::leaf_size;; box /= surface::Mesh::branching) {
        const surface::Box& around = mesh.boxes[begin + box];
        ASSERT_TRUE(corner.x > around.low[0] && corner.y > around.low[1] && corner.z > around.low[2] && corner.x < around.high[0] &&
                    corner.y < around.high[1] && corner.z < around.high[2]);
        if (size == 1) break;
        begin += size;
        size = (size + surface::Mesh::branching - 1) / surface::Mesh::branching;
      }
      ASSERT_EQ(begin + 1, mesh.box_count);
    }
  }
}

TEST(Triangulate, MakesSoundMeshesOfEveryLayout) {
  for (const Layout& layout : all_layouts(5000)) {
    SCOPED_TRACE(layout.name);
    expect_sound(*triangulate(cloud_of(layout.places, sphere(9))).mesh);
  }
}

// Every cell against every facet, in long double. A middle nearer to an edge than rounding may go to either side: coordinates
// are known to a few 2^-52 of the grid's size, 10 mm, four times over.
TEST(Triangulate, GivesEveryCellTheFacetAtItsMiddle) {
  constexpr long double rounding = 1e-14L;  // mm
  const auto height = [](double x, double y) { return x * x + y * y < 0.5 ? nan : sphere(12)(x, y); };
  std::vector<Layout> layouts = all_layouts(900);
  layouts.push_back({"few", uniform_random(20, 5, 3)});  // facets of many sizes: rows of many cells
  layouts.push_back({"comet", {}});
  for (int i = 1; i < 600; ++i) layouts.back().places.push_back({5 * std::pow(i / 600.0, 4) * std::cos(2.4 * i), 5 * std::pow(i / 600.0, 4) * std::sin(2.4 * i)});
  int filled = 0, empty = 0;
  for (const Layout& layout : layouts) {
    const auto storage = triangulate(cloud_of(layout.places, height)).mesh;
    const surface::Mesh& mesh = storage->mesh;
    for (std::int32_t cell = 0; cell < mesh.grid.columns * mesh.grid.rows; ++cell) {
      const long double x = mesh.centre.x + mesh.grid.low_x + (cell % mesh.grid.columns + 0.5L) / mesh.grid.columns_per_mm,
                        y = mesh.centre.y + mesh.grid.low_y + (cell / mesh.grid.columns + 0.5L) / mesh.grid.rows_per_mm;
      const auto inside_by = [&](std::uint32_t f) {  // mm, from the nearest edge
        long double least = std::numeric_limits<long double>::infinity();
        for (std::size_t i = 0; i < 3; ++i) {
          const V &from = mesh.vertices[mesh.corners[f][i]], &to = mesh.vertices[mesh.corners[f][(i + 1) % 3]];
          const long double dx = to.x - from.x, dy = to.y - from.y;
          least = std::min(least, (dx * (y - from.y) - dy * (x - from.x)) / std::hypot(dx, dy));
        }
        return least;
      };
      const std::uint32_t here = mesh.grid.facets[cell];
      ++(here == surface::no_facet ? empty : filled);
      if (here != surface::no_facet) {
        ASSERT_GE(inside_by(here), -rounding) << layout.name << ' ' << cell;
        continue;
      }
      for (std::uint32_t f = 0; f < mesh.facet_count; ++f) ASSERT_LE(inside_by(f), rounding) << layout.name << ' ' << cell;
    }
  }
  EXPECT_GT(filled, 30000);
  EXPECT_GT(empty, 3000);
}

TEST(Triangulate, KeepsTheGridSmallForThinFacetsAcrossIt) {
  // Two lines of points far apart, and the same turned: every facet is long and thin.
  for (const double turn : {0.0, 0.6}) {
    std::vector<Place2> places;
    for (int i = 0; i < 5000; ++i) {
      for (const double y : {-5.0, 0.0, 5.0}) {
        const double x = -5 + 0.002 * i;
        places.push_back({x * std::cos(turn) - y * std::sin(turn), x * std::sin(turn) + y * std::cos(turn)});
      }
    }
    const auto mesh = triangulate(cloud_of(places, sphere(30))).mesh;
    ASSERT_TRUE(mesh);
    EXPECT_LE(mesh->grid.size(), 4 * mesh->facets.size());
    EXPECT_TRUE((Facets{&mesh->mesh}.covers(0.3, 0.4)));
  }
}

// Small clouds of every bad kind end in an error with a place, or in a sound mesh that rays can be sent through.
TEST(Triangulate, EndsInAnErrorOrInASoundMeshForAnySmallCloud) {
  Uniform u(99);
  const auto pick = [&](int count) { return static_cast<int>(u() * count); };
  int meshes = 0, errors = 0, hits = 0, rays = 0;
  for (int round = 0; round < 20000; ++round) {
    const int kind = pick(8);
    const double scale = pick(3) ? 1 : std::pow(10.0, u(-300, 300)), offset = pick(4) ? 0 : std::pow(10.0, u(-3, 12));
    std::vector<V> points;
    for (int i = pick(14); i >= 0; --i) {
      V p{u(-1, 1), u(-1, 1), u(-1, 1)};
      if (kind == 1) p = {double(pick(3)), double(pick(3)), double(pick(3))};                    // duplicates, cocircular
      if (kind == 2) p.y = pick(4) ? p.x : p.y;                                                  // collinear runs
      if (kind == 3) p = {std::cos(pick(12) * 0.5235987755982988), std::sin(pick(12) * 0.5235987755982988), 0};
      if (kind == 4) (pick(2) ? p.z : pick(8) ? p.z : p.x) = nan;
      if (kind == 5) p.x *= std::pow(10.0, u(-320, 0));
      if (kind == 6) p = {p.x * std::pow(10.0, u(-300, 300)), p.y * std::pow(10.0, u(-300, 300)), p.z};
      if (kind == 7) p = {double(pick(4)), p.y * 1e-15, 1e-15 * p.z};
      points.push_back({scale * p.x + offset, scale * p.y + offset, scale * p.z});
    }
    const Triangulation result = triangulate(cloud_of_points(points), pick(5) ? std::numeric_limits<double>::infinity() : u());
    ASSERT_EQ(result.mesh == nullptr, result.findings.has_errors());
    if (!result.mesh) {
      ++errors;
      continue;
    }
    ++meshes;
    expect_sound(*result.mesh);
    const surface::Mesh& mesh = result.mesh->mesh;
    const Facets facets{&mesh};
    for (int k = 0; k < 4; ++k) {
      const auto& corner = mesh.corners[pick(static_cast<int>(mesh.facet_count))];
      const V middle = (1.0 / 3) * (mesh.vertices[corner[0]] + mesh.vertices[corner[1]] + mesh.vertices[corner[2]]);
      const V d = numerics::normalized(V{u(-1, 1), u(-1, 1), u(-0.5, 1.5)});
      const auto crossing = facets.meet(middle - 5 * scale * d, d);
      ASSERT_EQ(crossing.status == Status::ok, std::isfinite(crossing.path));
      ASSERT_TRUE(crossing.status == Status::ok || crossing.status == Status::outside_data);
      const auto axial = facets.meet(V{middle.x, middle.y, middle.z}, V{0, 0, 1});
      ++rays;
      hits += axial.status == Status::ok;
    }
  }
  EXPECT_GT(meshes, 4000);
  EXPECT_GT(errors, 4000);
  // Down the middle of a facet there is a facet. A few are thinner than the numbers at their offset.
  EXPECT_GT(hits, 0.99 * rays);
}

// Files without lines (binary PLY): the place is the file, the point is named by its number.
TEST(Triangulate, NamesPointsByNumberWhereTheFileHasNoLines) {
  prescription::PointCloud cloud{.file = "points.ply", .points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 2}, {0, 0, 0}}, .lines = {}, .has_lines = false};
  const auto first_of = [&] { return format(triangulate(cloud).findings.all().front()); };
  EXPECT_EQ(first_of(), "points.ply:1:1: error: point 4: two heights at one place (1, 0): 2 here and 0 in point 2\n  hint: a surface has one height at every (x, y)");
  cloud.lines = {1, 3, 4, 7, 9};  // the second vertex of the file, and others, had no place
  EXPECT_EQ(first_of(), "points.ply:1:1: error: point 7: two heights at one place (1, 0): 2 here and 0 in point 3\n  hint: a surface has one height at every (x, y)");
  cloud.points[3] = {1 + 1e-13, 0, 2};
  EXPECT_EQ(format(triangulate(cloud).findings.all().at(1)),
            "points.ply:1:1: error: point 7: two points so near one place that no slope can be told: the other one is in point 3\n  hint: a surface has one height at every (x, y)");
  cloud.points[3] = {1, 1, 0};
  EXPECT_EQ(first_of(), "points.ply:1:1: note: point 9: 1 point repeats another, the first one here: merged");
  cloud.points[1].x = 2e9;
  EXPECT_EQ(first_of(), "points.ply:1:1: error: point 3: the point (2e+09, 0, 0) is beyond +-1e9 mm\n  hint: coordinates are in mm");
}

}  // namespace
}  // namespace sagitta::scene
