// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/support/exr_file.h"
#include "tests/support/program.h"

namespace sagitta::test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

const std::string shipped = SAGITTA_SOURCE_DIR "/systems/cornea-24x180.xyz";

TEST(FitCommand, prints_the_fits_the_coefficients_and_a_shape_to_paste) {
  const Outcome run = run_program("fit " + shipped);
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(run.err, "");
  for (const char* text : {"3600 points within 3 mm", "100.0 % of the circle inside them", "the surface's local frame: x to the examiner's left", "sphere, vertex free along z",
                           "conic, vertex free along z", "that conic with 36 osa terms", "condition number", "peak to valley", "coefficient", "\nzernike: {radius_mm: 7.7"})
    EXPECT_THAT(run.out, HasSubstr(text));
}

// systems/cornea-zernike.yaml is the surface that the points were taken from: its terms but the spherical ones, which a
// conic can take part of, come back to the rounding of the points.
TEST(FitCommand, finds_the_terms_that_the_shipped_points_were_made_with) {
  const Outcome run = run_program("fit " + shipped + " --json");
  ASSERT_EQ(run.status, 0) << run.err;
  const json found = json::parse(run.out);
  std::vector<std::string> keys;
  for (const auto& [key, value] : found.items()) keys.push_back(key);
  EXPECT_THAT(keys, testing::UnorderedElementsAre("points", "version", "frame", "points_used", "coverage", "condition_number", "sphere", "conic", "zernike"));
  EXPECT_EQ(found["points_used"], 3600);
  EXPECT_GT(found["coverage"].get<double>(), 0.99);
  EXPECT_LT(found["condition_number"].get<double>(), 5);
  for (const char* key : {"radius_mm", "vertex_z_mm", "rms_um"}) EXPECT_TRUE(found["sphere"][key].is_number()) << key;
  for (const char* key : {"radius_mm", "conic_constant", "vertex_z_mm", "rms_um"}) EXPECT_TRUE(found["conic"][key].is_number()) << key;
  for (const char* key : {"radius_mm", "conic_constant", "normalization_radius_mm", "rms_um", "peak_to_valley_um"}) EXPECT_TRUE(found["zernike"][key].is_number()) << key;
  EXPECT_EQ(found["zernike"]["indexing"], "osa");
  EXPECT_THAT(found["frame"].get<std::string>(), HasSubstr("x to the examiner's left"));
  const auto terms = found["zernike"]["coefficients_um"].get<std::vector<double>>();
  ASSERT_EQ(terms.size(), 36u);
  EXPECT_NEAR(terms[3], 0.31, 1e-9);
  EXPECT_NEAR(terms[5], -2.13, 1e-9);
  EXPECT_NEAR(terms[7], -0.35, 1e-9);
}

std::string eye_with(const std::string& shape) {
  return "sagitta: 1\nwavelengths_nm: [543]\naperture: {entrance_pupil_diameter_mm: 4}\nsurfaces:\n  - name: cornea\n    stop: true\n    thickness_mm: 24\n    medium: {index: 1.336}\n    " +
         shape + "  - {name: retina}\n";
}

