// SPDX-License-Identifier: Apache-2.0
// `sagitta compare --surface`: one surface of a system made from points in several ways.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <cstdlib>

#include "tests/support/compared.h"

namespace sagitta::test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

const std::string eye = systems + "eye-with-measured-cornea.yaml --surface 'anterior cornea' --with " + systems + "measured-cornea.xyz --axes osa";

TEST(CompareVariants, variants_are_the_system_with_one_surface_replaced) {
  const json summary = compared(eye + " --as delaunay,delaunay:linear,zernike:36 --rays 400");
  ASSERT_EQ(summary["systems"].size(), 3u);
  EXPECT_EQ(summary["systems"][0]["system"], "delaunay");
  EXPECT_EQ(summary["systems"][1]["slug"], "delaunay-linear");
  EXPECT_EQ(summary["systems"][2]["system"], "zernike:36");
  EXPECT_EQ(summary["comparison"], "Eye with a measured cornea, anterior cornea from measured-cornea.xyz");
  const json alone = traced(systems + "eye-with-measured-cornea.yaml", "--rays 400");  // c1 is the default there too
  EXPECT_EQ(summary["systems"][0]["results"], alone["results"]);
  EXPECT_EQ(summary["systems"][0]["results"][1]["coverage"][0]["share"], 1);
  EXPECT_FALSE(summary["systems"][0].contains("note"));
  EXPECT_THAT(summary["systems"][1]["note"].get<std::string>(), HasSubstr("unusable for wavefronts"));
  EXPECT_FALSE(summary["systems"][2].contains("note"));
  EXPECT_FALSE(summary["systems"][0].contains("fit"));
  const json& fit = summary["systems"][2]["fit"];
  EXPECT_EQ(fit["terms"], 36);
  EXPECT_LT(fit["residual_rms_um"].get<double>(), 0.001);  // the model cornea is nearly of 36 terms
  // 5 % more than the greatest distance of the beam's rays from the axis; a fan through the rim shows nearly that
  const Outcome rays = run_program("rays " + systems + "eye-with-measured-cornea.yaml --fan y:3");
  double reach = 0;
  for (const RayRow& row : parse_rays(rays.out))
    if (row.surface == 1) reach = std::max(reach, std::hypot(row.x, row.y));
  EXPECT_GE(fit["radius_mm"].get<double>(), 1.049 * reach * 0.98);  // the outermost ring of 2000 points has 0.98 of the radius
  EXPECT_LE(fit["radius_mm"].get<double>(), 1.051 * reach);
}

TEST(CompareVariants, a_fitted_variant_is_the_shape_that_fit_gives) {
  const Folder folder;
  ASSERT_EQ(run_program("fit " + systems + "measured-cornea.xyz --axes osa --terms 21 --radius-mm 2.5 -o " + folder.path("shape.yaml")).status, 0);
  std::istringstream fragment(read_text(folder.path("shape.yaml")));
  std::string system = "extends: " + systems + "eye-with-measured-cornea.yaml\nsurfaces:\n  - name: anterior cornea\n";
  for (std::string line; std::getline(fragment, line);) system += "    " + line + "\n";
  const json alone = traced(folder.file("fitted.yaml", system), "--rays 400");
  const json summary = compared(eye + " --as zernike:21,delaunay --radius-mm 2.5 --rays 400");
  json results = summary["systems"][0]["results"];
  for (json& result : results) result.erase("coverage");  // of the fit, of which the fitted prescription knows nothing
  EXPECT_EQ(results, alone["results"]);
  EXPECT_EQ(summary["systems"][0]["fit"]["radius_mm"], 2.5);
}

