// SPDX-License-Identifier: Apache-2.0
// The program as it is without CGAL: what it refuses, with which words, and what it does as ever.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "tests/support/program.h"

namespace sagitta::test {
namespace {

using nlohmann::json;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;

const std::string systems = SAGITTA_SOURCE_DIR "/systems/";
const std::string missing = "error: points cannot be triangulated: this build of sagitta is without CGAL\n"
                            "  hint: build it with cmake -DSAGITTA_CGAL=ON, or trace a fit to the points (sagitta fit)\n";

Outcome run_without_cgal(const std::string& arguments) { return run_program(arguments, {}, SAGITTA_PROGRAM_WITHOUT_CGAL); }

TEST(WithoutCgal, every_command_that_would_triangulate_says_where_and_what_to_do) {
  const Folder folder;
  const std::string points = systems + "cornea-delaunay.yaml", at = points + ":12:15: " + missing;
  for (const std::string& command : {"check " + points, "trace " + points + " -o " + folder.path("out"), "rays " + points,
                                     "compare " + systems + "cornea-zernike.yaml " + points + " -o " + folder.path("out"),
                                     "compare " + points + " " + systems + "cornea-zernike.yaml -o " + folder.path("out")}) {
    const Outcome run = run_without_cgal(command);
    EXPECT_EQ(run.status, 1) << command;
    EXPECT_EQ(run.out, "") << command;
    EXPECT_EQ(run.err, at) << command;
  }
  EXPECT_FALSE(std::filesystem::exists(folder.path("out")));
}

TEST(WithoutCgal, every_surface_of_points_is_told_in_its_place) {
  const Folder folder;
  folder.file("p.xyz", "0 0 0\n1 0 0\n0 1 0\n");
  const std::string surface = "  - {delaunay: {points: p.xyz}, thickness_mm: 1";
  const std::string file = folder.file("s.yaml", "sagitta: 1\nwavelengths_nm: [550]\naperture: {entrance_pupil_diameter_mm: 1}\nsurfaces:\n" + surface + ", stop: true}\n" + surface + "}\n  - {}\n");
  EXPECT_EQ(run_without_cgal("check " + file).err, file + ":5:16: " + missing + file + ":6:16: " + missing);
}

TEST(WithoutCgal, what_the_prescription_itself_has_wrong_comes_first) {
  const Folder folder;
  const Outcome run = run_without_cgal("check " + folder.file("s.yaml", "sagitta: 1\nwavelengths_nm: [550]\naperture: {entrance_pupil_diameter_mm: 1}\nsurfaces:\n"
                                                              "  - {delaunay: {points: none.xyz}, thickness_mm: 1, stop: true}\n  - {}\n"));
  EXPECT_EQ(run.status, 1);
  EXPECT_THAT(run.err, HasSubstr("s.yaml:5:25: error: there is no file 'none.xyz'"));
  EXPECT_THAT(run.err, Not(HasSubstr("CGAL")));
}

TEST(WithoutCgal, points_are_compared_as_zernike_surfaces_and_refused_as_points) {
  const Folder folder;
  const std::string arguments = "compare " + systems + "cornea-zernike.yaml --surface 'anterior cornea' --with " + systems + "cornea-24x180.xyz -o " + folder.path("out") + " --rays 300 --as ";
  const Outcome fits = run_without_cgal(arguments + "zernike:36,zernike:15");
  EXPECT_EQ(fits.status, 0) << fits.err;
  EXPECT_EQ(fits.out, run_program(arguments + "zernike:36,zernike:15").out);
  std::filesystem::remove_all(folder.path("out"));
  for (const char* as : {"delaunay,zernike:36", "zernike:36,delaunay:linear"}) {
    const Outcome points = run_without_cgal(arguments + as);
    EXPECT_EQ(points.status, 1);
    EXPECT_EQ(points.err, "--with: " + missing);
  }
  EXPECT_FALSE(std::filesystem::exists(folder.path("out")));
}

TEST(WithoutCgal, a_fit_has_all_but_the_map_and_the_coverage) {
  const Folder folder;
  const std::string arguments = "fit " + systems + "cornea-24x180.xyz --terms 15";
  const std::string note = systems + "cornea-24x180.xyz:1:1: note: no residual map, and no coverage: points cannot be triangulated: this build of sagitta is without CGAL\n";
  const Outcome numbers = run_without_cgal(arguments + " --json");
  EXPECT_EQ(numbers.status, 0);
  EXPECT_EQ(numbers.err, note);
  json found = json::parse(numbers.out);
  EXPECT_EQ(found["coverage"], nullptr);
  EXPECT_EQ(found["points_used"], 3600);
  json whole = json::parse(run_program(arguments + " --json").out);
  whole["coverage"] = nullptr;
  EXPECT_EQ(found, whole);

  const Outcome table = run_without_cgal(arguments + " -o " + folder.path("fit.yaml"));
  EXPECT_EQ(table.status, 0) << table.err;
  EXPECT_THAT(table.out, HasSubstr("3600 points within 3 mm\nin the surface's local frame"));
  const std::string fragment = read_text(folder.path("fit.yaml"));
  EXPECT_THAT(fragment, HasSubstr("\n# In the surface's local frame"));
  EXPECT_THAT(fragment, HasSubstr("zernike: {radius_mm: 7.7"));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

TEST(WithoutCgal, systems_without_points_are_traced_to_the_same_bytes) {
  const Folder folder;
  const std::string arguments = "trace " + systems + "navarro-eye.yaml --rays 300 -o ";
  const Outcome ours = run_without_cgal(arguments + folder.path("a")), whole = run_program(arguments + folder.path("b"));
  EXPECT_EQ(ours.status, 0) << ours.err;
  EXPECT_EQ(ours.out, whole.out);
  int compared = 0;
  for (const char* file : {"spot.exr", "spot.png", "wavefront.exr", "wavefront.png", "summary.json"}) {
    const std::string text = read_text(folder.path(std::string("a/") + file));
    compared += !text.empty();
    EXPECT_TRUE(text == read_text(folder.path(std::string("b/") + file))) << file;
  }
  EXPECT_EQ(compared, 5);
}

TEST(WithoutCgal, the_version_says_so_and_the_licence_is_apache) {
  const Outcome run = run_without_cgal("--version");
  EXPECT_THAT(run.out, HasSubstr("\ndelaunay          no: without CGAL\n"));
  EXPECT_THAT(run.out, EndsWith("\nlicence           Apache-2.0\n"));
}

}  // namespace
}  // namespace sagitta::test
