// SPDX-License-Identifier: Apache-2.0
// Grids of heights: bicubics that are exact, differences, holes and rims, the order of the error.
#include "lib/surface/grid.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "lib/surface/conic.h"
#include "tests/support/point_sets.h"
#include "tests/support/sag_grids.h"

namespace sagitta::surface {
namespace {

using namespace sagitta::tests;
using V = Vec3<double>;
constexpr double eps = 0x1p-52, infinity = std::numeric_limits<double>::infinity();

// sum of c_ab x^a y^b, a and b to 4.
struct Powers {
  double c[5][5]{};

  static double power(double x, int a, int derivative) {
    double factor = 1;
    for (int k = 0; k < derivative; ++k) factor *= a - k;
    return a < derivative ? 0 : factor * std::pow(x, a - derivative);
  }
  double at(double x, double y, int along_x = 0, int along_y = 0) const {
    double sum = 0;
    for (int a = 0; a < 5; ++a)
      for (int b = 0; b < 5; ++b) sum += c[a][b] * power(x, a, along_x) * power(y, b, along_y);
    return sum;
  }
  SagGrid::Node node(double x, double y) const { return {at(x, y), at(x, y, 1), at(x, y, 0, 1), at(x, y, 1, 1)}; }
};
Powers powers(int degree, std::uint64_t seed) {
  Uniform u(seed);
  Powers result;
  for (int a = 0; a <= degree; ++a)
    for (int b = 0; b <= degree; ++b) result.c[a][b] = u(-1, 1) * std::pow(.3, a + b);
  return result;
}

// Cells of unequal sides beside the origin: 1 to 2 mm, heights to 3 mm; 40 roundings of them, over a spacing of 0.3 mm for slopes.
TEST(Grid, IsExactForBicubics) {
  numerics::Arena arena;
  const Powers p = powers(3, 1);
  const BicubicGrid grid = grid_on(sag_grid({9, 7, .5, .3, .7, -.2}, [&](double x, double y) { return p.node(x, y); }), arena);
  Uniform u(2);
  for (int i = 0; i < 2000; ++i) {
    const double x = .7 + u(-2, 2), y = -.2 + u(-.9, .9);
    EXPECT_NEAR(grid.sag(x, y), p.at(x, y), 40 * eps * 3);
    EXPECT_NEAR(grid.gradient(x, y).x, p.at(x, y, 1), 40 * eps * 10);
    EXPECT_NEAR(grid.gradient(x, y).y, p.at(x, y, 0, 1), 40 * eps * 10);
  }
  for (const SagGrid::Node node : {p.node(.7 - 2, -.2 - .9), p.node(.7 + 2, -.2 + .9)}) EXPECT_LT(std::abs(node.z), 3);
}

// Exact for polynomials of degree 4, at rims too: of degree 4 the bicubic itself is not, but its nodes are.
TEST(Grid, TakesSlopesFromTheNearestFiveHeights) {
  numerics::Arena arena;
  const Powers p = powers(4, 3);
  const SagGrid given = sag_grid({8, 5, .5, .3}, [&](double x, double y) { return p.node(x, y); });
  const BicubicGrid grid = grid_on(without_slopes(given), arena);
  EXPECT_FALSE(grid.has_given_slopes);
  EXPECT_EQ(grid.kernel(), "bicubic grid of 8 x 5, slopes by differences");
  for (int j = 0; j < 5; ++j)
    for (int i = 0; i < 8; ++i) {
      const SagGrid::Node& node = given.nodes[static_cast<std::size_t>(j * 8 + i)];
      const GridNode& found = *grid.node(i + 1, j + 1);
      EXPECT_EQ(found.z, node.z);
      EXPECT_NEAR(found.x, .5 * node.dz_dx, 100 * eps) << i << " " << j;
      EXPECT_NEAR(found.y, .3 * node.dz_dy, 100 * eps) << i << " " << j;
      EXPECT_NEAR(found.xy, .5 * .3 * node.d2z_dxdy, 1000 * eps) << i << " " << j;
    }
}

// Five in a row on one side of a hole; four, three and two are exact for degrees 3, 2 and 1; one alone has no cell.
TEST(Grid, TakesAsManyHeightsAsThereAreBesideHoles) {
  numerics::Arena arena;
  for (int run = 1; run <= 6; ++run) {
    const Powers p = powers(std::min(run, 5) - 1, 5);
    SagGrid given = sag_grid({16, 6, .25, .25}, [&](double x, double y) { return p.node(x, y); });
    for (int j = 0; j < 6; ++j) {
      given = with_hole(std::move(given), 8, j);
      for (int i = 9 + run; i < 16; ++i) given = with_hole(std::move(given), i, j);
    }
    const BicubicGrid grid = grid_on(without_slopes(given), arena);
    EXPECT_TRUE(grid.has_data(-1.0, 0.0));
    const double x = given.first_x + 9.5 * .25;
    EXPECT_EQ(grid.has_data(x, .1), run > 1) << run;
    for (int i = 9; i < 9 + run && run > 1; ++i)
      EXPECT_NEAR(grid.node(i + 1, 3)->x, .25 * given.nodes[static_cast<std::size_t>(2 * 16 + i)].dz_dx, 100 * eps) << run << " " << i;
  }
}

// On either side of an edge the same height and slopes, to rounding; also across the rim, where rays go on that have no hit there.
TEST(Grid, IsSmoothAcrossEdgesAndTheRim) {
  numerics::Arena arena;
  const SagGrid waves = sag_grid({7, 9, .5, .25}, [](double x, double y) { return of_waves(.8, x, y); });
  int count = 0;
  for (const SagGrid& given : {waves, without_slopes(waves), with_hole(without_slopes(waves), 3, 4), with_hole(waves, 0, 0)}) {
    const BicubicGrid grid = grid_on(given, arena);
    Uniform u(4);
    const auto check = [&](const V& a, const V& b) {
      const auto here = grid.height(a.x, a.y), there = grid.height(b.x, b.y);
      EXPECT_NEAR(here.z, there.z, 40 * eps);
      EXPECT_NEAR(here.dz_dx, there.dz_dx, 200 * eps);
      EXPECT_NEAR(here.dz_dy, there.dz_dy, 200 * eps);
      ++count;
    };
    for (int i = -1; i <= 7; ++i) {  // beyond 0 and 6 the row of wide cells, and its own end
      const double edge = given.first_x + (i == -1 ? -3 : i == 7 ? 6 : .5 * i), y = u(-2.5, 2.5);
      check({edge - 4 * eps, y, 0}, {edge + 4 * eps, y, 0});
    }
    for (int j = -1; j <= 9; ++j) {
      const double edge = given.first_y + (j == -1 ? -2 : j == 9 ? 4 : .25 * j), x = u(-4, 4);
      check({x, edge - 4 * eps, 0}, {x, edge + 4 * eps, 0});
    }
  }
  EXPECT_EQ(count, 4 * 20);
}

// The slope across the rim falls to 0 over the grid's own width, and there it ends.
TEST(Grid, FlattensBeyondItsRim) {
  numerics::Arena arena;
  const SagGrid given = sag_grid({5, 5, .5, .25}, [](double x, double y) { return of_waves(.8, x, y); });
  const BicubicGrid grid = grid_on(given, arena);
  const SagGrid::Node rim = of_waves(.8, 1, .25), corner = of_waves(.8, 1, .5);
  for (const double beyond : {0.1, .5, 1.5, 2.0, 5.0}) {
    const double u = std::min(beyond, 2.0), e = u - u * u / 4, of_y = std::min(beyond, 1.0), e_y = of_y - of_y * of_y / 2;
    EXPECT_NEAR(grid.height(1 + beyond, .25).z, rim.z + rim.dz_dx * e, 40 * eps);
    EXPECT_NEAR(grid.height(1 + beyond, .25).dz_dx, rim.dz_dx * (1 - u / 2), 40 * eps);
    EXPECT_NEAR(grid.height(1 + beyond, .25).dz_dy, rim.dz_dy + rim.d2z_dxdy * e, 100 * eps);
    EXPECT_NEAR(grid.height(1 + beyond, .5 + beyond).z, corner.z + corner.dz_dx * e + corner.dz_dy * e_y + corner.d2z_dxdy * e * e_y, 100 * eps);
    EXPECT_TRUE(std::isnan(grid.sag(1 + beyond, .25)));
    EXPECT_TRUE(std::isnan(grid.gradient(.25, -.5 - beyond).y));
  }
  // There second derivatives across the rim are its slopes over the width, and bounded by little more.
  double steepest_x = 0, steepest_y = 0;
  for (const SagGrid::Node& node : given.nodes) steepest_x = std::max(steepest_x, std::abs(node.dz_dx)), steepest_y = std::max(steepest_y, std::abs(node.dz_dy));
  for (int k = 1; k < 5; ++k) {
    for (const int outer : {0, 5}) {
      EXPECT_LE(grid.cell_bends(outer, k).xx, 1.1 * steepest_x / 2);
      EXPECT_LE(grid.cell_bends(k, outer).yy, 1.1 * steepest_y / 1);
    }
  }
}

// Cells that touch a node without data, and all beyond the rim: outside_data; the rim itself is not.
TEST(Grid, HasNoHitWhereItHasNoData) {
  numerics::Arena arena;
  const BicubicGrid grid = grid_on(with_hole(sag_grid({9, 7, 1, 1}, [](double x, double y) { return of_sphere(20, x, y); }), 4, 3), arena);  // (0, 0)
  const auto status = [&](double x, double y) { return grid.meet(V{x, y, -3}, V{0, 0, 1}).status; };
  for (const double x : {-4.0, -1.0, -1.5, 2.0, 4.0}) EXPECT_EQ(status(x, .5), Status::ok) << x;
  for (const double y : {-3.0, -1.0, 1.0, 2.5, 3.0}) EXPECT_EQ(status(.5, y), Status::ok) << y;
  for (const double x : {-.999, -.5, 0.0, .999}) EXPECT_EQ(status(x, .5), Status::outside_data) << x;
  for (const double y : {-.999, -.5, 0.0, .999}) EXPECT_EQ(status(-.25, y), Status::outside_data) << y;
  for (const double x : {-4.001, 4.001, 1e9}) EXPECT_EQ(status(x, 0), Status::outside_data) << x;
  for (const double y : {-3.001, 3.001, -1e9}) EXPECT_EQ(status(2, y), Status::outside_data) << y;
  EXPECT_TRUE(std::isnan(grid.sag(.5, -.5)));
  EXPECT_FALSE(std::isnan(grid.sag(1.5, -.5)));
  // All four of its cells, and no other.
  int holes = 0;
  for (int j = 0; j <= 7; ++j)
    for (int i = 0; i <= 9; ++i) holes += grid.is_hole[j * 10 + i];
  EXPECT_EQ(holes, 4);
}

// The sphere of which every height is the departure: lines at 45 degrees meet the base, a plane, up to 3 mm beside their hit, over the hole or beyond the rim.
TEST(Grid, IsMetByLinesThatMeetTheBaseWhereThereAreNoData) {
  numerics::Arena arena;
  const SagGrid given = sag_grid({41, 41, .25, .25}, [](double x, double y) { return of_sphere(10, x, y); });
  const BicubicGrid whole = grid_on(given, arena), holed = grid_on(with_hole(given, 20, 20), arena);
  const V d = normalized(V{1, 0, 1});
  int beyond_rim = 0, over_hole = 0;
  for (double x = -5; x <= 5; x += .125)
    for (double y = -5; y <= 5; y += .25) {
      const double z = whole.sag(x, y), base_x = x - z;
      const auto hit = whole.meet(V{x, y, z} - 20.0 * d, d);
      ASSERT_EQ(hit.status, Status::ok);
      EXPECT_NEAR(hit.path, 20, 1e-13);
      beyond_rim += std::abs(base_x) > 5;
      const auto other = holed.meet(V{x, y, z} - 20.0 * d, d);
      const bool is_in_hole = std::abs(x) < .25 && std::abs(y) < .25;
      EXPECT_EQ(other.status, is_in_hole ? Status::outside_data : Status::ok) << x << " " << y;
      over_hole += !is_in_hole && std::abs(base_x) < .25 && std::abs(y) < .25;
    }
  EXPECT_GT(beyond_rim, 100);
  EXPECT_GT(over_hole, 0);
}

// A line whose hit ends at a fold has none: not_converged where there are data at its hit on the base, outside_data where there are not.
TEST(Grid, TellsFoldsWithinTheDataFromFoldsBeyond) {
  numerics::Arena arena;
  const BicubicGrid grid = grid_on(sag_grid({17, 17, .25, .25}, [](double x, double y) { return of_waves(1.2, x, y); }), arena);
  Uniform u(9);
  int within = 0, beyond = 0, hits = 0;
  for (int i = 0; i < 4000; ++i) {
    const V d = normalized(V{u(-1, 1), u(-1, 1), .5}), start = V{u(-4, 4), u(-4, 4), 0} - 3.0 * d;
    const V base = grid.base.meet(start, d).point;
    if (static_cast<const QuadricDeparture<BicubicGrid>&>(grid).meet(start, d).status == Status::ok) {
      ++hits;
      continue;
    }
    const bool is_within = grid.has_data(base.x, base.y);
    EXPECT_EQ(grid.meet(start, d).status, is_within ? Status::not_converged : Status::outside_data);
    ++(is_within ? within : beyond);
  }
  EXPECT_GT(within, 15);
  EXPECT_GT(beyond, 40);
  EXPECT_GT(hits, 1000);
}

// 1/12 f'''' h^2 is what one side is off by; on a node both sides count, unless there are data of one only.
TEST(Grid, HasTheVertexCurvatureOfBothSidesOfANode) {
  numerics::Arena arena;
  Powers p;
  p.c[0][2] = .03, p.c[0][3] = .02, p.c[0][4] = .004, p.c[2][2] = .01;
  const auto node = [&](double x, double y) { return p.node(x, y); };
  const Conic base{.05, -1};
  const double h = .5, one_sided = .06 - 2 * .004 * h * h;  // f'' - h^2 f''''/12; the terms of f''' cancel
  EXPECT_NEAR(grid_on(sag_grid({9, 9, h, h}, node), arena, base).vertex_curvature(), .05 + one_sided, 10 * eps);
  SagGrid jumps = sag_grid({9, 9, h, h}, node);
  for (int i = 0; i < 9; ++i) jumps.nodes[static_cast<std::size_t>(5 * 9 + i)].z += .01;  // above the origin: there 6 x 0.01/h^2 more
  EXPECT_NEAR(grid_on(jumps, arena, base).vertex_curvature(), .05 + one_sided + .5 * .06 / (h * h), 20 * eps);
  EXPECT_NEAR(grid_on(with_hole(jumps, 4, 3), arena, base).vertex_curvature(), .05 + one_sided + .06 / (h * h), 20 * eps);
  EXPECT_NEAR(grid_on(with_hole(jumps, 4, 5), arena, base).vertex_curvature(), .05 + one_sided, 20 * eps);
  // within a cell: the bicubic's own
  const BicubicGrid inside = grid_on(sag_grid({8, 8, h, h}, node), arena, base);
  const double d = 1e-4, second = (inside.sag(0.0, d) - 2 * inside.sag(0.0, 0.0) + inside.sag(0.0, -d)) / (d * d);
  EXPECT_NEAR(inside.vertex_curvature(), second, 1e-7);
  // along x likewise: the same grids with x and y exchanged
  const auto turned = [](const SagGrid& grid) {
    SagGrid result = grid;
    for (std::size_t j = 0; j < 9; ++j)
      for (std::size_t i = 0; i < 9; ++i) {
        const SagGrid::Node& from = grid.nodes[i * 9 + j];
        result.nodes[j * 9 + i] = from;
        std::swap(result.nodes[j * 9 + i].dz_dx, result.nodes[j * 9 + i].dz_dy);
      }
    return result;
  };
  for (const SagGrid& grid : {sag_grid({9, 9, h, h}, node), jumps}) EXPECT_EQ(grid_on(turned(grid), arena, base).vertex_curvature_x(), grid_on(grid, arena, base).vertex_curvature());
  EXPECT_NEAR(grid_on(jumps, arena, base).vertex_curvature_x(), .05, 10 * eps);
  EXPECT_EQ(grid_on(sag_grid({5, 5, h, h}, [](double, double) { return SagGrid::Node{}; }), arena, base).vertex_curvature(), .05);
}

// A height that all nodes have moves the surface and changes nothing else: 1e3 mm over nodes 1 um apart.
TEST(Grid, SlopesNothingByAHeightThatAllNodesHave) {
  numerics::Arena arena;
  const double h = 0x1p-10, piston = 1024;
  const auto height = [&](double x, double y) { return std::ldexp(std::nearbyint(std::ldexp(.3 * x + x * y, 40)), -40); };  // sums with the piston are exact
  const BicubicGrid bare = grid_on(without_slopes(sag_grid({6, 6, h, h}, [&](double x, double y) { return SagGrid::Node{height(x, y), 0, 0, 0}; })), arena);
  const BicubicGrid moved = grid_on(without_slopes(sag_grid({6, 6, h, h}, [&](double x, double y) { return SagGrid::Node{height(x, y) + piston, 0, 0, 0}; })), arena);
  Uniform u(6);
  for (int i = 0; i < 200; ++i) {
    const double x = u(-2 * h, 2 * h), y = u(-2 * h, 2 * h);
    EXPECT_EQ(moved.gradient(x, y).x, bare.gradient(x, y).x);
    EXPECT_EQ(moved.gradient(x, y).y, bare.gradient(x, y).y);
    EXPECT_NEAR(moved.sag(x, y), bare.sag(x, y) + piston, 2 * eps * piston);
  }
}

// One node 0.1 mm above a plane, and a rough rim: the bound holds for whatever is within reach, and knows of nothing that is not.
TEST(Grid, BoundsSecondDerivativesByTheCellsWithinReach) {
  numerics::Arena arena;
  SagGrid given = without_slopes(sag_grid({31, 31, .5, .5}, [](double, double) { return SagGrid::Node{}; }));
  given.nodes[15 * 31 + 15].z = .1;
  for (int k = 0; k < 31; ++k) given.nodes[static_cast<std::size_t>(31 * k)].z = k % 2 == 0 ? .02 : -.01;
  const BicubicGrid grid = grid_on(given, arena);
  Uniform u(8);
  int counts[2]{};
  for (int i = 0; i < 4000; ++i) {
    const V at{u(-12, 12), u(-9, 9), 0}, d = normalized(V{u(-1, 1), u(-1, 1), u(.1, 1)});
    const double reach = u(0, .7), bound = grid.bend_on(at, d, reach), h = 1e-4;
    for (double t = -reach; t <= reach; t += reach / 8) {
      const auto height = [&](double where) { return grid.height(at.x + where * d.x, at.y + where * d.y).z; };
      const double second = (height(t + h) - 2 * height(t) + height(t - h)) / (h * h);
      if (std::abs(t) <= reach - h) {
        EXPECT_LE(std::abs(second), bound + 1e-6);
      }
    }
    const bool is_far = std::max(std::abs(at.x), std::abs(at.y)) > 3 && std::abs(at.x) < 5;  // what two rows about a node have of it ends at 1.5 mm
    if (is_far && reach > .3) {
      EXPECT_EQ(bound, 0) << at.x << " " << at.y;
    }
    ++counts[is_far];
  }
  EXPECT_GT(counts[0], 500);
  EXPECT_GT(counts[1], 500);
}

// A sphere on a grid, met at 20 degrees by 400 lines: heights are off by O(h^4), normals by O(h^3). As `given` says, all of the sag is in the grid, or what departs from
// a base of another radius; slopes are the sphere's, or by differences.
TEST(Grid, ConvergesToTheSphereItIsMadeOfAtOrderFour) {
  numerics::Arena arena;
  const Conic exact_sphere{1 / 8.0, 0};
  for (const bool by_differences : {false, true})
    for (const double base_radius : {infinity, 7.5}) {
      const Conic base{1 / base_radius, 0};
      std::vector<double> of_path, of_slope;
      for (const int cells : {20, 40, 80, 160}) {
        SagGrid given = sag_grid({cells + 1, cells + 1, 8.0 / cells, 8.0 / cells}, [&](double x, double y) {
          const SagGrid::Node whole = of_sphere(8, x, y), of_base = base.curvature == 0 ? SagGrid::Node{} : of_sphere(base_radius, x, y);
          return SagGrid::Node{whole.z - of_base.z, whole.dz_dx - of_base.dz_dx, whole.dz_dy - of_base.dz_dy, whole.d2z_dxdy - of_base.d2z_dxdy};
        });
        if (by_differences) given = without_slopes(std::move(given));
        const BicubicGrid grid = grid_on(given, arena, base);
        Uniform u(7);
        double path = 0, slope = 0;
        for (int i = 0; i < 400; ++i) {
          const double r = 3.5 * std::sqrt(u()), at = u(0, 6.3), tilt = 20 * M_PI / 180, turn = u(0, 6.3);
          const V d{std::sin(tilt) * std::cos(turn), std::sin(tilt) * std::sin(turn), std::cos(tilt)};
          const V start = V{r * std::cos(at), r * std::sin(at), .5} - 12.0 * d;
          const auto exact = exact_sphere.meet(start, d), hit = grid.meet(start, d);
          ASSERT_EQ(hit.status, Status::ok);
          path = std::max(path, std::abs(hit.path - exact.path));
          slope = std::max(slope, norm(normalized(hit.normal) - normalized(exact.normal)));
        }
        of_path.push_back(path), of_slope.push_back(slope);
      }
      SCOPED_TRACE(std::string(by_differences ? "by differences" : "with slopes") + (base.curvature == 0 ? " on a plane" : " on a sphere"));
      for (std::size_t k = 1; k + 1 < of_path.size(); ++k) {
        EXPECT_NEAR(std::log2(of_path[k] / of_path[k + 1]), 4, .35) << of_path[k];
        EXPECT_NEAR(std::log2(of_slope[k] / of_slope[k + 1]), 3, .35) << of_slope[k];
      }
    }
}

}  // namespace
}  // namespace sagitta::surface
