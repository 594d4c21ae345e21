// SPDX-License-Identifier: Apache-2.0
#include "lib/analysis/difference.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/support/prescriptions.h"

namespace sagitta::analysis {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr auto outside = outside_pupil;

Wavefront wavefront_of(std::vector<double> opd, std::vector<double> coefficients = {}) {
  Wavefront result;
  result.size = 3;
  result.opd_waves = std::move(opd);
  result.mask = {outside, 0, outside, 0, 0, 0, outside, 0, outside};
  if (!coefficients.empty()) result.zernike = ZernikeFit{numerics::ZernikeIndexing::osa, std::move(coefficients), 0};
  return result;
}

TEST(Difference, is_over_the_samples_that_both_have) {
  const Wavefront first = wavefront_of({nan, 1, nan, 2, nan, 4, nan, nan, nan}, {1, 2, 3});
  const Wavefront other = wavefront_of({nan, 4, nan, 1, 5, nan, nan, nan, nan}, {1, 4, 2.5});
  const WavefrontDifference d = wavefront_difference(other, first);
  EXPECT_EQ(d.in_both, 2);  // 3 and -1
  EXPECT_EQ(d.only_in_first, 1);
  EXPECT_EQ(d.only_in_other, 1);
  EXPECT_EQ(d.mean_waves, 1);
  EXPECT_EQ(d.rms_waves, 2);
  EXPECT_EQ(d.peak_to_valley_waves, 4);
  EXPECT_EQ(d.opd_waves[1], 3);
  EXPECT_EQ(d.opd_waves[3], -1);
  for (const std::size_t i : {0, 2, 4, 5, 6, 7, 8}) EXPECT_TRUE(std::isnan(d.opd_waves[i])) << i;
  EXPECT_EQ(d.mask, (std::vector<std::uint32_t>{outside, 0, outside, 0, 2, 1, outside, 3, outside}));
  EXPECT_EQ(d.zernike_um, (std::vector<double>{0, 2, -0.5}));
}

// Two samples: a tilt takes all. Elsewhere a tilted plane with x^2 - y^2, which has neither piston nor tilt on the disc's grid.
TEST(Difference, without_tilt_is_what_no_plane_takes) {
  const Wavefront zero = wavefront_of({nan, 0, nan, 0, nan, 0, nan, nan, nan}), two = wavefront_of({nan, 3, nan, 7, nan, nan, nan, nan, nan});
  // two roundings of OPDs up to 7, half of 2^-50 each
  EXPECT_NEAR(wavefront_difference(two, zero).rms_without_tilt_waves, 0, 1e-15);
  EXPECT_EQ(wavefront_difference(two, zero).rms_waves, 2);
  constexpr int size = 16;
  Wavefront first, other;
  first.size = other.size = size;
  double squares = 0;
  int count = 0;
  for (int row = 0; row < size; ++row)
    for (int column = 0; column < size; ++column) {
      const double x = (column - 7.5) / 8, y = (7.5 - row) / 8;
      const bool inside = x * x + y * y <= 1;
      first.mask.push_back(inside ? 0 : outside);
      first.opd_waves.push_back(inside ? std::sin(5 * x + y) : nan);
      other.opd_waves.push_back(first.opd_waves.back() + 0.25 + 10 * x - 4 * y + 0.1 * (x * x - y * y));
      if (inside) squares += 0.01 * (x * x - y * y) * (x * x - y * y), ++count;
    }
  other.mask = first.mask;
  const WavefrontDifference d = wavefront_difference(other, first);
  EXPECT_GT(d.rms_waves, 5);
  // Roundings of OPDs up to 11, some ten of them: 10 * 11 * 2^-53.
  EXPECT_NEAR(d.rms_without_tilt_waves, std::sqrt(squares / count), 2e-14);
  EXPECT_NEAR(d.without_tilt_waves[8], 0.1 * (0.0625 * 0.0625 - 0.9375 * 0.9375), 2e-14);
  EXPECT_TRUE(std::isnan(d.without_tilt_waves[0]));
  // over a part where 1, x and y are far from orthogonal, a plane still goes as a whole
  for (std::size_t i = 0; i < other.opd_waves.size(); ++i) {
    const double x = (static_cast<double>(i % size) - 7.5) / 8, y = (7.5 - static_cast<double>(i / size)) / 8;
    other.opd_waves[i] = x + 0.5 * y < -0.1 ? first.opd_waves[i] + 0.25 + 10 * x - 4 * y : nan;
  }
  EXPECT_GT(wavefront_difference(other, first).rms_waves, 1);
  EXPECT_NEAR(wavefront_difference(other, first).rms_without_tilt_waves, 0, 2e-14);
}

TEST(Difference, does_not_exist_where_no_sample_is_in_both) {
  const WavefrontDifference d = wavefront_difference(wavefront_of({nan, 4, nan, nan, nan, nan, nan, nan, nan}),
                                                     wavefront_of({nan, nan, nan, 1, nan, nan, nan, nan, nan}));
  EXPECT_EQ(d.in_both, 0);
  EXPECT_TRUE(std::isnan(d.rms_waves));
  EXPECT_TRUE(std::isnan(d.rms_without_tilt_waves));
  EXPECT_TRUE(std::isnan(d.peak_to_valley_waves));
  EXPECT_TRUE(d.zernike_um.empty());
}

TEST(Difference, of_spots_is_in_mm_and_in_percent_of_the_first) {
  Spot first, other;
  first.rms_radius = 0.5, first.centroid_x = 1, first.centroid_y = 2;
  other.rms_radius = 0.25, other.centroid_x = 1.5, other.centroid_y = 0;
  const SpotDifference d = spot_difference(other, first);
  EXPECT_EQ(d.rms_radius, -0.25);
  EXPECT_EQ(d.rms_radius_percent, -50);
  EXPECT_EQ(d.centroid_shift, (std::array<double, 2>{0.5, -2}));
  first.rms_radius = 0;
  EXPECT_TRUE(std::isnan(spot_difference(other, first).rms_radius_percent));
}

TEST(Jobs, of_several_scenes_have_one_scale_and_the_results_of_each_alone) {
  const auto lens = [](const std::string& radius) {
    return test::scene_of("  - {stop: true, conic: {radius_mm: " + radius + "}, thickness_mm: 100, medium: {index: 1.5}}\n  - {}\n",
                          "entrance_pupil_diameter_mm: 8", "fields: {angles_deg: [[0, 0], [0, 3]]}\n").scene;
  };
  const std::vector<scene::Scene> scenes{lens("33"), lens("20")};  // in focus near 99 and 60 mm
  JobRequest request;
  request.ray_count = 500;
  const auto together = run_jobs(scenes, request);
  ASSERT_EQ(together.size(), 2u);
  double widest = 0;
  for (std::size_t i = 0; i < 2; ++i) {
    const auto alone = run_job(scenes[i], request);
    ASSERT_EQ(together[i].size(), 2u);
    for (std::size_t k = 0; k < 2; ++k) {
      EXPECT_EQ(together[i][k].field, k);
      EXPECT_EQ(together[i][k].spot->rms_radius, alone[k].spot->rms_radius);
      EXPECT_EQ(together[i][k].wavefront->wavefront->rms_waves, alone[k].wavefront->wavefront->rms_waves);
      EXPECT_EQ(together[i][k].spot_image->pixel_mm, together[0][0].spot_image->pixel_mm);
      widest = std::max(widest, alone[k].spot_image->pixel_mm);
    }
  }
  EXPECT_EQ(together[0][0].spot_image->pixel_mm, widest);
  EXPECT_GT(widest, run_job(scenes[0], request)[0].spot_image->pixel_mm);
}

}  // namespace
}  // namespace sagitta::analysis
