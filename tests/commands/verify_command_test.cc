// SPDX-License-Identifier: Apache-2.0
// `sagitta verify` as it is shipped. Its numbers are held by tests/study/rounding_test.cc.
#include <gmock/gmock.h>

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
  EXPECT_EQ(one["fields"].size(), 9u);
  const json two = json::parse(run_program("verify --json --rays 7 " + triplet + " " + eye).out);
  ASSERT_EQ(two.size(), 2u);
  EXPECT_EQ(two[0], one);
  const Outcome table = run_program("verify --rays 7 " + triplet + " " + eye);
  EXPECT_EQ(table.status, 0);
  EXPECT_THAT(table.out, testing::ContainsRegex("Cooke triplet F/5 +63 +0 .* good\n"));
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
