// SPDX-License-Identifier: Apache-2.0
// Fields by visual angles and image heights, as the commands take and tell them.
#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>

#include "tests/support/program.h"

namespace sagitta::test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

const std::string navarro = SAGITTA_SOURCE_DIR "/systems/navarro-eye.yaml";

std::string with(const Folder& folder, const std::string& fields) { return folder.file("eye.yaml", "sagitta: 1\nextends: " + navarro + "\n" + fields + "\n"); }

json summary(const std::string& system, const std::string& more = {}) {
  const Folder folder;
  const Outcome run = run_program("trace " + system + " -o " + folder.path("out") + " --json --only spot --rays 1" + more);
  EXPECT_EQ(run.status, 0) << run.err;
  return json::parse(run.out);
}

// The one ray of each field is its chief ray, at the primary wavelength first.
TEST(FieldsOfTheCommands, real_image_heights_are_where_the_chief_rays_arrive) {
  const Folder folder;
  const json s = summary(with(folder, "fields: {real_image_heights_mm: [[0, 8], [-3, 11]]}"));
  for (const json& one : s["results"]) {
    if (one["wavelength_nm"] != 543) continue;
    const json& place = one["real_image_height_mm"];
    EXPECT_EQ(place, one["field"] == 0 ? json({0.0, 8.0}) : json({-3.0, 11.0}));
    for (const int k : {0, 1}) EXPECT_NEAR(one["spot"]["centroid_mm"][k].get<double>(), place[k].get<double>(), 1e-11);
  }
  EXPECT_NEAR(s["results"][0]["angle_deg"][1].get<double>(), 30.8456, 1e-4);  // as `sagitta trace` of that angle gives 8.0000 mm
}

TEST(FieldsOfTheCommands, paraxial_heights_and_visual_angles_are_told_beside_what_they_come_to) {
  const Folder folder;
  const json paraxial = summary(with(folder, "fields: {paraxial_image_heights_mm: [[0, 2]]}"));
  const double focal_length = paraxial["first_order"]["effective_focal_length_mm"];
  EXPECT_NEAR(std::tan(paraxial["results"][0]["angle_deg"][1].get<double>() * std::numbers::pi / 180), 2 / focal_length, 1e-15);
  EXPECT_EQ(paraxial["results"][0]["paraxial_image_height_mm"], json({0.0, 2.0}));
  const json visual = summary(with(folder, "object: {distance_mm: 250}\nfields: {visual_angles_deg: [[0, 20]]}"));
  const double nodal_point = visual["first_order"]["nodal_points_z_mm"][0];
  EXPECT_NEAR(visual["results"][0]["object_height_mm"][1].get<double>(), -(nodal_point + 250) * std::tan(20 * std::numbers::pi / 180), 1e-12);
  EXPECT_EQ(visual["results"][0]["visual_angle_deg"], json({0.0, 20.0}));
}

TEST(FieldsOfTheCommands, that_do_not_exist_are_told_at_their_place) {
  const Folder folder;
  const Outcome run = run_program("check " + with(folder, "fields: {real_image_heights_mm: [[0, 3], [0, 40]]}"));
  EXPECT_EQ(run.status, 1);
  EXPECT_THAT(run.err, HasSubstr("eye.yaml:3:33: error: no chief ray was found that meets the image surface at [0, 40] mm, at 543 nm\n"));
  const std::string pinhole = folder.file("pinhole.yaml", "sagitta: 1\nwavelengths_nm: [550]\naperture: {stop_diameter_mm: 1}\nfields: {paraxial_image_heights_mm: [[0, 3]]}\nsurfaces:\n  - {stop: true, thickness_mm: 10}\n  - {}\n");
  EXPECT_THAT(run_program("trace " + pinhole + " -o " + folder.path("out")).err, HasSubstr("pinhole.yaml:4:37: error: the paraxial image is at infinity: there are no heights in it\n"));
  EXPECT_FALSE(std::filesystem::exists(folder.path("out")));
}

// Both systems by the angles of the first.
TEST(FieldsOfTheCommands, of_a_comparison_are_those_of_the_first_system) {
  const Folder folder;
  const std::string eye = with(folder, "fields: {real_image_heights_mm: [[0, 8]]}");
  const Outcome run = run_program("compare " + eye + " " SAGITTA_SOURCE_DIR "/systems/le-grand-eye.yaml -o " + folder.path("out") + " --json --rays 100");
  ASSERT_EQ(run.status, 0) << run.err;
  const json comparison = json::parse(run.out);
  EXPECT_EQ(comparison["systems"][0]["results"][0]["angle_deg"], comparison["systems"][1]["results"][0]["angle_deg"]);
  EXPECT_EQ(comparison["systems"][1]["results"][0]["real_image_height_mm"], json({0.0, 8.0}));  // of the first
}

}  // namespace
}  // namespace sagitta::test
