// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/program.h"

namespace sagitta::test {
namespace {

using ::testing::HasSubstr;

const std::string lens = "sagitta: 1\nwavelengths_nm: [550, 633]\naperture: {entrance_pupil_diameter_mm: 4}\nfields: {angles_deg: [[0, 0], [1, 3]]}\nsurfaces:\n"
                         "  - {name: 'front, \"outer\"', stop: true, conic: {radius_mm: 50}, thickness_mm: 4, medium: N-BK7}\n"
                         "  - {name: back, conic: {radius_mm: -50}, thickness_mm: 48}\n  - {name: image}\n";
// without the name that needs quotes, for parse_rays
std::string plain() {
  std::string text = lens;
  return text.replace(text.find("'front, \"outer\"'"), 16, "front");
}

TEST(RaysCommand, lists_every_surface_of_every_ray) {
  const Folder folder;
  const Outcome run = run_program("rays " + folder.file("s.yaml", plain()) + " --pupil 0,0 0,1 -0.6,0.8");
  EXPECT_EQ(run.status, 0) << run.err;
  const auto rows = parse_rays(run.out);
  ASSERT_EQ(rows.size(), 2u * 2 * 3 * 3);  // fields, wavelengths, points, surfaces
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(rows[i].ray, static_cast<int>(i / 3) + 1);
    EXPECT_EQ(rows[i].surface, static_cast<int>(i % 3) + 1);
    EXPECT_EQ(rows[i].field, i < 18 ? 0 : 1);
    EXPECT_EQ(rows[i].wavelength_nm, i / 9 % 2 == 0 ? 550 : 633);
    EXPECT_EQ(rows[i].status, "ok");
    EXPECT_EQ(rows[i].name, i % 3 == 0 ? "front" : i % 3 == 1 ? "back" : "image");
    EXPECT_NEAR(std::hypot(rows[i].l, rows[i].m, rows[i].n), 1, 1e-15);
  }
  EXPECT_EQ(rows[8].z, 52);  // global frame
  // the stop is the first surface: the rim ray meets it at the rim of the pupil, but for its sag
  EXPECT_NEAR(rows[3].y, 2, 1e-15);
}

TEST(RaysCommand, default_is_the_chief_ray) {
  const Folder folder;
  const auto rows = parse_rays(run_program("rays " + folder.file("s.yaml", plain())).out);
  ASSERT_EQ(rows.size(), 12u);
  EXPECT_EQ(rows[0].x, 0);
  EXPECT_EQ(rows[0].y, 0);
}

TEST(RaysCommand, fan_runs_from_rim_to_rim) {
  const Folder folder;
  const std::string system = folder.file("s.yaml", plain());
  for (const bool along_x : {true, false}) {
    const Outcome run = run_program("rays " + system + " --field 0 --wavelength 550 --fan " + (along_x ? "x:5" : "y:5"));
    const auto rows = parse_rays(run.out);
    ASSERT_EQ(rows.size(), 15u);
    for (std::size_t i = 0; i < 5; ++i) {
      EXPECT_NEAR(along_x ? rows[3 * i].x : rows[3 * i].y, -2 + static_cast<double>(i), 1e-15);
      EXPECT_EQ(along_x ? rows[3 * i].y : rows[3 * i].x, 0);
    }
    // symmetric about the axis
    EXPECT_NEAR(rows[2].opl, rows[14].opl, 1e-14);
  }
}

TEST(RaysCommand, field_and_wavelength_choose) {
  const Folder folder;
  const std::string system = folder.file("s.yaml", plain());
  const auto rows = parse_rays(run_program("rays " + system + " --field 1 --wavelength 500").out);
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[0].field, 1);
  EXPECT_EQ(rows[0].wavelength_nm, 500);
  EXPECT_GT(rows[2].y, 0);  // a positive field angle lands at +y
  EXPECT_GT(rows[2].x, 0);
  // a shorter wavelength is refracted more
  const auto red = parse_rays(run_program("rays " + system + " --field 0 --wavelength 700 --pupil 0,1").out), blue = parse_rays(run_program("rays " + system + " --field 0 --wavelength 450 --pupil 0,1").out);
  EXPECT_LT(blue[1].m, red[1].m);
}

