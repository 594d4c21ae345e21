// SPDX-License-Identifier: Apache-2.0
#include "lib/prescription/cloud_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>

#include "lib/surface/facets.h"
#include "tests/prescription/cloud_support.h"

namespace sagitta::prescription {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using V = numerics::Vec3<double>;
namespace fs = std::filesystem;

using Read = test::CloudRead;

Read read(const std::string& text, const std::string& format = "xyz", bool osa_axes = false) { return test::read_points(text, format, osa_axes); }

std::vector<V> points(const std::string& text) {
  const Read result = read(text);
  EXPECT_EQ(result.told, "");
  return result.cloud ? result.cloud->points : std::vector<V>{};
}

TEST(CloudFormats, AreTheChoicesOfTheKey) {
  const auto& keys = surface::Facets::keys;
  const auto format = std::find_if(keys.begin(), keys.end(), [](const auto& key) { return key.name == "format"; });
  ASSERT_NE(format, keys.end());
  EXPECT_EQ(cloud_formats(), format->choices);
  EXPECT_THAT(read("0 0 0", "obj").told, HasSubstr("error: \"obj\" is no format of point clouds\n  hint: one of xyz|cso|polar|ply"));
}

TEST(CloudFormats, SayWhetherTheUserGivesTheirAxes) {
  for (const auto& [format, given] : {std::pair{"xyz", true}, {"ply", true}, {"cso", false}, {"polar", false}, {"obj", false}})
    EXPECT_EQ(has_given_axes(format), given) << format;
}

TEST(Xyz, IsSeparatedByCommaSemicolonTabOrBlanks) {
  const auto expected = ElementsAre(V{1, -2.5, 3e-3}, V{4, 5, 6});
  EXPECT_THAT(points("1,-2.5,3e-3\n4,5,6\n"), expected);
  EXPECT_THAT(points("1 ; -2.5 ;3e-3\n4;5;6"), expected);
  EXPECT_THAT(points("1\t-2.5\t3e-3\n4\t5\t6\n"), expected);
  EXPECT_THAT(points("  1 -2.5   3e-3 \n\t4\t5 6\n"), expected);
  EXPECT_THAT(points("1, -2.5, 3e-3,\n4, 5, +6,\n"), expected);
  EXPECT_THAT(points(" 1\t -2.5 \t3e-3\r\n4\t5\t6\r\n"), expected);
}

TEST(Xyz, TakesADecimalCommaBetweenSemicolonsAndTabs) {
  EXPECT_THAT(points("1,5;2,25;-3\n0.5;1e-2;,5"), ElementsAre(V{1.5, 2.25, -3}, V{0.5, 0.01, 0.5}));
  EXPECT_THAT(points("1,5\t2,25\t-3\n"), ElementsAre(V{1.5, 2.25, -3}));
  EXPECT_THAT(read("1.5;2,2.5;3\n").told, HasSubstr("points:1:5: error: y is no number: \"2,2.5\""));
  // Between blanks it would be a guess.
  EXPECT_THAT(read("1,5 2,25 -3\n").told, HasSubstr("points:1:3: error: y is no number: \"5 2\""));
}

TEST(Xyz, FindsColumnsByName) {
  EXPECT_THAT(points("ring,meridian,x,y,z\n1,0,0.2,0,0.003\n"), ElementsAre(V{0.2, 0, 0.003}));
  EXPECT_THAT(points("# made by hand\n\n\"Z [mm]\";\"q\"; X_mm ;Y(mm)\n3;q;1;2\n"), ElementsAre(V{1, 2, 3}));
  EXPECT_THAT(points("z y x\n3 2 1\n"), ElementsAre(V{1, 2, 3}));
  EXPECT_THAT(points("x [mm] y [mm] z [mm]\n1 2 3\n"), ElementsAre(V{1, 2, 3}));
  EXPECT_THAT(points("X,Y,Z,name\n1,2,3,any thing\n4,5,6,\n"), ElementsAre(V{1, 2, 3}, V{4, 5, 6}));
}

TEST(Xyz, SkipsCommentsEmptyLinesAndAByteOrderMark) {
  const Read result = read("\xEF\xBB\xBF# head\r\n\r\n   \n1,2,3 # one\n#4,5,6\n7,8,9");
  EXPECT_EQ(result.told, "");
  EXPECT_THAT(result.cloud->points, ElementsAre(V{1, 2, 3}, V{7, 8, 9}));
  EXPECT_THAT(result.cloud->lines, ElementsAre(4u, 6u));
}

TEST(Xyz, HasHolesWhereZIsNanOrEmpty) {
  const Read result = read("1,2,nan\n3,4,\n5,6,NaN\n7,8,9\n");
  EXPECT_EQ(result.told, "points:1:1: note: 3 lines without z (nan or empty), the first one here: holes\n");
  ASSERT_EQ(result.cloud->points.size(), 4u);
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(std::isnan(result.cloud->points[static_cast<std::size_t>(i)].z));
  EXPECT_EQ(result.cloud->points[1].x, 3);
  EXPECT_TRUE(std::isnan(read("a,x,y,z\n0,1,2,\n").cloud->points[0].z));
}

TEST(Xyz, LeavesOutLinesWithoutAPlace) {
  const Read result = read("1,2,3\nnan,2,3\n4,,6\nnan,nan,nan\n");
  EXPECT_EQ(result.told, "points:2:1: note: 3 lines without a place (x or y is nan or empty), the first one here: left out\n");
  EXPECT_THAT(result.cloud->points, ElementsAre(V{1, 2, 3}));
  EXPECT_THAT(read("nan nan nan\n").told, HasSubstr("points:1:1: error: holds no points"));
}

TEST(Xyz, NegatesXForOsaAxes) {
  EXPECT_THAT(read("1,2,3\n", "xyz", true).cloud->points, ElementsAre(V{-1, 2, 3}));
}

TEST(Xyz, TellsEveryErrorWithItsPlace) {
  EXPECT_EQ(read("x,y,z\n1,2,3\n1, two,3\n1,2\n1,2,1e400\n1,2,inf\n-infinity,2,3\n1,2,3x\n").told,
            "points:3:4: error: y is no number: \"two\"\n  hint: a number in mm, or nan for a hole\n"
            "points:4:1: error: 2 columns where at least 3 are needed: \"1,2\"\n  hint: a hole has nan for its z\n"
            "points:5:5: error: z is outside the range of numbers (1e-308 to 1e308): \"1e400\"\n"
            "points:6:5: error: z is infinite: \"inf\"\n"
            "points:7:1: error: x is infinite: \"-infinity\"\n"
            "points:8:5: error: z is no number: \"3x\"\n  hint: a number in mm, or nan for a hole\n");
  EXPECT_THAT(read("0x1p3,2,3\n").told, HasSubstr("points:1:1: error: x is no number: \"0x1p3\""));
  EXPECT_THAT(read("1,2,3\n1,2,+-3\n1,2,--3\n").told, AllOf(HasSubstr("\"+-3\""), HasSubstr("\"--3\"")));
}

TEST(Xyz, RefusesToGuessColumns) {
  EXPECT_THAT(read("1,2,3,4\n5,6,7,8\n").told, HasSubstr("points:1:1: error: 4 columns without a header line\n"));
  EXPECT_THAT(read("1,2,3\n1,2,3,4\n").told, HasSubstr("points:2:1: error: 4 columns where 3 are needed: \"1,2,3,4\""));
  EXPECT_THAT(read("1,2\n").told, HasSubstr("points:1:1: error: 2 columns where 3 are needed"));
  EXPECT_THAT(read("x,y,height\n1,2,3\n").told, HasSubstr("points:1:1: error: the header line names no column z: \"x,y,height\""));
  EXPECT_THAT(read("x_um,y,z\n1,2,3\n").told, HasSubstr("names no column x"));
  EXPECT_THAT(read("x,y,z,Z\n1,2,3,4\n").told, HasSubstr("points:1:7: error: a second column z"));
  EXPECT_THAT(read("hello world\n1 2 3\n").told, HasSubstr("names no column x: \"hello world\""));
}

TEST(Xyz, RefusesWhatIsNoText) {
  EXPECT_THAT(read("").told, HasSubstr("points:1:1: error: holds no points"));
  EXPECT_THAT(read("# only\n# comments\n").told, HasSubstr("holds no points"));
  EXPECT_THAT(read(std::string("1,2,3\n4,\0,6\n", 12)).told, HasSubstr("points:2:1: error: a zero byte"));
  EXPECT_THAT(read(std::string(2000000, ' ')).told, HasSubstr("points:1:1: error: a line of more than a megabyte"));
  EXPECT_THAT(read("1,2,3\n" + std::string(2000000, '7')).told, HasSubstr("points:2:1: error: a line of more than a megabyte"));
  EXPECT_THAT(read("1,2," + std::string(900000, '9') + "\n").told, HasSubstr("outside the range of numbers"));
  Findings findings;
  EXPECT_EQ(read_cloud({"/nowhere/at/all.xyz", "xyz"}, findings), nullptr);
  EXPECT_THAT(test::text_of(findings), HasSubstr("/nowhere/at/all.xyz:1:1: error: cannot be read: No such file or directory"));
  const test::TemporaryFolder folder;
  EXPECT_EQ(read_cloud({folder.path(), "xyz"}, findings), nullptr);
  EXPECT_THAT(test::text_of(findings), HasSubstr("cannot be read: Is a directory"));
}

TEST(Xyz, EchoesAtMostFortyCharactersAndAHundredErrors) {
  const std::string told = read("1,2," + std::string(5000, 'a') + "\n1,2,\x1b[31m\n").told;
  EXPECT_THAT(told, HasSubstr(": \"" + std::string(40, 'a') + "...\""));
  EXPECT_THAT(told, Not(HasSubstr("\x1b")));
  std::string lines;
  for (int i = 0; i < 1234; ++i) lines += "1,2,x\n";
  const std::string many = read("1,2,3\n" + lines).told;
  EXPECT_THAT(many, HasSubstr("points:101:5: error"));
  EXPECT_THAT(many, Not(HasSubstr("points:102:5: error")));
  EXPECT_THAT(many, HasSubstr("points:1:1: note: 1134 more errors in this file"));
}

TEST(Xyz, ReadsLinesAcrossItsBuffer) {
  std::string text;
  for (int i = 0; i < 100000; ++i) text += std::to_string(i) + ".25," + std::to_string(-i) + ",0.500\n";
  ASSERT_GT(text.size(), std::size_t{1} << 21);
  const auto got = points(text);
  ASSERT_EQ(got.size(), 100000u);
  for (int i = 0; i < 100000; ++i) ASSERT_EQ(got[static_cast<std::size_t>(i)], (V{i + 0.25, double(-i), 0.5}));
}

// 2 rings x 4 meridians.
std::string cso(const std::string& radii, const std::string& elevations, const std::string& counts = "") {
  return "Paziente :\r\n--------\r\nsph -1000 cyl -1000\r\n--------\r\nDato misurato : Elevazioni\r\n" +
         (counts.empty() ? "N\xB0 Anelli : 2\r\nN\xB0 Semimeridiani : 4\r\n" : counts) + "--------\r\n" + radii + elevations;
}
const std::string radii = "1,5\r\n1,5\r\n1,5\r\n1,5\r\n2\r\n3\r\n4\r\n5\r\n";
const std::string elevations = "-0,1\r\n-0,2\r\n-0,3\r\n-0,4\r\n-0,5\r\n-0,6\r\n-0,7\r\n-1,0";

TEST(Cso, IsTurnedIntoTheEyesFrame) {
  const Read result = read(cso(radii, elevations), "cso");
  EXPECT_EQ(result.told, "");
  // Radius and angle to x to the right, y up, z out of the eye; then (x, z) -> (-x, -z). Exact on the axes.
  EXPECT_THAT(result.cloud->points, ElementsAre(V{-1.5, 0, 0.1}, V{0, 1.5, 0.2}, V{1.5, 0, 0.3}, V{0, -1.5, 0.4}, V{-2, 0, 0.5},
                                                V{0, 3, 0.6}, V{4, 0, 0.7}, V{0, -5, 1.0}));
  EXPECT_THAT(result.cloud->lines, ElementsAre(17u, 18u, 19u, 20u, 21u, 22u, 23u, 24u));
}

TEST(Cso, MarksMissingSamplesAsHolesOnTheirMeridian) {
  const Read result = read(cso("-1\r\n1\r\n-1000\r\n3\r\n4\r\n4\r\n4\r\n-1\r\n",
                               "-1\r\n-0,1\r\n-1000\r\n-0,3\r\n-1\r\n-1000\r\n-0,5\r\n-1\r\n"),
                           "cso");
  EXPECT_THAT(result.told, HasSubstr("note: 5 of 8 samples are missing: holes"));
  const auto& p = result.cloud->points;
  ASSERT_EQ(p.size(), 8u);
  // Between 3 at meridian 3 and 1 at meridian 1, around the ring; between 1 and 3.
  EXPECT_EQ(p[0].x, -2);
  EXPECT_EQ(p[2].x, 2);
  for (const int hole : {0, 2, 4, 5, 7}) EXPECT_TRUE(std::isnan(p[static_cast<std::size_t>(hole)].z)) << hole;
  EXPECT_EQ(p[4].x, -4);
  EXPECT_EQ(p[7].y, -4);
  // A ring between two others without any sample is a hole on each meridian (2026-11-22: it left nothing, and rays through it
  // were ok): here at 2 between 1 and 3.
  const std::string all_gone = "-1\r\n-1\r\n-1\r\n-1\r\n";
  const Read between = read(cso("1\r\n1\r\n1\r\n1\r\n" + all_gone + "3\r\n3\r\n3\r\n3\r\n",
                                "0\r\n0\r\n0\r\n0\r\n" + all_gone + "-0,5\r\n-0,5\r\n-0,5\r\n-0,5\r\n",
                                "N\xB0 Anelli : 3\r\nN\xB0 Semimeridiani : 4\r\n"),
                            "cso");
  ASSERT_EQ(between.cloud->points.size(), 12u);
  EXPECT_EQ(between.cloud->points[4].x, -2);
  EXPECT_TRUE(std::isnan(between.cloud->points[4].z));
  // The innermost ring, where it has no sample at all, leaves nothing.
  const Read ring = read(cso("-1\r\n-1\r\n-1\r\n-1\r\n2\r\n3\r\n4\r\n5\r\n", "-1\r\n-1\r\n-1\r\n-1\r\n-0,5\r\n-0,6\r\n-0,7\r\n-0,8\r\n"), "cso");
  EXPECT_EQ(ring.cloud->points.size(), 4u);
  EXPECT_EQ(ring.cloud->lines[0], 21u);
  EXPECT_THAT(read(cso("-1\n-1\n-1\n-1\n-1\n-1\n-1\n-1\n", "-1\n-1\n-1\n-1\n-1\n-1\n-1\n-1\n"), "cso").told,
              HasSubstr("error: every sample is missing"));
}

TEST(Cso, PutsNoHoleInsideWhatIsMeasured) {
  // 3 rings x 4 meridians. Meridian 1: ring 1 at 2.5 lies beyond the 2 that ring 2 has on both sides; ring 3 is there,
  // so the hole goes halfway to it. Meridian 2: nothing beyond ring 1, so ring 2's sample leaves nothing, ring 3's a hole.
  const std::string counts = "N\xB0 Anelli : 3\r\nN\xB0 Semimeridiani : 4\r\n";
  const auto result = read(cso("1\n2,5\n2,5\n1\n" "2\n-1\n-1\n2\n" "3\n3\n-1\n3\n", "-1,0\n-1,0\n-1,0\n-1,0\n" "-1,0\n-1\n-1\n-1,0\n" "-1,0\n-1,0\n-1\n-1,0\n", counts), "cso");
  ASSERT_TRUE(result.cloud) << result.told;
  const auto& p = result.cloud->points;
  ASSERT_EQ(p.size(), 11u);
  EXPECT_EQ(p[5].y, 2.75);
  EXPECT_TRUE(std::isnan(p[5].z));
  EXPECT_EQ(p[6].y, -2);  // ring 2 of meridian 3
  EXPECT_EQ(p[9].x, 3);   // ring 3 of meridian 2
  EXPECT_TRUE(std::isnan(p[9].z));
  EXPECT_THAT(result.told, HasSubstr("3 of 12 samples are missing"));
}

TEST(Cso, RefusesWhatIsNoElevationExport) {
  const auto told = [](const std::string& text) { return read(text, "cso").told; };
  EXPECT_THAT(told("x,y,z\n1,2,3\n"), AllOf(HasSubstr("points:1:1: error: no line \"Dato misurato : Elevazioni\" in the header\n"),
                                            HasSubstr("no line \"N\xC2\xB0 Anelli : COUNT\""), HasSubstr("Semimeridiani")));
  EXPECT_THAT(told(""), HasSubstr("no line"));
  std::string curvatures = cso(radii, elevations);
  curvatures.replace(curvatures.find("Elevazioni"), 10, "Curvature");
  EXPECT_THAT(told(curvatures), HasSubstr("points:5:1: error: the file holds \"Curvature\", not elevations"));
  EXPECT_THAT(told(cso(radii, elevations, "N\xB0 Anelli : 0\r\nN\xB0 Semimeridiani : 4x\r\n")),
              AllOf(HasSubstr("points:6:13: error: \"0\" is no count from 1 to 10000"), HasSubstr("points:7:20: error: \"4x\"")));
  EXPECT_THAT(told(cso(radii, elevations, "N\xB0 Anelli : 3\r\nN\xB0 Semimeridiani : 4\r\n")),
              HasSubstr("points:24:1: error: the file ends after 16 numbers of 2 x 3 rings x 4 meridians = 24"));
  EXPECT_THAT(told(cso(radii, "")), HasSubstr("error: the file ends after 8 numbers of 2 x 2 rings x 4 meridians = 16"));
  EXPECT_THAT(told(cso(radii, elevations + "\r\n3\r\n4\r\n")), HasSubstr("points:25:1: error: more numbers than the header announces"));
  EXPECT_THAT(told(cso(radii, "\r\n" + elevations)), HasSubstr("points:17:1: error: an empty line among the numbers"));
  EXPECT_THAT(told(cso("1,5,5\r\n-2\r\nx\r\n1,5\r\n2\r\n3\r\n4\r\n1e999\r\n", elevations)),
              AllOf(HasSubstr("points:9:1: error: the radius is no number: \"1,5,5\""), HasSubstr("points:10:1: error: the radius is negative"),
                    HasSubstr("points:11:1"), HasSubstr("points:16:1: error: the radius is outside the range")));
  EXPECT_THAT(told(cso(radii, "nan\r\n" + elevations)), HasSubstr("points:17:1: error: the elevation is no number: \"nan\""));
}

// Real exports, not part of the project: checked where they are at hand.
fs::path shared() {
  const char* given = std::getenv("SAGITTA_SHARED");
  return given ? fs::path(given) : fs::path(SAGITTA_SOURCE_DIR) / ".." / "shared";
}

TEST(Cso, ReadsRealExports) {
  const fs::path folder = shared() / "data" / "corneas";
  if (!fs::exists(folder / "N01.txt")) GTEST_SKIP() << "no exports in " << folder;
  for (const auto& [name, missing] : {std::pair{"N01.txt", 760}, {"K02.txt", 775}}) {
    Findings findings;
    const auto cloud = read_cloud({(folder / name).string(), "cso"}, findings);
    ASSERT_TRUE(cloud) << test::text_of(findings);
    EXPECT_THAT(test::text_of(findings), HasSubstr(std::to_string(missing) + " of 6144 samples are missing: holes"));
    EXPECT_GE(cloud->points.size(), 6144u - 64);
    int holes = 0;
    for (const V& p : cloud->points) {
      holes += std::isnan(p.z);
      const double r = std::hypot(p.x, p.y);
      EXPECT_TRUE(r > 0.19 && r < 5.5);
      // A cornea, sag into the eye: radii of curvature from 5 to 10 mm.
      if (std::isnan(p.z)) continue;
      EXPECT_TRUE(p.z > r * r / 20 && p.z < r * r / 10) << r << ' ' << p.z;
    }
    EXPECT_GE(holes, missing - 64);
    EXPECT_EQ(cloud->points.size() - static_cast<std::size_t>(holes), 6144u - static_cast<std::size_t>(missing));
  }
}

TEST(Xyz, ReadsTheSyntheticCorneas) {
  const fs::path file = shared() / "data" / "synthetic" / "normal_noisy.csv";
  if (!fs::exists(file)) GTEST_SKIP() << "no " << file;
  Findings findings;
  const auto cloud = read_cloud({file.string(), "xyz", true}, findings);
  ASSERT_TRUE(cloud) << test::text_of(findings);
  EXPECT_EQ(cloud->points.size(), 24u * 180);
  EXPECT_THAT(test::text_of(findings), HasSubstr("176 lines without z"));
}

}  // namespace
}  // namespace sagitta::prescription
