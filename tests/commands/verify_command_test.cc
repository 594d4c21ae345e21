// SPDX-License-Identifier: Apache-2.0
// `sagitta verify` as it is shipped. Its numbers are held by tests/study/rounding_test.cc.
#include <fmt/core.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"

namespace sagitta::test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

const std::string eye = SAGITTA_SOURCE_DIR "/systems/navarro-eye.yaml", triplet = SAGITTA_SOURCE_DIR "/systems/cooke-triplet.yaml";

TEST(VerifyCommand, prints_surfaces_fields_and_a_verdict) {
  const Outcome run = run_program("verify " + eye + " --rays 7");
  EXPECT_EQ(run.status, 0) << run.err;
  for (const char* text : {"Navarro wide-angle eye: 63 rays in double and in 50 digits\n", "are taken as exact: this proves rounding, not formulas", "anterior cornea", "launch", "digits",
                           "every loss is explained by the geometry: at most 0.", "good: places in the image to ", "(asked 1e-09), OPD to ", "0 of 63 rays end differently\n"})
    EXPECT_THAT(run.out, HasSubstr(text));
}

// 0 is asked of numbers that are rounded.
TEST(VerifyCommand, names_a_surface_where_an_answer_is_not_good_enough) {
  for (const char* asked : {"--position-mm 0", "--opd-waves 0"}) {
    const Outcome run = run_program("verify " + triplet + " --rays 7 " + asked);
    EXPECT_EQ(run.status, 1);
    EXPECT_THAT(run.out, HasSubstr("\nnot good: "));
    EXPECT_THAT(run.out, HasSubstr("\nlargest share: surface "));
  }
}

TEST(VerifyCommand, says_the_same_as_json_and_of_several_systems) {
  const json one = json::parse(run_program("verify --json --rays 7 " + triplet).out);
  EXPECT_EQ(one["good"], true);
  EXPECT_EQ(one["digits"], 50);
  EXPECT_EQ(one["rays"], 63);
  EXPECT_TRUE(one["surface_to_blame"].is_null());
  ASSERT_EQ(one["surfaces"].size(), 8u);
  EXPECT_EQ(one["surfaces"][0]["name"], "launch");
  EXPECT_GT(one["surfaces"][7]["position_mm"]["worst"], 0);
  EXPECT_GT(one["surfaces"][7]["bound_position_mm"]["worst"], one["surfaces"][7]["own_position_mm"]["worst"]);
  EXPECT_LT(one["surfaces"][7]["of_bound"], 1);
  EXPECT_TRUE(one["surfaces"][0]["of_bound"].is_null());
  const double ulp = std::ldexp(one["scale_mm"].get<double>(), -52);
  EXPECT_DOUBLE_EQ(one["surfaces"][7]["position_mm"]["worst_ulp"].get<double>() * ulp, one["surfaces"][7]["position_mm"]["worst"].get<double>());
  EXPECT_DOUBLE_EQ(one["surfaces"][7]["direction_rad"]["rms_ulp"].get<double>() * 0x1p-52, one["surfaces"][7]["direction_rad"]["rms"].get<double>());
  EXPECT_EQ(one["fields"].size(), 9u);
  const json two = json::parse(run_program("verify --json --rays 7 " + triplet + " " + eye).out);
  ASSERT_EQ(two.size(), 2u);
  EXPECT_EQ(two[0], one);
  const Outcome table = run_program("verify --rays 7 " + triplet + " " + eye);
  EXPECT_EQ(table.status, 0);
  EXPECT_THAT(table.out, testing::ContainsRegex("Cooke triplet F/5 +63 +0 .* good\n"));
}