TEST(RaysCommand, names_are_quoted_where_csv_needs_it) {
  const Folder folder;
  EXPECT_THAT(run_program("rays " + folder.file("s.yaml", lens) + " --field 0").out, HasSubstr(",\"front, \"\"outer\"\"\","));
}

TEST(RaysCommand, a_lost_ray_ends_with_the_row_of_the_surface_that_ended_it) {
  const Folder folder;
  const std::string system = folder.file("s.yaml", "sagitta: 1\nwavelengths_nm: [550]\naperture: {entrance_pupil_diameter_mm: 4}\nsurfaces:\n  - {stop: true, thickness_mm: 4, semi_diameter_mm: 1.9}\n"
                                                   "  - {conic: {radius_mm: 1.5}, thickness_mm: 4, medium: {index: 1.5}}\n  - {}\n");
  const auto rows = parse_rays(run_program("rays " + system + " --pupil 0,0 0,0.8 0,1").out);
  ASSERT_EQ(rows.size(), 3u + 2 + 1);
  EXPECT_EQ(rows[2].status, "ok");
  EXPECT_EQ(rows[4].status, "missed");
  EXPECT_EQ(rows[4].surface, 2);
  EXPECT_EQ(rows[4].z, 0);  // its last good position
  EXPECT_EQ(rows[4].opl, 0);
  EXPECT_EQ(rows[5].status, "clipped");
  EXPECT_EQ(rows[5].y, 2);
  EXPECT_EQ(run_program("rays " + system + " --pupil 0,1").status, 1);  // not one ray arrived
}

TEST(RaysCommand, given_rays_may_have_wavelengths_of_their_own) {
  const Folder folder;
  const std::string system = folder.file("s.yaml", plain());
  // columns in any order, blanks, comments and Windows line ends
  const std::string csv = folder.file("r.csv", "# rays\r\nwavelength_nm, z_mm, y_mm, x_mm, n, m, l\r\n633, -5, 1, 0, 1, 0, 0\r\n\r\n550, -5, 1, 0, 1, 0, 0\r\n550, -7, 1, 0.5, 1, 0, 0\r\n633, -5, 1, 0, 1, 0, 0\r\n");
  const Outcome run = run_program("rays " + system + " --from " + csv);
  EXPECT_EQ(run.status, 0) << run.err;
  const auto rows = parse_rays(run.out);
  ASSERT_EQ(rows.size(), 12u);
  const double expected[] = {633, 550, 550, 633};
  for (std::size_t i = 0; i < 12; ++i) {
    EXPECT_EQ(rows[i].ray, static_cast<int>(i / 3) + 1);
    EXPECT_EQ(rows[i].wavelength_nm, expected[i / 3]);
  }
  EXPECT_EQ(rows[2].y, rows[11].y);
  EXPECT_NE(rows[2].y, rows[5].y);
  EXPECT_EQ(rows[6].x, 0.5);
  EXPECT_NEAR(rows[6].opl - rows[3].opl, 2 + rows[6].z - rows[3].z, 1e-14);  // OPL from the given start
  // without the column: the primary one, or --wavelength
  const std::string bare = folder.file("b.csv", "x_mm,y_mm,z_mm,l,m,n\n0,1,-5,0,0,1\n");
  EXPECT_EQ(parse_rays(run_program("rays " + system + " --from " + bare).out).at(0).wavelength_nm, 550);
  EXPECT_EQ(parse_rays(run_program("rays " + system + " --from " + bare + " --wavelength 633").out).at(2).y, rows[2].y);
}