// The fragment as it is, comment and all, in a surface written as lines; the eye then traces as with the points.
TEST(FitCommand, writes_a_fragment_that_a_prescription_takes) {
  const Folder folder;
  for (const char* indexing : {"osa", "noll", "fringe"}) {
    const std::string fragment = folder.path(std::string("new/") + indexing + ".yaml");
    const Outcome run = run_program("fit " + shipped + " --indexing " + indexing + " -o " + fragment);
    ASSERT_EQ(run.status, 0) << run.err;
    EXPECT_THAT(run.out, testing::Not(HasSubstr("zernike: {")));
    const std::string text = read_text(fragment);
    for (const char* said : {"# A surface's shape: the best-fit conic of ", "cornea-24x180.xyz", "3600 points within 3 mm", "um RMS", "by sagitta 0", "x to the examiner's left"})
      EXPECT_THAT(text, HasSubstr(said));
    const std::string pasted = text.substr(text.find("\nzernike: ") + 1);
    const std::string as_lines = folder.file("lines.yaml", eye_with(pasted));
    const Outcome check = run_program("check " + as_lines);
    EXPECT_EQ(check.status, 0) << check.err;
    const std::string in_braces = folder.file("braces.yaml", "sagitta: 1\nwavelengths_nm: [543]\naperture: {entrance_pupil_diameter_mm: 4}\nsurfaces:\n  - {name: cornea, stop: true, " +
                                              pasted + ", thickness_mm: 24, medium: {index: 1.336}}\n  - {name: retina}\n");
    const std::string points = folder.file("points.yaml", eye_with("delaunay: {points: \"" + shipped + "\"}\n"));
    double rms[3];
    int i = 0;
    for (const std::string& system : {as_lines, in_braces, points}) {
      const Outcome trace = run_program("trace " + system + " --rays 1000 --json -o " + folder.path("out"));
      ASSERT_EQ(trace.status, 0) << trace.err;
      const json result = json::parse(trace.out)["results"][0];
      EXPECT_EQ(result["rays"]["ok"], result["rays"]["launched"]);
      rms[i++] = result["wavefront"]["rms_waves"].get<double>();
    }
    EXPECT_EQ(rms[0], rms[1]);
    // Points 0.15 mm apart and terms up to order 7 each keep the surface within 1e-2 um, 0.336 of it being OPD.
    EXPECT_NEAR(rms[0], rms[2], 0.01 * 0.336 / 0.543);
    EXPECT_GT(rms[0], 0.1);
  }
}

TEST(FitCommand, writes_the_residual_as_exr_and_png) {
  const Folder folder;
  const Outcome run = run_program("fit " + shipped + " --terms 6 -o " + folder.path("fit.yaml") + " --json");
  ASSERT_EQ(run.status, 0) << run.err;
  const json found = json::parse(run.out);
  const auto parts = read_exr(folder.path("fit.exr"));
  ASSERT_EQ(parts.size(), 2u);
  EXPECT_EQ(parts[0].name, "preview");
  EXPECT_EQ(parts[1].name, "residual");
  const ExrFilePart& residual = parts[1];
  EXPECT_EQ(residual.width, 257);
  EXPECT_EQ(residual.height, 257);
  EXPECT_EQ(residual.text("units.Y"), "um");
  EXPECT_EQ(residual.text("sign"), "measured z - fitted z");
  EXPECT_THAT(residual.text("interpolation"), HasSubstr("linear over the Delaunay triangulation"));
  EXPECT_THAT(residual.text("frame"), HasSubstr("x to the examiner's left"));
  EXPECT_THAT(residual.text("points"), HasSubstr("cornea-24x180.xyz"));
  EXPECT_EQ(residual.text("terms"), "6 osa terms");
  EXPECT_THAT(residual.text("software"), HasSubstr("sagitta "));
  EXPECT_EQ(residual.number("rms_um"), found["zernike"]["rms_um"].get<double>());
  EXPECT_EQ(residual.number("peak_to_valley_um"), found["zernike"]["peak_to_valley_um"].get<double>());
  EXPECT_EQ(residual.number("condition_number"), found["condition_number"].get<double>());
  EXPECT_EQ(residual.number("coverage"), found["coverage"].get<double>());
  EXPECT_EQ(residual.number("normalization_radius_mm"), 3);
  EXPECT_EQ(residual.number("points_used"), 3600);
  EXPECT_FLOAT_EQ(residual.pair("pixel_size_mm").x, 3.0F / 128);
  EXPECT_EQ(residual.pair("centre_mm").y, 0);
  double low = 1e9, high = -1e9;
  int finite = 0;
  for (const float value : residual.floats.at("Y")) {
    if (std::isnan(value)) continue;
    ++finite;
    low = std::min<double>(low, value);
    high = std::max<double>(high, value);
  }
  EXPECT_GT(finite, 51000);  // of pi/4 257^2
  // Linear interpolation stays between the residuals of the points, and samples come near the extremes.
  EXPECT_LE(high - low, found["zernike"]["peak_to_valley_um"].get<double>() * (1 + 1e-6));
  EXPECT_GE(high - low, found["zernike"]["peak_to_valley_um"].get<double>() * 0.9);
  EXPECT_EQ(read_text(folder.path("fit.png")).substr(1, 3), "PNG");
}

