// SPDX-License-Identifier: Apache-2.0
// What `sagitta refraction` takes, tells and draws; its values are of tests/analysis/refraction_test.cc and published_systems_test.cc.
#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"

namespace sagitta::test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

const std::string systems = SAGITTA_SOURCE_DIR "/systems/";

json refraction(const std::string& arguments) {
  const Outcome run = run_program("refraction " + arguments + " --json");
  EXPECT_EQ(run.status, 0) << run.err;
  return json::parse(run.out);
}
double paraxial_M(const json& result) { return result["refraction"]["paraxial"]["M_D"]; }

TEST(RefractionCommand, sets_parameters_and_moves_the_plane) {
  const json at_cornea = refraction(systems + "arizona-eye.yaml --set accommodation_D=2")["results"][0];
  EXPECT_NEAR(paraxial_M(at_cornea), -1.9938, 1e-4);  // references.md, E11
  const json at_spectacles = refraction(systems + "arizona-eye.yaml --set accommodation_D=2 --vertex-mm 12")["results"][0];
  EXPECT_NEAR(paraxial_M(at_spectacles), paraxial_M(at_cornea) / (1 + .012 * paraxial_M(at_cornea)), 1e-9);
  EXPECT_EQ(run_program("refraction " + systems + "arizona-eye.yaml --set accomodation_D=2").status, 2);
}

// The eyes that it is made after have some 2 D from 400 to 700 nm.
TEST(RefractionCommand, tells_and_draws_the_chromatic_aberration) {
  const Folder folder;
  const json spectrum = refraction(systems + "arizona-eye.yaml --spectrum 400:700:100 -o " + folder.path("new/spectrum.svg"));
  ASSERT_EQ(spectrum["results"].size() % 4, 0u);
  EXPECT_EQ(spectrum["results"][1]["wavelength_nm"], 500);
  const json& chromatic = spectrum["longitudinal_chromatic_aberration"][0];
  EXPECT_EQ(chromatic["shortest_nm"], 400);
  EXPECT_EQ(chromatic["longest_nm"], 700);
  EXPECT_NEAR(chromatic["difference_D"].get<double>(), paraxial_M(spectrum["results"][3]) - paraxial_M(spectrum["results"][0]), 1e-12);
  EXPECT_GT(chromatic["difference_D"].get<double>(), 1.5);
  EXPECT_LT(chromatic["difference_D"].get<double>(), 3);
  EXPECT_THAT(read_text(folder.path("new/spectrum.svg")), HasSubstr("<title>Refraction of "));
}

// 2026-11-23: +58.2 D (paraxial) and +64.0 D (far point) of an eye of +.12 D, without a word.
TEST(RefractionCommand, says_that_flat_facets_are_no_use) {
  const std::string note = "surface 1 anterior cornea: flat facets (interpolation: linear) are unusable for refractions";
  EXPECT_THAT(run_program("refraction " + systems + "cornea-delaunay.yaml").out, HasSubstr(note));
  EXPECT_THAT(refraction(systems + "cornea-delaunay.yaml")["note"].get<std::string>(), HasSubstr(note));
  EXPECT_FALSE(refraction(systems + "cornea-zernike.yaml").contains("note"));
}

TEST(RefractionCommand, refuses_what_it_cannot_draw_or_reach) {
  const Folder folder;
  const Outcome gif = run_program("refraction " + systems + "le-grand-eye.yaml -o " + folder.path("a.gif"));
  EXPECT_EQ(gif.status, 2);
  EXPECT_THAT(gif.err, HasSubstr("sagitta refraction: -o: the picture's name must end in .png or .svg\n"));
  const Outcome beyond = run_program("refraction " + systems + "navarro-eye.yaml --spectrum 400:700:100");
  EXPECT_EQ(beyond.status, 1);
  EXPECT_THAT(beyond.err, HasSubstr("sagitta refraction: 400 nm and 1 more lie outside the range of navarro-cornea, 458 to 632.8 nm\n"));
  EXPECT_EQ(run_program("refraction " + systems + "arizona-eye.yaml --spectrum 700:400:10").status, 2);
}

// nd and Vd are of visible light: one warning a medium, of the wavelengths beyond it, and none of those within.
TEST(RefractionCommand, warns_of_a_formula_that_is_extrapolated) {
  const std::string warning = "sagitta refraction: warning: nd 1.377 vd 57.1 is meant for visible light, 380 to 780 nm, and extrapolated at 100, 150, 200 nm\n";
  const Outcome ultraviolet = run_program("refraction " + systems + "arizona-eye.yaml --spectrum 100:200:50");
  EXPECT_EQ(ultraviolet.status, 0);
  EXPECT_THAT(ultraviolet.err, HasSubstr(warning));
  EXPECT_EQ(std::count(ultraviolet.err.begin(), ultraviolet.err.end(), '\n'), 4);  // of four media, the aqueous stands there twice
  EXPECT_EQ(run_program("refraction " + systems + "arizona-eye.yaml --spectrum 380:780:100").err, "");
  EXPECT_EQ(run_program("refraction " + systems + "le-grand-eye.yaml --spectrum 100:200:50").err, "");  // one index each, at every wavelength
}

TEST(RefractionCommand, says_where_there_is_no_eye) {
  const Outcome lens = run_program("refraction " + systems + "cooke-triplet.yaml"), before = run_program("refraction " + systems + "cooke-triplet.yaml --vertex-mm 12");
  EXPECT_EQ(lens.status, 0);
  EXPECT_THAT(lens.out, HasSubstr("refraction at the vertex plane of surface 1; no eye, for its image is in air: the image surface is taken for the retina\n"));
  EXPECT_THAT(before.out, HasSubstr("refraction at the plane 12 mm before surface 1; no eye"));
  EXPECT_FALSE(refraction(systems + "cooke-triplet.yaml").at("is_eye"));
  for (const char* eye : {"navarro-eye.yaml", "liou-brennan-eye.yaml"}) EXPECT_TRUE(refraction(systems + eye).at("is_eye"));
  const Folder folder;
  const std::string said = folder.file("said.yaml", "sagitta: 1\nextends: " + systems + "cooke-triplet.yaml\neye: left\n");
  EXPECT_THAT(run_program("refraction " + said).out, HasSubstr("at the cornea's vertex plane; left eye\n"));
}

}  // namespace
}  // namespace sagitta::test
