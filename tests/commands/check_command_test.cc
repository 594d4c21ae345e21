// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "tests/support/program.h"

namespace sagitta::test {
namespace {

using ::testing::HasSubstr;

TEST(CheckCommand, says_what_a_good_system_is) {
  const Outcome run = run_program("check " SAGITTA_SOURCE_DIR "/systems/navarro-eye.yaml");
  EXPECT_EQ(run.status, 0);
  EXPECT_EQ(run.err, "");
  EXPECT_THAT(run.out, HasSubstr("no error"));
  EXPECT_THAT(run.out, HasSubstr("6 surfaces, 3 fields, 3 wavelengths"));
  EXPECT_THAT(run.out, HasSubstr("16.4679 mm at 543 nm"));
}

TEST(CheckCommand, counts_one_of_a_kind_as_one) {
  const Folder folder;
  const Outcome run = run_program("check " + folder.file("one.yaml", "sagitta: 1\nwavelengths_nm: [550]\naperture: {entrance_pupil_diameter_mm: 4}\nsurfaces:\n"
                                                                     "  - {stop: true, conic: {radius_mm: 5}, thickness_mm: 1, medium: {index: 1.3}}\n  - {}\n"));
  EXPECT_THAT(run.out, HasSubstr(": 2 surfaces, 1 field, 1 wavelength, effective"));
}

TEST(CheckCommand, reports_what_reading_and_compiling_find_and_writes_nothing) {
  const Folder folder;
  const std::string bad = folder.file("bad.yaml", "sagitta: 1\nwavelengths_nm: [550]\naperture: {entrance_pupil_diameter_mm: 4}\nsurfaces:\n  - {stop: true, conic: {radius_mm: 5 mm}, thicknes_mm: 1}\n  - {}\n");
  const Outcome run = run_program("check " + bad);
  EXPECT_EQ(run.status, 1);
  EXPECT_EQ(run.out, "");
  EXPECT_THAT(run.err, HasSubstr(bad + ":5:"));
  EXPECT_THAT(run.err, HasSubstr("thickness_mm"));
  // what only compiling can find
  const std::string telecentric = folder.file("t.yaml", "sagitta: 1\nwavelengths_nm: [550]\naperture: {entrance_pupil_diameter_mm: 4}\nsurfaces:\n  - {conic: {radius_mm: -100}, thickness_mm: -50, medium: mirror}\n"
                                                        "  - {stop: true, thickness_mm: -10}\n  - {}\n");
  const Outcome compiled = run_program("check " + telecentric);
  EXPECT_EQ(compiled.status, 1);
  EXPECT_THAT(compiled.err, HasSubstr("t.yaml:3:"));
  EXPECT_THAT(compiled.err, HasSubstr("entrance pupil is at infinity"));
  EXPECT_EQ(run_program("check " + folder.path("none.yaml")).status, 1);
  EXPECT_EQ(run_program("check").status, 2);
  EXPECT_EQ(run_program("check a b").status, 2);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 2);
}

}  // namespace
}  // namespace sagitta::test
