// SPDX-License-Identifier: Apache-2.0
// Every shape with a formula, and heights on a grid, through the commands that look into surfaces: `explain`, `verify`, `study` of the surface (as it is, and triangulated)
// and of the system.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <ostream>
#include <set>
#include <string>
#include <string_view>

#include "lib/prescription/reader.h"
#include "lib/study/settled.h"
#include "lib/surface/shapes.h"
#include "tests/support/compared.h"

namespace sagitta::test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::StartsWith;

struct OfShape {
  const char *name, *yaml, *kernel;
  friend void PrintTo(const OfShape& of, std::ostream* out) { *out << of.name; }  // its bytes are addresses
};
constexpr OfShape shapes[]{
    {"plane", "plane: {}", "plane"},
    {"sphere", "conic: {radius_mm: 8}", "sphere"},
    {"conic", "conic: {radius_mm: 8, conic_constant: -0.3}", "conic"},
    {"zernike", "zernike: {radius_mm: 8, normalization_radius_mm: 2, indexing: osa, coefficients_um: {5: 4, 7: 2, 12: -1}}", "Zernike polynomial"},
    {"asphere", "asphere: {radius_mm: 8, conic_constant: -0.3, coefficients: {4: 1e-4, 5: -2e-5}}", "asphere"},
    {"biconic", "biconic: {radius_x_mm: 8, radius_y_mm: 7.6, conic_constant_x: -0.3, conic_constant_y: 0.2}", "biconic"},
    {"toroid", "toroid: {radius_rotation_mm: 8, radius_mm: 7.6, coefficients: {4: 1e-4}}", "toroid"},
    {"xy_polynomial", "xy_polynomial: {radius_mm: 8, normalization_radius_mm: 2, coefficients: {4: 1e-3, 9: 2e-4}}", "polynomial in x and y"},
    {"grid", "grid: {points: heights.dat, radius_mm: 8}", "bicubic grid of 17 x 17, slopes by differences"}};

class EveryShape : public testing::TestWithParam<OfShape> {
 protected:
  EveryShape() {
    std::string heights = "17 17 0.25 0.25 0 0 0\n";
    for (int j = 8; j >= -8; --j)
      for (int i = -8; i <= 8; ++i) heights += fmt::format("{}\n", 0.01 * std::sin(0.25 * i) * std::cos(0.2 * j));
    folder_.file("heights.dat", heights);
    system_ = folder_.file("system.yaml", std::string("sagitta: 1\nname: One\nwavelengths_nm: [550]\naperture: {entrance_pupil_diameter_mm: 3}\nfields: {angles_deg: [[0, 3]]}\nsurfaces:\n") +
                                              "  - {name: front, stop: true, " + GetParam().yaml + ", thickness_mm: 20, medium: {index: 1.5}}\n  - {name: image}\n");
  }
  bool is_plane() const { return std::string_view(GetParam().name) == "plane"; }

  const Folder folder_;
  std::string system_;
};

TEST_P(EveryShape, is_explained) {
  const Outcome run = run_program("explain " + system_ + " --json");
  ASSERT_EQ(run.status, 0) << run.err;
  const json surface = json::parse(run.out)["plan"]["surfaces"][0];
  EXPECT_THAT(surface["kernel"].get<std::string>(), StartsWith(GetParam().kernel));
  EXPECT_GE(surface["operations_per_ray"]["additions_and_multiplications"], 20);  // refraction alone has as many
  EXPECT_EQ(surface["operations_per_ray"]["roots"].get<int>() >= 2, !is_plane());  // refraction has one, and all these meet a conic or a quadric
  EXPECT_EQ(surface["data_bytes"].get<int>() > 17 * 17 * 32, std::string_view(GetParam().name) == "grid") << surface["data_bytes"];  // four numbers a node
}

