// SPDX-License-Identifier: Apache-2.0
// OpticStudio's own output for systems/biconic-test-eye.yaml (../shared/data/opticstudio, whose README says whose it is): rays, the wavefront and its
// Zernike coefficients. Its z are relative to the stop, its maps begin with the most negative y, and their points stand at (i - 64)/63 of the pupil,
// whatever their labels say.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <numbers>
#include <sstream>

#include "lib/analysis/wavefront.h"
#include "tests/support/prescriptions.h"

namespace sagitta::test {
namespace {

struct OpticStudio : ::testing::Test {
  CompiledScene eye = checked(scene::compile(*prescription::read_prescription(SAGITTA_SOURCE_DIR "/systems/biconic-test-eye.yaml").model));

  static std::string folder() {
    const char* given = std::getenv("SAGITTA_SHARED");
    return (given ? std::string(given) : std::string(SAGITTA_SOURCE_DIR "/../shared")) + "/data/opticstudio/";
  }
  void SetUp() override {
    if (!std::filesystem::exists(folder())) GTEST_SKIP() << "no folder ../shared/data/opticstudio (or $SAGITTA_SHARED)";
  }
  // The rows after the first; quoted commas are no separators.
  static std::vector<std::vector<std::string>> rows(const std::string& name) {
    std::ifstream file(folder() + name);
    std::vector<std::vector<std::string>> result;
    std::string line;
    std::getline(file, line);
    while (std::getline(file, line)) {
      auto& cells = result.emplace_back(1);
      bool is_quoted = false;
      for (const char c : line) {
        if (c == '"') is_quoted = !is_quoted;
        else if (c == ',' && !is_quoted) cells.emplace_back();
        else if (c != '\r') cells.back() += c;
      }
    }
    return result;
  }
  static double number_of(const std::vector<std::string>& cells, std::size_t column) {
    return cells.at(column).empty() ? std::numeric_limits<double>::quiet_NaN() : std::stod(cells[column]);
  }
  static scene::Field field_of(double x_deg, double y_deg) {
    return {.x = std::tan(x_deg * std::numbers::pi / 180), .y = std::tan(y_deg * std::numbers::pi / 180)};
  }
  const scene::Wavelength& wavelength() const { return eye.scene.wavelengths.front(); }

  // Every ray of a file at every surface, to 1e-8 mm: 11 digits are printed of up to 20 mm, 5e-10 mm.
  void expect_rays(const std::string& name, trace::PupilPoint point) {
    int rays = 0, points = 0;
    const double stop_z = eye.scene.surface(eye.scene.stop).axis_z;
    const auto listed = rows(name);
    ASSERT_EQ(listed.size(), 25u * 7u);
    for (std::size_t row = 0; row < listed.size(); row += 7) {
      double x = 0, y = 0;
      ASSERT_EQ(std::sscanf(listed[row][2].c_str(), "(%lf, %lf)", &x, &y), 2);
      trace::SurfaceBySurface by_surface(eye.scene, wavelength(), launch(eye.scene, field_of(x, y), wavelength().index.front(), std::vector{point}));
      for (int number = 1; number <= 6; ++number) {
        const trace::RayBatch& batch = by_surface.next();
        ASSERT_EQ(batch.status(0), surface::Status::ok) << listed[row][2] << " at surface " << number;
        const auto at = trace::global_position(eye.scene, number, batch, 0);
        const auto& cells = listed[row + static_cast<std::size_t>(number)];
        EXPECT_NEAR(at.x, number_of(cells, 6), 1e-8) << listed[row][2] << " at surface " << number;
        EXPECT_NEAR(at.y, number_of(cells, 7), 1e-8) << listed[row][2] << " at surface " << number;
        EXPECT_NEAR(at.z - stop_z, number_of(cells, 8), 1e-8) << listed[row][2] << " at surface " << number;
        ++points;
      }
      ++rays;
    }
    EXPECT_EQ(rays, 25);
    EXPECT_EQ(points, 150);
  }
  // Noll's terms in um, to 1e-7 um: its samples are not known.
  void expect_zernikes(const std::string& name, double x_deg, double y_deg) {
    const auto result = analysis::wavefront(eye.scene, wavelength(), field_of(x_deg, y_deg), {.size = 64, .zernike_terms = 45, .indexing = numerics::ZernikeIndexing::noll});
    ASSERT_TRUE(result.wavefront && result.wavefront->zernike) << result.reason;
    const auto listed = rows(name);
    ASSERT_EQ(listed.size(), 45u);
    for (std::size_t j = 0; j < listed.size(); ++j) EXPECT_NEAR(result.wavefront->zernike->coefficients[j], number_of(listed[j], 2), 1e-7) << "Z" << j + 1;
  }
};

TEST_F(OpticStudio, has_the_same_chief_rays) { expect_rays("ray_trace_pupil_0_0.csv", {0, 0}); }
TEST_F(OpticStudio, has_the_same_rays_through_the_rim) { expect_rays("ray_trace_pupil_0_1.csv", {0, 1}); }
TEST_F(OpticStudio, has_the_same_zernikes_on_axis) { expect_zernikes("zernike_coefficients_0_0.csv", 0, 0); }
TEST_F(OpticStudio, has_the_same_zernikes_off_axis) { expect_zernikes("zernike_coefficients_0_10.csv", 0, 10); }

TEST_F(OpticStudio, has_the_same_wavefront) {
  const auto result = analysis::wavefront(eye.scene, wavelength(), field_of(0, 0), {.size = 128});
  ASSERT_TRUE(result.wavefront) << result.reason;
  const auto listed = rows("opd_map_0_0.csv");
  ASSERT_EQ(listed.size(), 128u);
  int both = 0, ours_alone = 0;
  for (std::size_t row = 0; row < 128; ++row)
    for (std::size_t column = 0; column < 128; ++column) {
      const double ours = result.wavefront->opd_waves[(127 - row) * 128 + column], theirs = number_of(listed[row], column + 1);
      const double i = static_cast<double>(column) - 64, j = static_cast<double>(row) - 64;
      if (std::isnan(theirs)) {  // it leaves out some of the points within half a step of the rim
        ours_alone += !std::isnan(ours);
        EXPECT_TRUE(std::isnan(ours) || std::hypot(i, j) > 62.5) << row << ' ' << column;
        continue;
      }
      // three paths of some 40 mm in double, 4 eps of them each, are 1e-13 mm, 2e-10 waves, in its program and in ours
      ASSERT_NEAR(ours, theirs, 1e-9) << row << ' ' << column;
      ++both;
    }
  EXPECT_GT(both, 12000);
  EXPECT_LT(ours_alone, 120);
}

}  // namespace
}  // namespace sagitta::test
