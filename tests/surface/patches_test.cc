// SPDX-License-Identifier: Apache-2.0
#include "lib/surface/patches.h"

#include <gtest/gtest.h>

#include <boost/multiprecision/cpp_dec_float.hpp>
#include <cmath>
#include <numbers>

#include "lib/scene/fit_patches.h"
#include "lib/scene/fit_radial.h"
#include "lib/scene/triangulate.h"
#include "lib/surface/radial.h"
#include "lib/surface/refraction.h"
#include "tests/support/point_sets.h"

namespace sagitta::surface {
namespace {

using namespace tests;
using Real50 = boost::multiprecision::cpp_dec_float_50;

// A mesh with its C1 patches.
struct Smooth {
  std::shared_ptr<const scene::MeshStorage> mesh;
  numerics::UnsetArray<CloughTocherPatch> patches;

  explicit Smooth(const PointCloud& cloud) : mesh(scene::triangulate(cloud).mesh), patches(scene::fit_patches(mesh->mesh).patches) {}
  Facets facets() const { return {&mesh->mesh}; }
  Patches c1() const { return {facets(), patches.data()}; }
};

double cubic(double x, double y) {
  return 0.3 + 0.1 * x - 0.2 * y + 0.06 * x * x + 0.01 * x * y + 0.07 * y * y + 0.003 * x * x * x - 0.002 * x * x * y +
         0.004 * x * y * y - 0.001 * y * y * y;
}

// A33: exact for cubics on any points, the fitted gradients and the patches being exact for them. Tolerance: coefficients up
// to 0.3, local fits of condition 1e3 in eps: 1e-13; slopes divide that by a spacing of 0.1.
TEST(Patches, are_exact_for_cubics_on_scattered_points) {
  const Smooth surface(cloud_of(uniform_random(3000, 3, 5), cubic));
  Uniform u(1);
  int compared = 0;
  for (int i = 0; i < 5000; ++i) {
    const double x = u(-2.5, 2.5), y = u(-2.5, 2.5);
    EXPECT_NEAR(surface.c1().sag(x, y), cubic(x, y), 1e-12);
    const auto slope = surface.c1().gradient(x, y);
    EXPECT_NEAR(slope.x, 0.1 + 0.12 * x + 0.01 * y + 0.009 * x * x - 0.004 * x * y + 0.004 * y * y, 1e-11);
    EXPECT_NEAR(slope.y, -0.2 + 0.01 * x + 0.14 * y - 0.002 * x * x + 0.008 * x * y - 0.003 * y * y, 1e-11);
    ++compared;
  }
  EXPECT_EQ(compared, 5000);
}

// Figure 6 of freeform.md: over shared edges, from either side: sag jump <= 1e-12 mm, kink <= 1e-8 arcmin (2.9e-12 rad).
TEST(Patches, join_without_jump_or_kink) {
  const Conic cornea{1 / 7.72, -0.26};
  const Smooth surface(cloud_of(uniform_random(4000, 4, 8), [&](double x, double y) { return cornea.sag(x, y); }));
  const Mesh& mesh = surface.mesh->mesh;
  int edges = 0;
  for (std::uint32_t f = 0; f < mesh.facet_count; ++f)
    for (int i = 0; i < 3; ++i) {
      const std::uint32_t g = mesh.facets[f].neighbour[i];
      if (g == no_facet || g < f) continue;
      ++edges;
      const auto &a = mesh.vertices[mesh.corners[f][(i + 1) % 3]], &b = mesh.vertices[mesh.corners[f][(i + 2) % 3]];
      for (const double s : {0.13, 0.5, 0.81}) {
        const double x = a.x + s * (b.x - a.x), y = a.y + s * (b.y - a.y);
        const auto &p = surface.patches[f], &q = surface.patches[g];
        const auto one = p.evaluate(x, y, mesh.facets[f]), other = q.evaluate(x, y, mesh.facets[g]);
        // slivers of the hull have ill-conditioned barycentric coordinates: rounding there is eps / (height / edge)
        const double height = std::abs(1 / p.m1_x) < 1e-3 || std::abs(1 / q.m1_x) < 1e-3 ? 1e2 : 1;
        EXPECT_NEAR(one.z, other.z, 1e-12 * height);
        EXPECT_NEAR(one.dz_dx, other.dz_dx, 2.9e-12 * height * 1e1);
        EXPECT_NEAR(one.dz_dy, other.dz_dy, 2.9e-12 * height * 1e1);
      }
    }
  EXPECT_GT(edges, 10000);
}

// Figure 4 of freeform.md: the lens of section 3.A, R 65.77, at 100 points per mm^2: <= 1e-5 arcmin and <= 1e-6 um in the
// mean, regular and random.
TEST(Patches, reach_the_lens_figures_at_100_per_mm2) {
  const Conic sphere{1 / 65.77, 0};
  const double half = 13;
  const auto height = [&](double x, double y) { return sphere.sag(x, y); };
  const auto glass = IndexRatio<double>::of(1, 1.64134164);
  for (const auto& places : {regular_grid(261, 261, half, half), uniform_random(67600, half, 3)}) {
    const Smooth surface(cloud_of(places, height));
    Uniform u(2);
    double distance = 0, angle = 0;
    int count = 0;
    while (count < 20000) {
      const Vec3<double> p{u(-12.5, 12.5), u(-12.5, 12.5), -5}, d{0, 0, 1};
      if (p.x * p.x + p.y * p.y > 12.5 * 12.5) continue;
      ++count;
      const auto exact = sphere.meet(p, d), got = surface.c1().meet(p, d);
      ASSERT_EQ(got.status, Status::ok);
      distance += std::abs(got.path - exact.path) * 1e3;
      angle += numerics::angle_between(refract(d, got.normal, got.along, glass), refract(d, exact.normal, exact.along, glass));
    }
    EXPECT_LE(distance / count, 1e-6);
    EXPECT_LE(angle / count * 180 * 60 / std::numbers::pi, 1e-5);
  }
}

template <class Shape>
void expect_hits_on_the_surface(const Shape& shape, double tolerance) {
  Uniform u(7);
  int hits = 0, outside = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vec3<double> d = normalized(Vec3<double>{u(-1, 1), u(-1, 1), 1});
    const Vec3<double> p = Vec3<double>{u(-3.2, 3.2), u(-3.2, 3.2), 0.5} - u(0.0, 20.0) * d;
    const auto crossing = shape.meet(p, d);
    if (crossing.status != Status::ok) {
      ++outside;
      EXPECT_EQ(crossing.status, Status::outside_data);
      EXPECT_TRUE(std::isnan(crossing.path));
      continue;
    }
    ++hits;
    EXPECT_NEAR(crossing.point.z, shape.sag(crossing.point.x, crossing.point.y), tolerance);
    EXPECT_LE(norm(cross(crossing.point - p, d)), 1e-13);
  }
  EXPECT_GT(hits, 14000);
  EXPECT_GT(outside, 500);
}

TEST(Patches, hit_of_a_tilted_ray_lies_on_them_or_is_outside_the_data) {
  const Conic cornea{1 / 7.72, -0.26};
  const Smooth surface(cloud_of(uniform_random(4000, 3, 8), [&](double x, double y) { return cornea.sag(x, y); }));
  expect_hits_on_the_surface(surface.c1(), 1e-13);
}

// Rays across the z axis (2026-11-22: not_converged, since flat facets and patches did not agree on which sense is forward
// where d.z is 0). A plane at z = 0.5 cuts the bowl z = r^2/20 in the circle r^2 = 10. Tolerance: the points' spacing of 0.3
// leaves c1 right to 1e-5 of a bowl, which along the ray is three times as much.
TEST(Patches, are_met_by_rays_across_the_axis) {
  const Smooth bowl(cloud_of(uniform_random(600, 4, 6), [](double x, double y) { return 0.05 * (x * x + y * y); }));
  const Smooth dome(cloud_of(uniform_random(600, 4, 6), [](double x, double y) { return 0.5 + 0.05 * (10 - x * x - y * y); }));
  for (const Smooth* smooth : {&bowl, &dome})
    for (const double sense : {1.0, -1.0}) {
      const Vec3<double> along_x{sense, 0, 0}, along_y{0, sense, 0};
      int hits = 0;
      for (const auto& [start, d] : {std::pair{Vec3<double>{-10, 0.1, 0.5}, along_x}, {Vec3<double>{0.1, -10, 0.5}, along_y}}) {
        const auto crossing = smooth->c1().meet(start, d);
        ASSERT_EQ(crossing.status, Status::ok);
        EXPECT_NEAR(crossing.point.x * crossing.point.x + crossing.point.y * crossing.point.y, 10, 1e-3);
        EXPECT_GT(dot(crossing.normal, d), 0);  // as for every shape: d.z = 0 counts as forward
        ++hits;
      }
      EXPECT_EQ(hits, 2);
    }
}

// Where the patches are a cubic, lines of any tilt and both senses meet that cubic, and have its slope there. Curved so much
// over facets so large that the ways from the facet to the patch are long. Tolerance: fits right to 1000 eps (cubic_fit.h, (3))
// of heights that differ by 2 mm within two rings, 4.4e-13; slopes divide that by a spacing of 0.1.
TEST(Patches, meet_lines_where_the_cubic_that_they_are_does) {
  const Smooth surface(cloud_of(uniform_random(400, 3, 6), [](double x, double y) { return 3 * cubic(x, y); }));
  Uniform u(9);
  int hits = 0, backward = 0;
  for (int i = 0; i < 40000; ++i) {
    const double tilt = u(0, 1.5), azimuth = u(0, 2 * std::numbers::pi);
    Vec3<double> d{std::sin(tilt) * std::cos(azimuth), std::sin(tilt) * std::sin(azimuth), std::cos(tilt)};
    if (i % 3 == 0) d = -d;
    const double aim_x = u(-2.2, 2.2), aim_y = u(-2.2, 2.2);
    const auto crossing = surface.c1().meet(Vec3<double>{aim_x, aim_y, 3 * cubic(aim_x, aim_y)} - u(0, 20) * d, d);
    const auto [x, y, z] = crossing.point;
    if (crossing.status != Status::ok || std::abs(x) > 2.3 || std::abs(y) > 2.3) continue;
    ++hits;
    backward += d.z < 0;
    EXPECT_NEAR(z, 3 * cubic(x, y), 1e-12);
    EXPECT_NEAR(-crossing.normal.x, 3 * (0.1 + 0.12 * x + 0.01 * y + 0.009 * x * x - 0.004 * x * y + 0.004 * y * y), 1e-11);
    EXPECT_NEAR(-crossing.normal.y, 3 * (-0.2 + 0.01 * x + 0.14 * y - 0.002 * x * x + 0.008 * x * y - 0.003 * y * y), 1e-11);
    EXPECT_GT(crossing.along * d.z, 0);
  }
  EXPECT_GT(hits, 30000);
  EXPECT_GT(backward, 10000);
}

// Where heights are rough every third of a patch is another cubic: a hit is one of the third that it lies on. Tolerance:
// positions up to 5 mm, 1e-15, times slopes up to 5, a few times. A hit within the slack of an edge may have the slope of
// the third beyond it: 1e-12 of an edge, 0.5 mm, times a second derivative of 6 times 0.2 mm over the square of 0.1 mm.
TEST(Patches, meet_lines_on_the_third_below_the_hit) {
  Uniform u(10);
  std::vector<Place2> places = regular_grid(25, 25, 3, 3);
  for (Place2& p : places) p.x += u(-0.05, 0.05), p.y += u(-0.05, 0.05);
  const Smooth surface(cloud_of(places, [&](double x, double y) { return cubic(x, y) + u(-0.1, 0.1); }));
  int hits = 0;
  for (int i = 0; i < 40000; ++i) {
    const double tilt = u(0, 1.4), azimuth = u(0, 2 * std::numbers::pi);
    const Vec3<double> d{std::sin(tilt) * std::cos(azimuth), std::sin(tilt) * std::sin(azimuth), std::cos(tilt)};
    const double aim_x = u(-2.6, 2.6), aim_y = u(-2.6, 2.6);
    const auto crossing = surface.c1().meet(Vec3<double>{aim_x, aim_y, surface.c1().sag(aim_x, aim_y)} - u(0, 5) * d, d);
    const auto [x, y, z] = crossing.point;
    if (crossing.status != Status::ok || std::abs(x) > 2.7 || std::abs(y) > 2.7) continue;
    ++hits;
    const auto slope = surface.c1().gradient(x, y);
    EXPECT_NEAR(z, surface.c1().sag(x, y), 1e-13);
    EXPECT_NEAR(-crossing.normal.x, slope.x, 6e-11);
    EXPECT_NEAR(-crossing.normal.y, slope.y, 6e-11);
    EXPECT_GT(crossing.along * d.z, 0);
  }
  EXPECT_GT(hits, 20000);
}

// The radial functions jump between facets: a hit may lie on a facet's continuation beyond its edge, where sag() tells the
// neighbour's height. The jump on this cornea at 10 points/mm is below 2 um (multiquadric).
TEST(RadialPatches, hits_of_tilted_rays_lie_on_them_within_their_jumps) {
  const Conic cornea{1 / 7.72, -0.26};
  const Smooth surface(cloud_of(regular_grid(61, 61, 3, 3), [&](double x, double y) { return cornea.sag(x, y); }));
  const auto check = [&]<RadialFunction function>() {
    const auto fit = scene::fit_radial<function>(surface.mesh->mesh, {});
    expect_hits_on_the_surface(RadialPatches<function>{surface.facets(), fit.patches.data(), fit.nodes.data(), fit.weights.data(), fit.shape_squared}, 2e-3);
  };
  check.operator()<RadialFunction::cubic>();
  check.operator()<RadialFunction::thin_plate>();
  check.operator()<RadialFunction::multiquadric>();
}

// A33: any interpolant reproduces planes; with no ring of nodes but the corners a radial function is the flat facet.
TEST(RadialPatches, planes_are_exact_and_no_rings_are_flat_facets) {
  const auto plane = [](double x, double y) { return 0.25 * x - 0.5 * y + 1; };
  const Smooth tilted(cloud_of(uniform_random(400, 3, 2), plane));
  const auto fit = scene::fit_radial<RadialFunction::thin_plate>(tilted.mesh->mesh, {});
  const RadialPatches<RadialFunction::thin_plate> shape{tilted.facets(), fit.patches.data(), fit.nodes.data(), fit.weights.data(), 0};
  const Conic cornea{1 / 7.72, -0.26};
  const Smooth curved(cloud_of(uniform_random(400, 3, 2), [&](double x, double y) { return cornea.sag(x, y); }));
  const auto bare = scene::fit_radial<RadialFunction::cubic>(curved.mesh->mesh, {.rings = 0});
  const RadialPatches<RadialFunction::cubic> flat{curved.facets(), bare.patches.data(), bare.nodes.data(), bare.weights.data(), 0};
  Uniform u(3);
  for (int i = 0; i < 1000; ++i) {
    const double x = u(-2.5, 2.5), y = u(-2.5, 2.5);
    EXPECT_NEAR(shape.sag(x, y), plane(x, y), 1e-12);
    EXPECT_NEAR(flat.sag(x, y), curved.facets().sag(x, y), 1e-14);
  }
}

// 2026-11-22: where nodes stand near each other along a ring the system is singular to rounding, and one facet in forty of
// this cloud was silently flat (1.4 um off).
TEST(RadialPatches, pass_through_their_nodes_on_rings_too) {
  const Conic cornea{1 / 7.72, -0.26};
  const Smooth rings(cloud_of(polar_rings(24, 180, 3.6, false), [&](double x, double y) { return cornea.sag(x, y); }));
  for (const double shape_mm : {0.0, 0.5, 2.0}) {
    constexpr auto function = RadialFunction::multiquadric;
    const auto fit = scene::fit_radial<function>(rings.mesh->mesh, {.shape_mm = shape_mm});
    const RadialPatches<function> shape{rings.facets(), fit.patches.data(), fit.nodes.data(), fit.weights.data(), fit.shape_squared};
    double worst = 0;
    for (std::uint32_t f = 0; f < rings.mesh->mesh.facet_count; ++f) {
      ASSERT_GT(fit.patches[f].node_count, 3u) << f;
      for (const std::uint32_t v : rings.mesh->corners[f]) {
        const auto& p = rings.mesh->vertices[v];
        worst = std::max(worst, std::abs(shape.height_of(f, p.x, p.y).z - p.z));
      }
    }
    EXPECT_LE(worst, 1e-6) << shape_mm;  // mm: a thousandth of what flat facets miss between the points
  }
}

// The gradient is that of the function: against differences in 50 digits.
TEST(RadialPatches, gradient_is_that_of_the_function) {
  const Conic cornea{1 / 7.72, -0.26};
  const Smooth surface(cloud_of(regular_grid(21, 21, 3, 3), [&](double x, double y) { return cornea.sag(x, y); }));
  const auto check = [&]<RadialFunction function>() {
    const auto fit = scene::fit_radial<function>(surface.mesh->mesh, {});
    const RadialPatches<function> shape{surface.facets(), fit.patches.data(), fit.nodes.data(), fit.weights.data(), fit.shape_squared};
    const Real50 x("0.3712345"), y("-0.8123"), h("1e-15");
    const auto slope = shape.gradient(static_cast<double>(x), static_cast<double>(y));
    EXPECT_NEAR(slope.x, static_cast<double>((shape.template sag<Real50>(x + h, y) - shape.template sag<Real50>(x - h, y)) / (2 * h)), 1e-11);
    EXPECT_NEAR(slope.y, static_cast<double>((shape.template sag<Real50>(x, y + h) - shape.template sag<Real50>(x, y - h)) / (2 * h)), 1e-11);
  };
  check.operator()<RadialFunction::cubic>();
  check.operator()<RadialFunction::thin_plate>();
  check.operator()<RadialFunction::multiquadric>();
}

}  // namespace
}  // namespace sagitta::surface