TEST_P(EveryShape, is_verified) {
  const Outcome run = run_program("verify " + system_ + " --json");
  ASSERT_EQ(run.status, 0) << run.err;
  const json verified = json::parse(run.out);
  EXPECT_EQ(verified["good"], true);
  const json& surface = verified["surfaces"][1];
  EXPECT_EQ(surface["name"], "front");
  EXPECT_EQ(surface["without_bound"], 0);
  EXPECT_EQ(surface["own_position_mm"]["count"], verified["rays"]);
  EXPECT_GT(surface["own_direction_rad"]["worst"].get<double>(), 0);  // as nothing that is compared with itself
  EXPECT_GT(surface["of_bound"].get<double>(), 0);
  EXPECT_LE(surface["of_bound"].get<double>(), 1);
}

// Flat facets between points that are so near are off by h^2: with four times the points by a quarter, to 11 % for five standard errors of 1000 rays whose errors have half
// their mean as deviation (0.32 of it where the curvature is the same all over: u (1 - u) + v (1 - v) has 1/3 as mean and 1/90 as variance).
TEST_P(EveryShape, is_studied_as_it_is_and_triangulated) {
  const std::string study = folder_.file("study.yaml", "sagitta_study: 1\nname: one\nsystem: system.yaml\nsurface: front\nvariants:\n"
                                                       "  - {interpolation: [linear, c1], points_per_mm2: [100, 400], rays: 1000}\n  - {interpolation: analytic, rays: 1000}\n");
  const Outcome run = run_program("study " + study + " -o " + folder_.path("out"));
  ASSERT_EQ(run.status, 0) << run.err;
  const json rows = json::parse(read_text(folder_.path("out/study.json")))["rows"];
  ASSERT_EQ(rows.size(), 5u);
  const auto off = [&](std::size_t row) { return rows[row]["distance_mean_um"].get<double>(); };
  for (const json& row : rows) EXPECT_EQ(row["only_one_finds"], 0) << row["variant"];
  EXPECT_LT(off(4), 1e3 * 20 * 2.2e-16 * 30);  // rounding: 30 ulp of the system's size
  if (is_plane()) {
    for (std::size_t row = 0; row < 4; ++row) EXPECT_LT(off(row), 1e3 * 20 * 2.2e-16 * 30);
    return;
  }
  EXPECT_NEAR(off(0) / off(1), 4, .44);
  EXPECT_LT(off(2), off(0) / 10);
  EXPECT_LT(off(3), off(2) / 4);  // third order at least
}

TEST_P(EveryShape, is_sampled_as_a_system) {
  const auto read = prescription::read_prescription(system_);
  ASSERT_TRUE(read.model);
  study::SamplingRequest request;
  request.most_rays = 1000;
  request.most_grid = 24;
  const study::Sampling sampling = study::sample_system(*read.model, request, [](double) {});
  ASSERT_FALSE(sampling.spots.empty() || sampling.spots.front().empty() || sampling.wavefronts.empty());
  EXPECT_EQ(sampling.spots.front().front().answers.front().no_spot, "");
  EXPECT_EQ(sampling.spots.front().back().answers.front().arrived, sampling.spots.front().back().answers.front().launched);
  std::set<study::Quantity> told;
  for (const study::Curve& curve : study::curves_of(sampling)) told.insert(curve.quantity);
  EXPECT_EQ(told.contains(study::Quantity::spot_rms), true);
  EXPECT_EQ(told.contains(study::Quantity::wavefront_rms), !is_plane());  // behind it light is parallel: no reference sphere
}

INSTANTIATE_TEST_SUITE_P(Shapes, EveryShape, testing::ValuesIn(shapes), [](const auto& of) { return of.param.name; });

// Those above, facets and four kinds of patches, which clouds of points have tests of their own for.
TEST(EveryShape, IsAmongThem) { EXPECT_EQ(std::size(shapes) + 5, std::variant_size_v<surface::Shape>); }

}  // namespace
}  // namespace sagitta::test
