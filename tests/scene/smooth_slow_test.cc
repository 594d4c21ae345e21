// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>

#include "lib/scene/triangulate_smoothed.h"
#include "tests/support/point_sets.h"

namespace sagitta::scene {
namespace {

using namespace tests;

TEST(SmoothingOfManyPoints, meets_its_rms_and_tells_its_time) {
  for (const auto& [name, places] : {Layout{"uniform random", uniform_random(100000, 4, 5)}, Layout{"400 rings x 250 meridians", polar_rings(400, 250, 4, false)}}) {
    PointCloud cloud = cloud_of(places, sphere(7.8));
    Uniform u(8);
    for (auto& p : cloud.points) p.z += u(-4e-4, 4e-4);
    const auto start = std::chrono::steady_clock::now();
    const auto result = triangulate_smoothed(std::make_shared<PointCloud>(cloud), 1, 2.2e-4);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    ASSERT_TRUE(result.smoothing) << name;
    EXPECT_NEAR(result.smoothing->residual_rms, 2.2e-4, 1e-9) << name;
    std::printf("[ report   ] smoothing of 1e5 points, %s: %.1f s\n", name.c_str(), seconds);
  }
}

TEST(SmoothingOfManyPoints, is_refused_beyond_a_million) {
  const auto result = triangulate_smoothed(std::make_shared<PointCloud>(cloud_of(regular_grid(1001, 1001, 4, 4), sphere(30))), 1, 1e-3);
  EXPECT_FALSE(result.triangulation.mesh);
  EXPECT_FALSE(result.smoothing);
  ASSERT_EQ(result.triangulation.findings.error_count(), 1);
  EXPECT_EQ(format(result.triangulation.findings.all().front()),
            "points.xyz:1:1: error: 1002001 points: at most 1000000 can be smoothed\n  hint: leave out smoothing_um, or points");
}

}  // namespace
}  // namespace sagitta::scene