// 2026-11-22: "good" and exit status 0, with places to 0 mm.
TEST(VerifyCommand, of_no_ray_that_arrives_nothing_is_good) {
  const Folder folder;
  const std::string misses = folder.file("misses.yaml", "sagitta: 1\nname: Misses\nwavelengths_nm: [550]\naperture: {entrance_pupil_diameter_mm: 1}\nsurfaces:\n"
                                                        "  - {stop: true, thickness_mm: 1}\n  - {name: ball, decenter_mm: [0, 9, 0], conic: {radius_mm: 2}, medium: {index: 1.5}, thickness_mm: 5}\n  - {}\n");
  const Outcome run = run_program("verify " + misses);
  EXPECT_EQ(run.status, 1);
  EXPECT_THAT(run.out, HasSubstr("not good: not one ray arrives"));
  EXPECT_THAT(run.out, HasSubstr("where the last ends: surface 2 (ball)\n"));
  EXPECT_THAT(run.out, HasSubstr("no ray arrives\n"));
  const json report = json::parse(run_program("verify --json " + misses).out);
  EXPECT_EQ(report["good"], false);
  EXPECT_EQ(report["surface_to_blame"], 2);
  EXPECT_TRUE(report["worst_position_mm"].is_null());
  const Outcome both = run_program("verify " + eye + " " + misses + " --rays 7");
  EXPECT_EQ(both.status, 1);
  EXPECT_THAT(both.out, HasSubstr(" not good: surface 2 (ball)\n"));
}

// 2026-11-22: an OPD to 0 waves.
TEST(VerifyCommand, says_where_there_is_no_wavefront) {
  const Folder folder;
  const std::string afocal = folder.file("afocal.yaml", "sagitta: 1\nwavelengths_nm: [550]\naperture: {entrance_pupil_diameter_mm: 1}\nsurfaces:\n  - {stop: true, thickness_mm: 1}\n  - {}\n");
  const Outcome run = run_program("verify " + afocal);
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("no OPD to look at"));
  EXPECT_TRUE(json::parse(run_program("verify --json " + afocal).out)["worst_opd_waves"].is_null());
}

TEST(VerifyCommand, every_shipped_system_is_good) {
  std::string systems;
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(SAGITTA_SOURCE_DIR "/systems"))
    if (entry.path().extension() == ".yaml") systems += " " + entry.path().string(), ++count;
  const Outcome run = run_program("verify" + systems);
  EXPECT_EQ(run.status, 0) << run.out;
  EXPECT_GE(count, 10);
  EXPECT_EQ(count, static_cast<int>(std::count(run.out.begin(), run.out.end(), '\n')) - 5);
}

// Rings whose meridians are the beam's own: rays meet edges. 2026-11-22: "ill-conditioned facet".
TEST(VerifyCommand, names_the_edges_of_facets) {
  const Folder folder;
  std::string points;
  for (int ring = 1; ring <= 6; ++ring)
    for (int i = 0; i < 36; ++i) {
      const double r = .5 * ring, angle = i * std::numbers::pi / 18;
      points += fmt::format("{} {} {}\n", r * std::cos(angle), r * std::sin(angle), .05 * r * r);
    }
  folder.file("rings.xyz", points);
  const std::string system = folder.file("rings.yaml", "sagitta: 1\nwavelengths_nm: [550]\naperture: {entrance_pupil_diameter_mm: 4}\nsurfaces:\n"
                                                       "  - {stop: true, delaunay: {points: rings.xyz, format: xyz, interpolation: linear}, medium: {index: 1.5}, thickness_mm: 20}\n  - {}\n");
  const Outcome run = run_program("verify " + system + " --rays 1000");
  EXPECT_EQ(run.status, 1) << run.out;
  EXPECT_THAT(run.out, HasSubstr("edge of a facet")) << run.err;
}

TEST(VerifyCommand, reports_what_reading_finds) {
  const Folder folder;
  const Outcome run = run_program("verify " + triplet + " " + folder.file("bad.yaml", "sagitta: 1\nsurfaces: 3\n"));
  EXPECT_EQ(run.status, 1);
  EXPECT_EQ(run.out, "");
  EXPECT_THAT(run.err, HasSubstr("bad.yaml:2:11: error: "));
}

}  // namespace
}  // namespace sagitta::test
