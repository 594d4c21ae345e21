// SPDX-License-Identifier: Apache-2.0
// One irregular cornea given twice: by Zernike terms, and by points with flat facets between them; and real exports.
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "tests/support/prescriptions.h"

namespace sagitta::test {
namespace {

using nlohmann::json;

json summary(const std::string& system, const std::string& options) {
  const Folder folder;
  const Outcome run = run_program("trace " + system + " -o " + folder.path("out") + " --json " + options);
  EXPECT_EQ(run.status, 0) << run.err;
  return json::parse(run.out);
}

int total(const json& rays) {
  int sum = 0;
  for (const char* status : {"ok", "missed", "clipped", "total_reflection", "outside_data", "not_converged"}) sum += rays[status].get<int>();
  return sum;
}

CompiledScene shipped(const std::string& name) {
  const auto read = prescription::read_prescription(SAGITTA_SOURCE_DIR "/systems/" + name);
  EXPECT_TRUE(read.model) << name;
  return checked(scene::compile(*read.model));
}

// A linear interpolant is off by at most kappa c^2/2, kappa the largest curvature of the sag and c the circumradius of its
// facet. Points on rings a apart and b along a ring lie on isosceles trapezoids, whose circle has c^2 <= (a^2 + b^2)/4, up
// to the slant of their legs (1 % here); so h^2/8 kappa, h the diagonal. Inside the first ring, which has no apex, c is the
// ring's radius.
TEST(Cornea, facets_differ_from_the_surface_by_no_more_than_their_size_allows) {
  const CompiledScene zernike = shipped("cornea-zernike.yaml"), delaunay = shipped("cornea-delaunay.yaml");
  const auto& surface = std::get<surface::Zernike>(zernike.scene.surface(1).shape);
  const auto& facets = std::get<surface::Facets>(delaunay.scene.surface(1).shape);
  const auto second_derivative = [&](double x, double y) {  // the larger one
    const double h = 1e-4;
    const auto slope = [&](double u, double v) { return surface.gradient(u, v); };
    const double xx = (slope(x + h, y).x - slope(x - h, y).x) / (2 * h), yy = (slope(x, y + h).y - slope(x, y - h).y) / (2 * h),
                 xy = (slope(x, y + h).x - slope(x, y - h).x) / (2 * h);
    return (xx + yy) / 2 + std::hypot((xx - yy) / 2, xy);
  };
  constexpr double ring = 0.15, pupil = 2;
  double kappa = 0;
  for (int i = -25; i <= 25; ++i)
    for (int j = -25; j <= 25; ++j)
      if (i * i + j * j <= 625) kappa = std::max(kappa, second_derivative(0.09 * i, 0.09 * j));
  double worst = 0, squares = 0;
  int count = 0;
  for (int i = -200; i <= 200; ++i)
    for (int j = -200; j <= 200; ++j) {
      const double x = 0.01 * i + 1e-3, y = 0.01 * j - 7e-4, r = std::hypot(x, y);
      if (r > pupil) continue;
      const double difference = facets.sag(x, y) - surface.sag(x, y), outer = (std::floor(r / ring) + 1) * ring, chord = outer * 2 * std::acos(-1.0) / 180;
      const double bound = r < ring ? kappa * ring * ring / 2 : 1.01 * kappa * (ring * ring + chord * chord) / 8;
      ASSERT_LE(std::abs(difference), bound) << x << ' ' << y;
      worst = std::max(worst, std::abs(difference));
      squares += difference * difference;
      ++count;
    }
  const double rms_um = 1e3 * std::sqrt(squares / count);
  std::printf("[ report   ] sag, facets - surface, over a pupil of %g mm: worst %.3f um, rms %.3f um\n", 2 * pupil, 1e3 * worst, rms_um);
  RecordProperty("sag_difference_worst_um", fmt::format("{:.4f}", 1e3 * worst));
  RecordProperty("sag_difference_rms_um", fmt::format("{:.4f}", rms_um));
  EXPECT_GT(count, 120000);
  EXPECT_GT(worst, 1e-4);  // they are facets
}

TEST(Cornea, every_ray_of_both_is_accounted_for_and_the_first_order_agrees) {
  const json zernike = summary(SAGITTA_SOURCE_DIR "/systems/cornea-zernike.yaml", ""), delaunay = summary(SAGITTA_SOURCE_DIR "/systems/cornea-delaunay.yaml", "");
  ASSERT_EQ(zernike["results"].size(), delaunay["results"].size());
  for (std::size_t i = 0; i < zernike["results"].size(); ++i) {
    for (const json* one : {&zernike, &delaunay}) {
      const json& rays = (*one)["results"][i]["rays"];
      EXPECT_EQ(rays["launched"], 10267);
      EXPECT_EQ(total(rays), 10267);
      EXPECT_EQ(rays["ok"], 10267);
    }
    EXPECT_EQ(delaunay["results"][i]["coverage"][0]["share"], 1);
    const json &a = zernike["results"][i]["spot"], &b = delaunay["results"][i]["spot"];
    std::printf("[ report   ] field %zu, spot rms: zernike %.2f um, delaunay %.2f um\n", i, 1e3 * a["rms_radius_mm"].get<double>(), 1e3 * b["rms_radius_mm"].get<double>());
    RecordProperty(fmt::format("spot_rms_um_field_{}_zernike", i), fmt::format("{:.3f}", 1e3 * a["rms_radius_mm"].get<double>()));
    RecordProperty(fmt::format("spot_rms_um_field_{}_delaunay", i), fmt::format("{:.3f}", 1e3 * b["rms_radius_mm"].get<double>()));
    // A facet's slope is off by at most kappa times its circumradius (0.14/mm * 0.1 mm), which turns a ray by 0.377 of it
    // over 24 mm in index 1.3377: 95 um at the worst ray.
    EXPECT_LE(b["rms_radius_mm"].get<double>(), a["rms_radius_mm"].get<double>() + 0.095);
    for (int k = 0; k < 2; ++k) EXPECT_NEAR(a["centroid_mm"][k].get<double>(), b["centroid_mm"][k].get<double>(), 2e-3);
  }
  EXPECT_NEAR(zernike["first_order"]["effective_focal_length_mm"].get<double>(), delaunay["first_order"]["effective_focal_length_mm"].get<double>(), 1e-2);
}

class RealCornea : public testing::TestWithParam<std::string> {};

// As they are exported, in front of water. How far the data reach differs; the beam of 8 mm asks for more than they all have.
TEST_P(RealCornea, traces_from_air_into_water_with_its_coverage_told) {
  const char* given = std::getenv("SAGITTA_SHARED");
  const std::filesystem::path file = std::filesystem::path(given ? given : SAGITTA_SOURCE_DIR "/../shared") / "data/corneas" / GetParam();
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not there (the test data are optional)";
  for (const double diameter : {3.0, 8.0}) {
    const Folder folder;
    const std::string system = folder.file("s.yaml", fmt::format("sagitta: 1\nwavelengths_nm: [543]\naperture: {{entrance_pupil_diameter_mm: {}}}\nsurfaces:\n"
        "  - {{stop: true, delaunay: {{points: \"{}\", format: cso, interpolation: linear}}, thickness_mm: 31, medium: {{index: 1.333}}}}\n  - {{}}\n", diameter, file.string()));
    const json s = summary(system, "");
    const json& result = s["results"][0];
    EXPECT_EQ(total(result["rays"]), result["rays"]["launched"].get<int>());
    EXPECT_GT(result["rays"]["ok"].get<int>(), 0);
    const double share = result["coverage"][0]["share"].get<double>();
    EXPECT_GT(share, 0.5);
    EXPECT_LE(share, 1);
    EXPECT_EQ(share == 1, diameter == 3);
    // a cornea of 37 to 50 D (337.5/R) is a lens of R/0.333
    const double focal_length = s["first_order"]["effective_focal_length_mm"].get<double>();
    EXPECT_GT(focal_length, 337.5 / 60 / 0.333);
    EXPECT_LT(focal_length, 337.5 / 35 / 0.333);
    std::printf("[ report   ] %s, beam of %g mm: coverage %.2f %%, effective focal length %.2f mm\n", GetParam().c_str(), diameter, 100 * share, focal_length);
  }
}

INSTANTIATE_TEST_SUITE_P(Exports, RealCornea, testing::Values("N01.txt", "K02.txt"), [](const auto& one) { return one.param.substr(0, 3); });

}  // namespace
}  // namespace sagitta::test