TEST(CompareVariants, the_points_are_traced_as_those_that_they_stand_for_or_as_is_said) {
  const Folder folder;
  const std::string own = "extends: " + systems + "eye-with-measured-cornea.yaml\nsurfaces:\n  - {name: anterior cornea, delaunay: {points: " + systems + "measured-cornea.xyz, axes: osa, ";
  const std::string with = " --surface 'anterior cornea' --with " + systems + "measured-cornea.xyz --axes osa --rays 300 --as ";
  const std::string smoothed = folder.file("smoothed.yaml", own + "smoothing_um: 0.05}}\n"), raw = folder.file("raw.yaml", own + "max_edge_mm: 5}}\n");
  const json of_smoothed = traced(smoothed, "--rays 300"), variants = compared(smoothed + with + "delaunay,zernike:36");
  ASSERT_EQ(of_smoothed["smoothing"].size(), 1u);
  EXPECT_EQ(variants["systems"][0]["results"], of_smoothed["results"]);
  EXPECT_EQ(variants["systems"][0]["smoothing"], of_smoothed["smoothing"]);
  // by the command line, whatever the surface itself is
  EXPECT_EQ(compared(raw + with + "delaunay,zernike:36 --smoothing-um 0.05")["systems"][0]["results"], of_smoothed["results"]);
  EXPECT_EQ(compared(systems + "navarro-eye.yaml" + with + "delaunay,zernike:36 --smoothing-um 0.05")["systems"][0]["smoothing"], of_smoothed["smoothing"]);
  EXPECT_FALSE(compared(smoothed + with + "delaunay,zernike:36 --smoothing-um 0")["systems"][0].contains("smoothing"));
  // the longest edge: none is left of 0.01 mm; the surface's own and the option's
  const std::string short_edges = folder.file("short.yaml", own + "max_edge_mm: 0.01}}\n");
  for (const std::string& arguments : {raw + with + "delaunay,zernike:36 --radius-mm 3 --max-edge-mm 0.01", short_edges + with + "delaunay,zernike:36 --radius-mm 3"}) {
    const Outcome run = run_program("compare " + arguments + " -o " + folder.path("out"));
    EXPECT_EQ(run.status, 1) << arguments;
    EXPECT_THAT(run.err, HasSubstr("edge longer than max_edge_mm")) << arguments;
  }
  // the radial functions
  const std::string flat = folder.file("flat.yaml", own + "interpolation: multiquadric, rings: 1, shape_mm: 2}}\n");
  EXPECT_EQ(compared(flat + with + "delaunay:multiquadric,delaunay")["systems"][0]["results"], traced(flat, "--rays 300")["results"]);
  // no word of smoothing where nothing smoothed is traced
  EXPECT_THAT(run_program("compare " + smoothed + with + "zernike:15,zernike:36 -o " + folder.path("out")).err, testing::Not(HasSubstr("smoothed")));
  const std::string notes = run_program("compare " + smoothed + with + "delaunay,zernike:36 -o " + folder.path("out")).err;
  EXPECT_EQ(notes.find("note: smoothed"), notes.rfind("note: smoothed"));
  EXPECT_THAT(notes, HasSubstr("note: smoothed"));
  for (const char* option : {"--smoothing-um -1", "--smoothing-um nan", "--max-edge-mm 0", "--max-edge-mm nan", "--radius-mm nan"})
    EXPECT_EQ(run_program("compare " + raw + with + "delaunay,zernike:36 " + option + " -o " + folder.path("out")).status, 2) << option;
}

// The reviewer's case: the cornea 3 mm beside the beam of 2 mm to each side, its points 3.6 mm wide to each side.
TEST(CompareVariants, says_what_share_of_the_beam_a_fit_is_extrapolated_for) {
  const Folder folder;
  const std::string dec = folder.file("dec.yaml", "extends: " + systems + "navarro-eye.yaml\nwavelengths_nm: [543]\nfields: {angles_deg: [[0, 0]]}\n"
                                                  "surfaces: [{name: anterior cornea, decenter_mm: [3, 0, 0]}]\n");
  const std::string arguments = dec + " --surface 'anterior cornea' --with " + systems + "cornea-24x180.xyz --as delaunay,zernike:36";
  const json summary = compared(arguments);
  const double of_points = summary["systems"][0]["results"][0]["coverage"][0]["share"], of_fit = summary["systems"][1]["results"][0]["coverage"][0]["share"];
  EXPECT_EQ(summary["systems"][1]["results"][0]["coverage"][0]["surface"], 1);
  EXPECT_LT(of_fit, 0.7);
  // the points end on a polygon of 180 corners in the circle of the fit: 1 - cos(1 deg) = 2e-4 of its radius
  EXPECT_NEAR(of_fit, of_points, 0.002);
  EXPECT_EQ(summary["systems"][1]["fit"]["surface"], 1);
  const std::string text = run_program("compare " + arguments + " -o " + folder.path("out")).out;
  EXPECT_THAT(text, HasSubstr(fmt::format("zernike:36: field 0 at 543 nm: {:.3g} % of the rays meet the surface beyond the circle of its fit, where it is extrapolated\n", 100 * (1 - of_fit))));
  EXPECT_THAT(text, HasSubstr("zernike:36: field 0 at 543 nm: its spot is of 10267 rays, that of delaunay of "));
  const std::string inside = run_program("compare " + eye + " --as delaunay,zernike:36 --rays 300 -o " + folder.path("out")).out;
  EXPECT_THAT(inside, testing::Not(testing::AnyOf(HasSubstr("extrapolated"), HasSubstr("not of the same rays"))));
}

