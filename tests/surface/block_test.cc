// SPDX-License-Identifier: Apache-2.0
// Blocks of lines (block.h): the same bits as line by line.
#include "lib/surface/block.h"

#include <gtest/gtest.h>

#include <bit>
#include <memory>

#include "lib/numerics/arena.h"
#include "lib/scene/fit_patches.h"
#include "lib/scene/triangulate.h"
#include "lib/surface/patches.h"
#include "lib/surface/zernike.h"
#include "tests/support/point_sets.h"

namespace sagitta::surface {
namespace {

using namespace sagitta::tests;
using V = Vec3<double>;

constexpr int ray_count = 100'000;

// A layout's points on a sphere, with a hole in the middle.
struct Surfaces {
  std::shared_ptr<const scene::MeshStorage> mesh;
  numerics::UnsetArray<CloughTocherPatch> patches;

  explicit Surfaces(const Layout& layout) {
    const auto height = [on_sphere = sphere(12)](double x, double y) {
      return x * x + y * y < 0.5 ? std::numeric_limits<double>::quiet_NaN() : on_sphere(x, y);
    };
    mesh = scene::triangulate(cloud_of(layout.places, height)).mesh;
    patches = scene::fit_patches(mesh->mesh).patches;
  }
  Facets linear() const { return {&mesh->mesh}; }
  Patches c1() const { return {linear(), patches.data()}; }
};

struct Ray {
  V start, d;
  double tilt_deg;
  bool travels;
};

// Of all tilts from 0 to 80 degrees and both senses, to places on and beyond the data, to vertices, and to middles of edges.
std::vector<Ray> rays_to(const Mesh& mesh) {
  Uniform u(31);
  std::vector<Ray> rays;
  const auto vertex = [&](std::uint32_t v) { return mesh.vertices[v]; };
  const auto any_of = [&](std::uint32_t count) { return static_cast<std::uint32_t>(u() * count); };
  for (int i = 0; i < ray_count; ++i) {
    const double tilt_deg = i % 4 == 0 ? 0 : 80 * u(), tilt = tilt_deg * std::numbers::pi / 180, azimuth = u(0, 2 * std::numbers::pi);
    V d{std::sin(tilt) * std::cos(azimuth), std::sin(tilt) * std::sin(azimuth), std::cos(tilt)};
    if (i % 3 == 0) d = -d;
    const auto corners = mesh.corners[any_of(mesh.facet_count)];
    V target{u(-5.2, 5.2), u(-5.2, 5.2), 1};
    if (i % 10 == 1) target = vertex(corners[0]);
    if (i % 10 == 2) target = 0.5 * (vertex(corners[1]) + vertex(corners[2]));
    rays.push_back({target - u(-20, 20) * d, d, tilt_deg, i % 17 != 5});
    if (!rays.back().travels) rays.back().d = i % 2 == 0 ? V{std::numeric_limits<double>::quiet_NaN(), 0, 0} : V{0, 0, 0};
  }
  return rays;
}

// take(lines, the first one's number), block by block, of all sizes up to the full one.
template <class Take>
void for_each_block(const std::vector<Ray>& rays, const Take& take) {
  const auto lines = std::make_unique<BlockOfLines>();
  std::size_t size = block_capacity;
  for (std::size_t from = 0; from < rays.size(); from += static_cast<std::size_t>(lines->count), size = size == 1 ? block_capacity : size - 1) {
    lines->count = static_cast<int>(std::min(size, rays.size() - from));
    for (int i = 0; i < lines->count; ++i) {
      const Ray& ray = rays[from + static_cast<std::size_t>(i)];
      lines->x[i] = ray.start.x, lines->y[i] = ray.start.y, lines->z[i] = ray.start.z;
      lines->l[i] = ray.d.x, lines->m[i] = ray.d.y, lines->n[i] = ray.d.z;
      lines->travels[i] = ray.travels;
    }
    take(*lines, from);
  }
}

struct Counts {
  int hits = 0, outside = 0, waiting = 0, different = 0;
};
template <class Shape>
Counts compare(const Shape& shape, const std::vector<Ray>& rays) {
  Counts counts;
  const auto crossings = std::make_unique<BlockOfCrossings>();
  for_each_block(rays, [&](const BlockOfLines& lines, std::size_t from) {
    shape.meet_block(lines, *crossings);
    for (int i = 0; i < lines.count; ++i) {
      const Ray& ray = rays[from + static_cast<std::size_t>(i)];
      if (!ray.travels) {
        ++counts.waiting;
        continue;
      }
      const Crossing<double> alone = shape.meet(ray.start, ray.d);
      const BlockOfCrossings& of = *crossings;
      bool same = of.status[i] == static_cast<std::int32_t>(alone.status);
      ++(alone.status == Status::ok ? counts.hits : counts.outside);
      const auto agree = [](double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); };
      if (alone.status == Status::ok)
        same = same && agree(of.path[i], alone.path) && agree(of.x[i], alone.point.x) && agree(of.y[i], alone.point.y) &&
               agree(of.z[i], alone.point.z) && agree(-of.slope_x[i], alone.normal.x) && agree(-of.slope_y[i], alone.normal.y);
      if (!same && counts.different++ < 5)
        ADD_FAILURE() << "ray " << from + static_cast<std::size_t>(i) << ", tilt " << ray.tilt_deg << ": status " << of.status[i] << " in the block, "
                      << static_cast<int>(alone.status) << " alone; paths " << of.path[i] << ", " << alone.path;
    }
  });
  return counts;
}

TEST(Blocks, HaveTheSameBitsAsLineByLine) {
  for (const Layout& layout : all_layouts(900)) {
    SCOPED_TRACE(layout.name);
    const Surfaces surfaces(layout);
    const std::vector<Ray> rays = rays_to(surfaces.mesh->mesh);
    for (const Counts& counts : {compare(surfaces.linear(), rays), compare(surfaces.c1(), rays)}) {
      EXPECT_EQ(counts.different, 0);
      EXPECT_EQ(counts.hits + counts.outside + counts.waiting, ray_count);
      EXPECT_GT(counts.hits, ray_count / 2);
      EXPECT_GT(counts.outside, ray_count / 50);
      EXPECT_GT(counts.waiting, ray_count / 20);
    }
  }
}

// What Zernike::from asks of parameters.
struct GivenZernike {
  double radius, conic_constant;
  std::vector<std::pair<int, double>> coefficients;
  double number(std::string_view key) const { return key == "radius_mm" ? radius : key == "conic_constant" ? conic_constant : 3; }
  const std::string& text(std::string_view) const {
    static const std::string osa = "osa";
    return osa;
  }
  const std::vector<std::pair<int, double>>& list(std::string_view) const { return coefficients; }
};

// On spheres, planes, hyperboloids; without a term, as polynomials, by the recurrence; mild ones and such that Newton's
// method strays on. Rays come from all sides, so that many miss the conic.
TEST(Blocks, HaveTheSameBitsAsLineByLineOnZernikeSurfaces) {
  const auto given = [](double radius, double conic_constant, int term_count, double um) {
    GivenZernike zernike{radius, conic_constant, {}};
    for (int j = 0; j < term_count; ++j) zernike.coefficients.push_back({j, (j % 3 == 0 ? um : -um) / (1 + j)});
    return zernike;
  };
  const std::vector<Ray> rays = rays_to(Surfaces(all_layouts(900).front()).mesh->mesh);
  for (const GivenZernike& zernike : {given(12, 0, 0, 0), given(7.8, -0.26, 36, 5), given(INFINITY, 0, 91, 3), given(-9, -1, 120, 2),
                                      given(5, -2.5, 66, 200), given(4, 3, 28, 1000)}) {
    numerics::Arena arena;
    const Zernike shape = Zernike::from(zernike, arena);
    EXPECT_EQ(shape.is_polynomial, zernike.coefficients.size() <= 91);
    const Counts counts = compare(shape, rays);
    EXPECT_EQ(counts.different, 0) << zernike.radius;
    EXPECT_GT(counts.hits, ray_count / 20) << zernike.radius;  // that of 4 mm ends at 2 mm from its axis
  }
}

// Those that the vectors leave, to be met one by one, cost several times as much: they may be few. A line is left where the
// flat hit and the hit on the patch lie on two facets or in two thirds of one, or where an edge is nearer than rounding,
// as it is for the rays that are aimed at vertices and edges, which do not count here.
TEST(Blocks, SettleNearlyAllLinesOfSmallTiltInVectors) {
  for (const Layout& layout : all_layouts(900)) {
    SCOPED_TRACE(layout.name);
    const Surfaces surfaces(layout);
    const std::vector<Ray> rays = rays_to(surfaces.mesh->mesh);
    const auto crossings = std::make_unique<BlockOfCrossings>();
    const auto flat = std::make_unique<FacetsOfBlock>();
    int small = 0, small_settled = 0;
    for_each_block(rays, [&](const BlockOfLines& lines, std::size_t from) {
      surfaces.linear().meet_block(lines, *crossings, *flat);
      bool settled[block_capacity];
      meet_patches(surfaces.patches.data(), lines, *flat, *crossings, settled);
      for (int i = 0; i < lines.count; ++i) {
        const std::size_t ray = from + static_cast<std::size_t>(i);
        if (flat->facet[i] == no_facet || ray % 10 == 1 || ray % 10 == 2 || rays[ray].tilt_deg > 20) continue;
        ++small;
        small_settled += settled[i];
      }
    });
    EXPECT_GT(small, ray_count / 10);
    EXPECT_GT(small_settled, 0.97 * small) << small_settled << " of " << small;
  }
}

}  // namespace
}  // namespace sagitta::surface
