// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "lib/study/errors.h"

namespace sagitta::study {
namespace {

using Long = long double;

// Ray 0: 3 um off in x and 4 um in z, turned by 1 minute of arc; ray 1: right; ray 2: lost in the variant; 3: in the truth; 4: in both.
class ErrorsByHand : public testing::Test {
 protected:
  ErrorsByHand() : variant(5), truth(5) {
    const Long minute = std::acos(Long(-1)) / (60 * 180);
    for (std::size_t i = 0; i < 5; ++i) {
      variant.set(i, {static_cast<double>(i), 0, 1}, {0, 0, 1}, 0);
      truth[i] = {{static_cast<Long>(i), 0, 1}, {0, 0, 1}, 0};
    }
    truth[0].position = {.003L, 0, 1.004L};
    truth[0].direction = {0, std::sin(minute), std::cos(minute)};
    variant.ended[2] = variant.ended[4] = trace::ending(1, surface::Status::outside_data);
    truth[3].ended = truth[4].ended = trace::ending(1, surface::Status::missed);
  }
  trace::RayBatch variant;
  std::vector<TrueRay> truth;
};

TEST_F(ErrorsByHand, AreDistancesAndAnglesOfTheRaysThatBothFind) {
  const SurfaceErrors errors = surface_errors(variant, truth);
  EXPECT_NEAR(errors.distance_um.mean, 2.5, 1e-12);
  EXPECT_NEAR(errors.distance_um.rms, 5 / std::sqrt(2), 1e-12);
  EXPECT_NEAR(errors.distance_um.max, 5, 1e-12);
  EXPECT_NEAR(errors.angle_arcmin.mean, .5, 1e-14);
  EXPECT_NEAR(errors.angle_arcmin.rms, 1 / std::sqrt(2), 1e-14);
  EXPECT_NEAR(errors.angle_arcmin.max, 1, 1e-14);
  EXPECT_EQ(errors.found.by_both, 2);
  EXPECT_EQ(errors.found.by_truth_only, 1);
  EXPECT_EQ(errors.found.by_variant_only, 1);
  EXPECT_EQ(errors.found.by_neither, 1);
  EXPECT_EQ(errors.found.by_one_only(), 2);
}

TEST_F(ErrorsByHand, OfSpotsAreOfTheSameRaysAboutTheirOwnCentroids) {
  // Rays 0 and 1 stand at x = 0 and 1 mm: an rms radius of 500 um; the true ones at .003 and 1 mm: 498.5 um.
  const SpotErrors errors = spot_errors(variant, truth);
  EXPECT_NEAR(errors.rms_radius_um, 500, 1e-10);
  EXPECT_NEAR(errors.true_rms_radius_um, 498.5, 1e-10);
  EXPECT_NEAR(errors.rms_radius_percent, 100 * 1.5 / 498.5, 1e-10);
  EXPECT_EQ(errors.found.by_both, 2);
}

TEST_F(ErrorsByHand, OfNoRayAreNoNumbers) {
  for (auto& ended : variant.ended) ended = trace::ending(1, surface::Status::missed);
  const SurfaceErrors errors = surface_errors(variant, truth);
  EXPECT_TRUE(std::isnan(errors.distance_um.mean) && std::isnan(errors.angle_arcmin.max));
  EXPECT_EQ(errors.found.by_truth_only, 3);
  EXPECT_TRUE(std::isnan(spot_errors(variant, truth).rms_radius_percent));
}

}  // namespace
}  // namespace sagitta::study
