// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "tests/prescription/cloud_support.h"

namespace sagitta::prescription {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using V = numerics::Vec3<double>;

test::CloudRead read(const std::string& text) { return test::read_points(text, "polar"); }

TEST(Polar, IsTurnedIntoTheEyesFrame) {
  const auto result = read("1,0,1.5,-0.1\n1,90,1.5,-0.2\n1,180,1.5,-0.3\n1,270,1.5,-0.4\n2,-90,2,-0.5\n2,360,3,-0.6\n2,450,4,-1.25\n2,-360,5,-1.0\n");
  EXPECT_EQ(result.told, "");
  // Angle from x to the examiner's right, z out of the eye; then (x, z) -> (-x, -z). Exact on the axes.
  EXPECT_THAT(result.cloud->points, ElementsAre(V{-1.5, 0, 0.1}, V{0, 1.5, 0.2}, V{1.5, 0, 0.3}, V{0, -1.5, 0.4}, V{0, -2, 0.5},
                                                V{-3, 0, 0.6}, V{0, 4, 1.25}, V{-5, 0, 1.0}));
  EXPECT_THAT(result.cloud->lines, ElementsAre(1u, 2u, 3u, 4u, 5u, 6u, 7u, 8u));
  int checked = 0;
  for (int angle = -700; angle <= 700; angle += 7, ++checked) {
    const auto one = read("1 " + std::to_string(angle) + " 2 -0.5");
    ASSERT_TRUE(one.cloud) << one.told;
    const double a = angle * std::numbers::pi / 180;
    // 2 cos(a) of the unreduced angle: its rounding, 12 eps/2, times 2 mm, and a few eps of the functions
    EXPECT_NEAR(one.cloud->points[0].x, -2 * std::cos(a), 1e-14) << angle;
    EXPECT_NEAR(one.cloud->points[0].y, 2 * std::sin(a), 1e-14) << angle;
  }
  EXPECT_EQ(checked, 201);
}

TEST(Polar, FindsColumnsByName) {
  const auto expected = ElementsAre(V{0, 2, 0.5});
  for (const char* text : {"ring,meridian,radius,z\n1,90,2,-0.5\n", "z_mm;radius_mm;angle_deg;ring\n-0,5;2;90;1\n", "1 90 2 -0.5\n",
                           "Ring\tMeridian [deg]\tRadius [mm]\tquality\tZ (mm)\n1\t90\t2\tgood\t-0.5\n", "# made by hand\nring,meridian_deg,radius,z\n1,90,2,-0.5"}) {
    const auto result = read(text);
    EXPECT_EQ(result.told, "") << text;
    EXPECT_THAT(result.cloud->points, expected) << text;
  }
}

TEST(Polar, HasHolesWhereSamplesAreMissing) {
  // -1 written just so is missing, -1.0 a height; a radius of -1 is missing however it is written
  const auto result = read("1,0,1,nan\n1,90,1,\n1,180,1,-1000\n1,270,1,-1\n2,0,2,-1.0\n2,90,-1.0,-1.0\n2,180,2,-0.5\n2,270,-1000,-1000\n3,0,,\n3,90,3,-1000.0\n");
  ASSERT_TRUE(result.cloud) << result.told;
  EXPECT_EQ(result.told, "points:1:1: note: 8 lines without radius or z (nan, empty, -1 or -1000), the first one here: holes\n");
  const auto& p = result.cloud->points;
  ASSERT_EQ(p.size(), 10u);
  for (std::size_t i = 0; i < 10; ++i) EXPECT_EQ(std::isnan(p[i].z), i != 4 && i != 6) << i;
  EXPECT_EQ(p[4].z, 1);
  EXPECT_EQ(p[5].y, 2);   // between 2 and 2 of its ring
  EXPECT_EQ(p[7].y, -2);
  EXPECT_EQ(p[8].x, -3);  // the only radius of its ring
}

TEST(Polar, PutsHolesBetweenTheirNeighboursInAngle) {
  // A tenth of the way from 10 to 110 degrees, from radius 1 to 2; and around the turn, from 350 to 10 degrees.
  const auto result = read("5,10,1,-0.1\n5,110,2,-0.1\n5,20,nan,nan\n7,350,3,-0.1\n7,0,nan,nan\n7,10,5,-0.1\n");
  ASSERT_TRUE(result.cloud) << result.told;
  const auto radius = [&](std::size_t i) { return std::hypot(result.cloud->points[i].x, result.cloud->points[i].y); };
  EXPECT_NEAR(radius(2), 1.1, 1e-15);
  EXPECT_NEAR(radius(4), 4, 1e-15);
}

TEST(Polar, PutsNoHoleInsideWhatIsMeasuredAndNoneBeyondIt) {
  // Ring 2 at 0 degrees would stand at 2, inside the 2.5 of ring 1 there: halfway to ring 3. Ring 3 at 180 degrees would
  // stand at 3, inside the 3.5 of ring 2 there, and nothing is further out: it leaves nothing. Ring 4 has no sample: nothing.
  const auto result = read("1,0,2.5,-0.1\n1,180,1,-0.1\n2,0,nan,nan\n2,90,2,-0.1\n2,180,3.5,-0.1\n2,270,2,-0.1\n3,0,3,-0.1\n3,180,nan,nan\n3,90,3,-0.1\n3,270,3,-0.1\n"
                           "4,0,nan,nan\n4,90,nan,nan\n");
  ASSERT_TRUE(result.cloud) << result.told;
  ASSERT_EQ(result.cloud->points.size(), 9u);
  EXPECT_THAT(result.told, HasSubstr("4 lines without radius or z"));
  EXPECT_EQ(result.cloud->points[2].x, -2.75);
  EXPECT_TRUE(std::isnan(result.cloud->points[2].z));
  EXPECT_EQ(result.cloud->lines.back(), 10u);
}

TEST(Polar, LeavesOutLinesWithoutAPlace) {
  const auto result = read("ring,meridian,radius,z\n1,0,1,-0.1\nnan,0,1,-0.1\n1,,1,-0.1\n1,90,1,-0.1\n");
  EXPECT_EQ(result.told, "points:3:1: note: 2 lines without a place (ring or meridian is nan or empty), the first one here: left out\n");
  EXPECT_THAT(result.cloud->lines, ElementsAre(2u, 5u));
}

TEST(Polar, TakesAnApexOnEveryMeridianAsOnePlace) {
  const auto result = read("0,0,0,0\n0,90,0,0\n0,180,0,0\n0,271,0,0\n");
  ASSERT_TRUE(result.cloud) << result.told;
  for (const V& p : result.cloud->points) {
    EXPECT_EQ(p, (V{0, 0, 0}));
    EXPECT_FALSE(std::signbit(p.x) || std::signbit(p.y));
  }
}

TEST(Polar, TellsEveryErrorWithItsPlace) {
  EXPECT_EQ(read("ring,meridian,radius,z\n1,0,1,-0.1\n1.5,0,1,0\n-1,0,1,0\n1,0, -2,0\n1,x,1,0\n1,0,1,1e400\n1,inf,1,0\n1,2,3\n").told,
            "points:3:1: error: the ring is no whole number from 0: \"1.5\"\n  hint: rings count outward\n"
            "points:4:1: error: the ring is no whole number from 0: \"-1\"\n  hint: rings count outward\n"
            "points:5:6: error: the radius is negative: \"-2\"\n  hint: a missing sample is nan, -1 or -1000\n"
            "points:6:3: error: meridian is no number: \"x\"\n  hint: a number in degrees, or nan for a hole\n"
            "points:7:7: error: z is outside the range of numbers (1e-308 to 1e308): \"1e400\"\n"
            "points:8:3: error: meridian is infinite: \"inf\"\n"
            "points:9:1: error: 3 columns where at least 4 are needed: \"1,2,3\"\n  hint: a hole has nan for its z\n");
  EXPECT_THAT(read("1,2,3,4,5\n").told, HasSubstr("5 columns without a header line\n  hint: a first line such as ring,meridian,radius,z,quality names the columns; "
                                                  "ring, meridian, radius, z are read"));
  EXPECT_THAT(read("ring,meridian,r,z\n1,2,3,4\n").told, HasSubstr("names no column radius: \"ring,meridian,r,z\"\n  hint: columns ring, meridian or "
                                                                   "meridian_deg or angle_deg, radius or radius_mm, z or z_mm are found by name"));
  EXPECT_THAT(read("ring,meridian,angle_deg,radius,z\n1,2,3,4,5\n").told, HasSubstr("points:1:15: error: a second column meridian"));
  EXPECT_THAT(read("").told, HasSubstr("error: holds no points\n  hint: lines of ring, meridian in degrees, radius and z in mm"));
  EXPECT_THAT(read("1,0,1,nan\n1,90,1,-1000\n").told, HasSubstr("error: every sample is missing"));
  EXPECT_THAT(read(std::string("1,2,3,4\n1,\0,6,7\n", 16)).told, HasSubstr("points:2:1: error: a zero byte"));
}

}  // namespace
}  // namespace sagitta::prescription