TEST(FitCommand, gives_the_same_bytes_again) {
  const Folder folder;
  for (const char* name : {"a", "b"}) ASSERT_EQ(run_program("fit " + shipped + " -o " + folder.path(std::string(name) + ".yaml")).status, 0);
  for (const char* kind : {".yaml", ".exr", ".png"}) EXPECT_EQ(read_text(folder.path(std::string("a") + kind)), read_text(folder.path(std::string("b") + kind))) << kind;
}

// The same surface seen with x to the examiner's right: osa negates x, so terms odd in x change sign.
TEST(FitCommand, takes_points_in_osa_axes) {
  const auto term = [](const std::string& options, std::size_t index) {
    const Outcome run = run_program("fit " + shipped + " --json " + options);
    EXPECT_EQ(run.status, 0) << run.err;
    return json::parse(run.out)["zernike"]["coefficients_um"][index].get<double>();
  };
  EXPECT_NEAR(term("--axes osa", 8), -term("", 8), 1e-9);
  EXPECT_NEAR(term("--axes osa", 7), term("", 7), 1e-9);
  EXPECT_GT(std::abs(term("", 8)), 0.1);
}

TEST(FitCommand, refuses_with_a_reason_and_writes_nothing) {
  const Folder folder;
  const std::string plane = folder.file("plane.xyz", "0 0 1\n1 0 1\n0 1 1\n-1 0 1\n0 -1 1\n0.5 0.5 1\n");
  const Outcome few = run_program("fit " + plane + " --radius-mm 1 -o " + folder.path("fit.yaml"));
  EXPECT_EQ(few.status, 1);
  EXPECT_EQ(few.out, "");
  EXPECT_EQ(few.err, plane + ":1:1: error: 6 points within 1 mm are too few for 36 terms\n  hint: take a larger radius, or ask for 6 terms or fewer\n");
  const Outcome reach = run_program("fit " + shipped + " --radius-mm 5");
  EXPECT_EQ(reach.status, 1);
  EXPECT_THAT(reach.err, HasSubstr("do not tell 36 terms over all of the circle: the outermost lies 3.6 mm from the origin\n  hint: take a radius of 3.6 mm or less\n"));
  EXPECT_EQ(run_program("fit " + folder.path("none.xyz")).status, 1);
  EXPECT_EQ(run_program("fit").status, 2);
  for (const char* options : {"--terms 0", "--terms 2000", "--indexing fringe --terms 38", "--indexing born", "--format dxf", "--axes left", "--radius-mm 0", "--radius-mm -1", "--radius-mm nan", "--axes osa --format cso"}) {
    const Outcome run = run_program("fit " + shipped + " " + options);
    EXPECT_EQ(run.status, 2) << options;
    EXPECT_NE(run.err, "") << options;
  }
  const Outcome name = run_program("fit " + shipped + " -o " + folder.path("fit.exr"));
  EXPECT_EQ(name.status, 2);
  EXPECT_THAT(name.err, HasSubstr("expected FILE.yaml"));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

TEST(FitCommand, never_overwrites_its_points) {
  const Folder folder;
  std::filesystem::copy_file(shipped, folder.path("p.yaml"));
  std::filesystem::copy_file(shipped, folder.path("q.png"));
  std::filesystem::create_symlink("p.yaml", folder.path("link.yaml"));
  const std::string before = read_text(folder.path("p.yaml"));
  for (const std::string& both : {"p.yaml -o " + folder.path("p.yaml"), "p.yaml -o " + folder.path("./p.yaml"), "p.yaml -o " + folder.path("link.yaml"), "link.yaml -o " + folder.path("p.yaml"),
                                  "q.png -o " + folder.path("q.yaml")}) {
    const Outcome run = run_program("fit " + folder.path(both));
    EXPECT_EQ(run.status, 2) << both;
    EXPECT_EQ(run.out, "") << both;
    EXPECT_THAT(run.err, HasSubstr("is the file of the points, which would be overwritten")) << both;
  }
  EXPECT_EQ(read_text(folder.path("p.yaml")), before);
  EXPECT_EQ(read_text(folder.path("q.png")), before);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 3);
}