TEST(RaysCommand, all_errors_of_a_file_of_rays_come_with_their_places) {
  const Folder folder;
  const std::string system = folder.file("s.yaml", plain());
  const auto errors = [&](const std::string& text) {
    const Outcome run = run_program("rays " + system + " --from " + folder.file("r.csv", text));
    EXPECT_EQ(run.status, 1) << text;
    EXPECT_EQ(run.out, "") << text;
    return run.err;
  };
  const std::string file = folder.path("r.csv");
  const std::string several = errors("x_mm,y_mm,z_mm,l,m,n,wavelength_nm\n0,0,-5,0,0,1,543\n0,a,-5,0,0,1,543\n0,0,-5,0,0,2,543\n0,0,-5,0,0\n0,0,-5,0,0,1,-4\n0,nan,-5,0,0,1,550\n-2e100,0,-5,0,0,1,550\n");
  EXPECT_THAT(several, HasSubstr(file + ":3:3: error: y_mm: 'a' is not a finite number"));
  EXPECT_THAT(several, HasSubstr(file + ":4:8: error: the direction (l, m, n) has the length 2"));
  EXPECT_THAT(several, HasSubstr(file + ":5:11: error: the line ends before the column 'n'"));
  EXPECT_THAT(several, HasSubstr(file + ":6:14: error: wavelength_nm: '-4' is not a positive finite number"));
  EXPECT_THAT(several, HasSubstr(file + ":7:3: error: y_mm: 'nan' is not a finite number"));
  EXPECT_THAT(several, HasSubstr(file + ":8:1: error: x_mm: -2e100 is larger than 1e+100"));
  EXPECT_THAT(errors("x_mm,y_mm,z_mm,l,m\n0,0,0,0,0\n"), HasSubstr(file + ":1:1: error: no column 'n'"));
  EXPECT_THAT(errors(""), HasSubstr(file + ":1:1: error: the file is empty"));
  EXPECT_THAT(errors("x_mm,y_mm,z_mm,l,m,n\n"), HasSubstr("holds no ray"));
  EXPECT_THAT(errors("x_mm,y_mm,z_mm,l,m,n\n0,0,0,0,0,0\n"), HasSubstr(":2:7: error: the direction (l, m, n) has the length 0"));
  EXPECT_THAT(errors("x_mm,y_mm,z_mm,l,m,n,wavelength_nm\n0,0,-5,0,0,1,99\n"), HasSubstr("99 nm lies outside the range of N-BK7"));
  std::string many = "x_mm,y_mm,z_mm,l,m,n\n";
  for (int i = 0; i < 1000; ++i) many += "a,b,c,0,0,1\n";
  EXPECT_LT(errors(many).size(), 10000u);  // there is an end to it
  const Outcome none = run_program("rays " + system + " --from " + folder.path("none.csv"));
  EXPECT_EQ(none.status, 1);
  EXPECT_THAT(none.err, HasSubstr("none.csv:1:1: error: there is no such file"));
}

TEST(RaysCommand, wrong_usage_is_2_and_wrong_input_1) {
  const Folder folder;
  const std::string system = folder.file("s.yaml", plain()), csv = folder.file("r.csv", "x_mm,y_mm,z_mm,l,m,n\n0,1,-5,0,0,1\n");
  for (const std::string options : {" --field 2", " --field -1", " --field x", " --fan z:3", " --fan x", " --fan x:0", " --fan x:1e3", " --pupil 2,0", " --pupil 0", " --pupil 0,nan", " --pupil 0,0,0",
                                    " --wavelength 0", " --wavelength -5", " --wavelength nan", " --wavelength red", " --nonsense"}) {
    const Outcome run = run_program("rays " + system + options);
    EXPECT_EQ(run.status, 2) << options;
    EXPECT_NE(run.err, "") << options;
    EXPECT_EQ(run.out, "") << options;
  }
  for (const std::string options : {" --field 0", " --fan x:3", " --pupil 0,0"}) EXPECT_EQ(run_program("rays " + system + " --from " + csv + options).status, 2) << options;
  EXPECT_EQ(run_program("rays " + folder.path("none.yaml")).status, 1);
  EXPECT_EQ(run_program("rays " + system + " --wavelength 99").status, 1);
}