TEST(CompareVariants, leaves_no_sheet_of_an_earlier_run_and_takes_blanks_between_the_ways) {
  const Folder folder;
  const std::string one_field = folder.file("one.yaml", "extends: " + systems + "navarro-eye.yaml\nfields: {angles_deg: [[0, 0]]}\n");
  const std::string with = " --surface 'anterior cornea' --with " + systems + "measured-cornea.xyz --rays 100 -o " + folder.path("out") + " --as 'delaunay:linear, zernike:15'";
  ASSERT_EQ(run_program("compare " + systems + "navarro-eye.yaml" + with).status, 0);
  EXPECT_TRUE(std::filesystem::exists(folder.path("out/comparison.field2.png")));
  folder.file("out/comparison.field7.txt", "mine");
  ASSERT_EQ(run_program("compare " + one_field + with).status, 0);
  EXPECT_EQ(json::parse(read_text(folder.path("out/summary.json")))["systems"][1]["system"], "zernike:15");
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path("out"))) count += entry.path().extension() == ".png";
  EXPECT_EQ(count, 1u);
  EXPECT_EQ(read_text(folder.path("out/comparison.field7.txt")), "mine");
}

TEST(CompareVariants, a_fit_goes_no_farther_than_the_data) {
  const Folder folder;
  std::string points;
  for (int i = -20; i <= 20; ++i)
    for (int j = -20; j <= 20; ++j)
      if (i * i + j * j <= 400) points += fmt::format("{} {} {}\n", 0.1 * i, 0.1 * j, (i * i + j * j) * 0.01 / 15);
  const json summary = compared(systems + "eye-with-measured-cornea.yaml --surface 'anterior cornea' --with " + folder.file("small.xyz", points) + " --as delaunay,zernike:10");
  EXPECT_NEAR(summary["systems"][1]["fit"]["radius_mm"].get<double>(), 2, 1e-12);
  // what the data do not cover is counted, and lost on one side only
  const json& difference = summary["differences"][0]["results"][1]["wavefront"];
  EXPECT_LT(summary["systems"][0]["results"][1]["coverage"][0]["share"].get<double>(), 1);
  EXPECT_GT(difference["samples_only_in_this"].get<int>(), 0);
  EXPECT_EQ(difference["samples_only_in_first"], 0);
}

TEST(CompareVariants, a_fit_that_the_points_do_not_determine_is_refused_with_its_reason) {
  const Folder folder;
  const Outcome run = run_program("compare " + systems + "eye-with-measured-cornea.yaml --surface 'anterior cornea' --with " +
                                  folder.file("four.xyz", "0 0 0\n1 0 0.06\n0 1 0.06\n-1 -1 0.13\n") + " --as delaunay,zernike:36 -o " + folder.path("out"));
  EXPECT_EQ(run.status, 1);
  EXPECT_THAT(run.err, HasSubstr("four.xyz:1:1: error: zernike:36: "));
  EXPECT_FALSE(std::filesystem::exists(folder.path("out")));
}

class ExportedCornea : public testing::TestWithParam<std::string> {};

TEST_P(ExportedCornea, is_compared_as_it_is) {
  const char* given = std::getenv("SAGITTA_SHARED");
  const std::filesystem::path file = std::filesystem::path(given ? given : SAGITTA_SOURCE_DIR "/../shared") / "data/corneas" / GetParam();
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not there (the test data are optional)";
  const json summary = compared(systems + "navarro-eye.yaml --surface 'anterior cornea' --with '" + file.string() + "' --format cso --as delaunay,delaunay:linear,zernike:36,zernike:66");
  ASSERT_EQ(summary["systems"].size(), 4u);
  for (const json& system : summary["systems"])
    for (const json& result : system["results"]) {
      EXPECT_EQ(result["rays"]["ok"], result["rays"]["launched"]);
      EXPECT_TRUE(result["wavefront"].is_object());
      for (const json& coverage : result.value("coverage", json::array())) EXPECT_EQ(coverage["share"], 1);
    }
  for (const json& difference : summary["differences"])
    for (const json& result : difference["results"]) EXPECT_EQ(result["wavefront"]["samples"], 3001);
  const double of_36 = summary["systems"][2]["fit"]["residual_rms_um"], of_66 = summary["systems"][3]["fit"]["residual_rms_um"];
  EXPECT_LT(of_66, of_36);  // least squares: more terms fit better
  EXPECT_GT(of_66, 0.05);   // and the noise of the instrument, 0.25 um, is not in them
  EXPECT_LT(of_36, 2);
  std::printf("[ report   ] %s: fit residual %.3f um (36 terms), %.3f um (66); wavefronts at field 0 differ from c1 by %.3f (linear), %.3f, %.3f waves rms\n", GetParam().c_str(), of_36, of_66,
              summary["differences"][0]["results"][0]["wavefront"]["rms_waves"].get<double>(), summary["differences"][1]["results"][0]["wavefront"]["rms_waves"].get<double>(),
              summary["differences"][2]["results"][0]["wavefront"]["rms_waves"].get<double>());
}

INSTANTIATE_TEST_SUITE_P(Compared, ExportedCornea, testing::Values("N01.txt", "K02.txt"), [](const auto& one) { return one.param.substr(0, 3); });

}  // namespace
}  // namespace sagitta::test