TEST(FitCommand, leaves_no_fragment_where_a_picture_cannot_be_written) {
  const Folder folder;
  std::filesystem::create_directory(folder.path("fit.png"));
  const Outcome run = run_program("fit " + shipped + " -o " + folder.path("fit.yaml"));
  EXPECT_EQ(run.status, 1);
  EXPECT_THAT(run.err, HasSubstr("fit.png"));
  EXPECT_FALSE(std::filesystem::exists(folder.path("fit.yaml")));
}

// z = u/500 + u^2/2500 is c u/2 + q c u^2/8 with c = 1/250 and q = 0.8: 1 + K = q/c^2 = 5e4, no conic that reaches the rim.
TEST(FitCommand, says_where_the_conic_is_but_the_sphere) {
  const Folder folder;
  std::string points;
  for (int i = -9; i <= 9; ++i)
    for (int j = -9; j <= 9; ++j) {
      const double u = 0.25 * (i * i + j * j);
      points += std::to_string(0.5 * i) + " " + std::to_string(0.5 * j) + " " + std::to_string(u / 500 + u * u / 2500) + "\n";
    }
  const std::string command = "fit " + folder.file("steep.xyz", points) + " --terms 10 --radius-mm 4";
  const json found = json::parse(run_program(command + " --json").out);
  EXPECT_EQ(found["conic"]["is_sphere"], true);
  EXPECT_EQ(found["conic"]["radius_mm"], found["sphere"]["radius_mm"]);
  EXPECT_THAT(run_program(command + " -o " + folder.path("f.yaml")).out, HasSubstr("\nthe points tell no conic constant from -100 to 100: the conic is the sphere\n"));
  EXPECT_THAT(read_text(folder.path("f.yaml")), HasSubstr("# A surface's shape: the best-fit sphere of "));
  EXPECT_EQ(json::parse(run_program("fit " + shipped + " --json").out)["conic"]["is_sphere"], false);
  EXPECT_THAT(run_program("fit " + shipped).out, testing::Not(HasSubstr("the conic is the sphere")));
}

// A plane has no radius: null in JSON, .inf in the shape, which is a prescription's word for it.
TEST(FitCommand, says_of_a_plane_that_its_radius_is_infinite) {
  const Folder folder;
  std::string points;
  for (int i = -5; i <= 5; ++i)
    for (int j = -5; j <= 5; ++j) points += std::to_string(0.5 * i) + " " + std::to_string(0.5 * j) + " 0.25\n";
  const std::string file = folder.file("plane.xyz", points);
  const Outcome run = run_program("fit " + file + " --terms 3 --radius-mm 2.5");
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("zernike: {radius_mm: .inf, conic_constant: 0,"));
  const json found = json::parse(run_program("fit " + file + " --terms 3 --radius-mm 2.5 --json").out);
  EXPECT_TRUE(found["zernike"]["radius_mm"].is_null());
  EXPECT_TRUE(found["sphere"]["radius_mm"].is_null());
}

}  // namespace
}  // namespace sagitta::test