// A ray that is aimed meets the stop where its pupil point stands, and one that cannot be has one row, at the stop, where it would have been launched.
TEST(RaysCommand, AimsAtTheStopAndSaysWhatCannotBeAimed) {
  const Folder folder;
  const auto system_of = [&](const std::string& stop_diameter_mm) {
    return folder.file("s.yaml", "sagitta: 1\nwavelengths_nm: [550]\naperture: {stop_diameter_mm: " + stop_diameter_mm + ", aim: stop}\nfields: {angles_deg: [[0, 30], [0, 85]]}\nsurfaces:\n"
                                                   "  - {conic: {radius_mm: 40}, thickness_mm: 1.5, medium: {index: 1.7}}\n  - {conic: {radius_mm: 8}, thickness_mm: 14}\n"
                                                   "  - {stop: true, thickness_mm: 5, decenter_mm: [0, 0.5, 0], tilt_deg: [10, 0, 0]}\n  - {}\n");
  };
  const Outcome run = run_program("rays '" + system_of("2") + "' --pupil 0,1 0,-1");
  EXPECT_EQ(run.status, 0) << run.err;
  const Outcome too_wide = run_program("rays '" + system_of("400") + "' --field 1 --pupil 0,1 0,0");  // behind a ball lens nothing comes 200 mm off the axis
  EXPECT_EQ(too_wide.status, 0) << too_wide.err;
  std::istringstream lines(run.out + too_wide.out);
  std::vector<std::vector<std::string>> rows;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream cells(line);
    rows.emplace_back();
    for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(cell);
  }
  int at_stop = 0, lost = 0;
  for (const auto& row : rows) {
    if (row[3] != "3") continue;
    if (row[12] == "ok" && row[1] == "0") {
      const double py = row[0] == "1" ? 1 : -1;  // +y is turned toward +z
      EXPECT_NEAR(std::stod(row[6]), 0.5 + py * std::cos(10 * M_PI / 180), 1e-12);
      EXPECT_NEAR(std::stod(row[7]), 15.5 + py * std::sin(10 * M_PI / 180), 1e-12);
      ++at_stop;
    }
    if (row[12] != "not_converged") continue;
    EXPECT_EQ(row[1], "1");
    EXPECT_EQ(std::count_if(rows.begin(), rows.end(), [&](const auto& other) { return other[0] == row[0] && other[1] == row[1]; }), 1);
    EXPECT_NEAR(std::stod(row[9]), std::sin(85 * M_PI / 180), 1e-15);  // its direction is the field's
    ++lost;
  }
  EXPECT_EQ(at_stop, 2);
  EXPECT_GE(lost, 1);
}

// What the head of navarro-eye.yaml says of wide angles: the retina is a hemisphere, which the rays pass; turned about its centre, the same sphere takes them, in
// the same places where both have them.
TEST(RaysCommand, land_on_a_retina_that_is_turned_about_its_centre) {
  const Folder folder;
  const auto chief_ray = [&](double angle, bool is_turned) {
    const std::string turned = "parameters: {turn_deg: 40}\nsurfaces: [{name: retina, decenter_mm: [0, = 12 * sin_deg(turn_deg), = 12 * cos_deg(turn_deg) - 12], tilt_deg: [= -turn_deg, 0, 0]}]\n";
    const std::string system = folder.file("wide.yaml", fmt::format("sagitta: 1\nextends: {}/systems/navarro-eye.yaml\naperture: {{stop_diameter_mm: 3, aim: stop}}\nfields: {{angles_deg: [[0, {}]]}}\n{}", SAGITTA_SOURCE_DIR,
                                                                    angle, is_turned ? turned : ""));
    const Outcome run = run_program("rays " + system + " --wavelength 543");
    EXPECT_EQ(run.err.find("error"), std::string::npos) << run.err;
    return parse_rays(run.out).back();
  };
  for (const double angle : {75., 80., 88.}) {
    EXPECT_EQ(chief_ray(angle, false).status, "missed") << angle;
    const RayRow hit = chief_ray(angle, true);
    EXPECT_EQ(hit.status, "ok") << angle;
    EXPECT_LT(hit.z, 23.9203 - 12);  // before the equator of the retina as it is prescribed
    EXPECT_NEAR(std::hypot(hit.y, hit.z - (23.9203 - 12)), 12, 1e-12);
  }
  for (const double angle : {0., 70.}) {
    EXPECT_NEAR(chief_ray(angle, true).y, chief_ray(angle, false).y, 1e-12);
    EXPECT_NEAR(chief_ray(angle, true).z, chief_ray(angle, false).z, 1e-12);
  }
}

}  // namespace
}  // namespace sagitta::test
