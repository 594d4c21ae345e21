// SPDX-License-Identifier: Apache-2.0
#include "lib/scene/rings.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <set>

#include "lib/scene/triangulate.h"
#include "tests/support/point_sets.h"

namespace sagitta::scene {
namespace {

using namespace sagitta::tests;

// Against all edges of all facets: on the rim, around a hole and inside, each neighbour once.
TEST(Neighbours, are_the_other_ends_of_all_edges) {
  const auto with_a_hole = [](double x, double y) { return x * x + y * y < 0.5 ? std::numeric_limits<double>::quiet_NaN() : sphere(12)(x, y); };
  for (const Layout& layout : all_layouts(900)) {
    const auto storage = triangulate(cloud_of(layout.places, with_a_hole)).mesh;
    std::vector<std::set<std::uint32_t>> expected(storage->mesh.vertex_count);
    for (const surface::Corners& corners : storage->corners)
      for (const std::uint32_t a : corners)
        for (const std::uint32_t b : corners)
          if (a != b) expected[a].insert(b);
    const Neighbours neighbours(storage->mesh);
    int on_rim = 0;
    for (std::uint32_t v = 0; v < expected.size(); ++v) {
      const auto of = neighbours.of(v);
      std::vector<std::uint32_t> sorted(of.begin(), of.end());
      std::sort(sorted.begin(), sorted.end());
      EXPECT_TRUE(std::equal(sorted.begin(), sorted.end(), expected[v].begin(), expected[v].end())) << layout.name << ' ' << v;
      on_rim += neighbours.is_on_rim(v);
    }
    EXPECT_GT(on_rim, 30) << layout.name;
  }
}

}  // namespace
}  // namespace sagitta::scene
