// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "tests/prescription/cloud_support.h"

namespace sagitta::prescription {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using V = numerics::Vec3<double>;

constexpr double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();

test::CloudRead read(const std::string& bytes, bool osa_axes = false) { return test::read_points(bytes, "ply", osa_axes); }

template <class T>
std::string bytes_of(T value, bool is_big = false) {
  std::string bytes(sizeof(T), '\0');
  std::memcpy(bytes.data(), &value, sizeof(T));
  if (is_big == (std::endian::native == std::endian::little)) std::reverse(bytes.begin(), bytes.end());
  return bytes;
}

std::string header(const std::string& format, const std::string& elements) {
  return "ply\nformat " + format + " 1.0\n" + elements + "end_header\n";
}
const std::string xyz = "property double x\nproperty double y\nproperty double z\n";

std::string doubles(const std::vector<V>& points, bool is_big = false) {
  std::string bytes = header(is_big ? "binary_big_endian" : "binary_little_endian", "element vertex " + std::to_string(points.size()) + "\n" + xyz);
  for (const V& p : points)
    for (const double v : {p.x, p.y, p.z}) bytes += bytes_of(v, is_big);
  return bytes;
}

const std::vector<V> points{{1, -2.5, 3e-3}, {0.1, 1e300, -0.0}, {4, 5, 6}};

TEST(Ply, IsReadInEveryForm) {
  const auto is_right = ElementsAre(points[0], points[1], points[2]);
  for (const bool is_big : {false, true}) {
    const auto binary = read(doubles(points, is_big));
    EXPECT_EQ(binary.told, "");
    EXPECT_THAT(binary.cloud->points, is_right);
    EXPECT_TRUE(std::signbit(binary.cloud->points[1].z));
    EXPECT_FALSE(binary.cloud->has_lines);
    EXPECT_TRUE(binary.cloud->lines.empty());
  }
  const auto text = read(header("ascii", "comment made by hand\nelement vertex 3\n" + xyz) + "1 -2.5 3e-3\r\n  0.1\t1e300 -0.0 \n4 5 6\n");
  EXPECT_EQ(text.told, "");
  EXPECT_THAT(text.cloud->points, is_right);
  EXPECT_TRUE(text.cloud->has_lines);
  EXPECT_THAT(text.cloud->lines, ElementsAre(9u, 10u, 11u));
}

// z first as float, integers between, y and x as float and double; faces behind, another element before.
TEST(Ply, TakesCoordinatesInAnyOrderAmongOthers) {
  const std::string elements = "element camera 2\nproperty float f\nproperty uchar c\nelement vertex 2\nproperty float z\nproperty uchar red\nproperty short s\nproperty double x\n"
                               "property int i\nproperty float32 y\nproperty uint8 last\nelement face 1\nproperty list uchar int vertex_indices\n";
  for (const bool is_big : {false, true}) {
    std::string bytes = header(is_big ? "binary_big_endian" : "binary_little_endian", elements) + std::string(10, '\x7f');
    for (const V& p : {V{1.1, 2.5, 3.25}, V{-4, 5, nan}})
      bytes += bytes_of(static_cast<float>(p.z), is_big) + "\x01" + bytes_of<std::int16_t>(7, is_big) + bytes_of(p.x, is_big) + bytes_of<std::int32_t>(-1, is_big) +
               bytes_of(static_cast<float>(p.y), is_big) + "\x02";
    bytes += "\x03 whatever";
    const auto result = read(bytes);
    EXPECT_EQ(result.told, "points:1:1: note: 1 vertex without z (nan), the first one is 2: holes\n");
    ASSERT_EQ(result.cloud->points.size(), 2u);
    EXPECT_EQ(result.cloud->points[0], (V{1.1, 2.5, 3.25}));
    EXPECT_EQ(result.cloud->points[1].x, -4);
    EXPECT_TRUE(std::isnan(result.cloud->points[1].z));
  }
  const auto text = read(header("ascii", elements) + "1 2\n3 4\n3.25 255 7 1.1 -1 2.5 0\nnan 1 2 -4 3 5 6\n3 0 1 2\n");
  EXPECT_EQ(text.told, "points:20:1: note: 1 line without z (nan), the first one here: holes\n");
  EXPECT_EQ(text.cloud->points[0], (V{1.1, 2.5, 3.25}));
}

TEST(Ply, CountsWhatHasNoPlaceAndKeepsItsNumbers) {
  const auto result = read(doubles({{1, 2, 3}, {nan, 2, 3}, {4, nan, 6}, {7, 8, nan}, {9, 9, 9}}));
  EXPECT_EQ(result.told, "points:1:1: note: 2 vertices without a place (x or y is nan), the first one is 2: left out\n"
                         "points:1:1: note: 1 vertex without z (nan), the first one is 4: holes\n");
  ASSERT_EQ(result.cloud->points.size(), 3u);
  EXPECT_THAT(result.cloud->lines, ElementsAre(1u, 4u, 5u));
  EXPECT_THAT(read(doubles({{nan, 2, 3}})).told, HasSubstr("error: not one vertex has a place"));
}

TEST(Ply, ReadsManyBlocks) {
  std::vector<V> many;
  for (int i = 0; i < 100000; ++i) many.push_back({i + 0.25, -i * 3.0, i == 77777 ? nan : 1.0 / (i + 1)});
  for (const bool is_big : {false, true}) {
    const auto result = read(doubles(many, is_big));
    ASSERT_EQ(result.cloud->points.size(), many.size());
    EXPECT_EQ(std::memcmp(result.cloud->points.data(), many.data(), many.size() * sizeof(V)), 0);
  }
}

TEST(Ply, NegatesXForOsaAxes) { EXPECT_THAT(read(doubles({{1, 2, 3}}), true).cloud->points, ElementsAre(V{-1, 2, 3})); }

TEST(Ply, RefusesInfiniteCoordinatesByTheirVertex) {
  EXPECT_EQ(read(doubles({{1, 2, 3}, {1, -inf, 3}, {1, 2, inf}})).told, "points:1:1: error: vertex 2: y is infinite\npoints:1:1: error: vertex 3: z is infinite\n");
  EXPECT_EQ(read(header("ascii", "element vertex 2\n" + xyz) + "1 2 3\n1 inf 3\n").told, "points:9:3: error: y is infinite: \"inf\"\n");
}

TEST(Ply, RefusesFilesThatWereCutOffAndHeadersThatLie) {
  const std::string whole = doubles(points);
  for (const std::size_t cut : {1u, 24u, 25u, 72u}) {
    const std::string held = std::to_string(cut == 72 ? 0 : cut <= 24 ? 2 : 1);
    EXPECT_EQ(read(whole.substr(0, whole.size() - cut)).told,
              "points:1:1: error: the file ends after " + held + " vertices of 3\n  hint: it was cut off, or its header is wrong\n");
  }
  EXPECT_THAT(read(header("ascii", "element vertex 3\n" + xyz) + "1 2 3\n4 5 6\n").told, HasSubstr("points:9:1: error: the file ends after 2 vertices of 3"));
  // No memory is taken for what cannot be there.
  for (const char* count : {"2147483647", "2147483648", "1000000000000000000", "18446744073709551615"})
    for (const char* format : {"binary_little_endian", "ascii"})
      EXPECT_THAT(read(header(format, std::string("element vertex ") + count + "\n" + xyz)).told,
                  HasSubstr(std::string(count) == "2147483647" ? "error: the file ends after 0 vertices" : "vertices: from 1 to 2147483647 can be read")) << count;
  EXPECT_THAT(read(header("binary_little_endian", "element a 1000000000000000000\nproperty double q\nelement vertex 1\n" + xyz)).told, HasSubstr("the file ends after 0"));
  EXPECT_THAT(read(header("binary_little_endian", "element a 18446744073709551615\nproperty double q\nelement vertex 1\n" + xyz)).told,
              HasSubstr("an element of 18446744073709551615 parts before the vertices"));
  EXPECT_THAT(read(header("ascii", "element vertex 2\n" + xyz) + "1 2 3 4\n1 2\n").told,
              AllOf(HasSubstr("points:8:1: error: 4 numbers where a vertex has 3: \"1 2 3 4\""), HasSubstr("points:9:1: error: 2 numbers")));
}

TEST(Ply, RefusesWhatGoesOnBehindItsLastElement) {
  const auto longer = read(doubles(points) + std::string(5, '\0'));
  EXPECT_EQ(longer.cloud, nullptr);
  EXPECT_THAT(longer.told, HasSubstr("the file goes on for 5 bytes behind the last vertex, and the header has no element there"));
  // too few vertices announced, or a property forgotten
  std::string short_of_one = doubles(points);
  short_of_one.replace(short_of_one.find("vertex 3"), 8, "vertex 2");
  EXPECT_THAT(read(short_of_one).told, HasSubstr("goes on for 24 bytes"));
}

TEST(Ply, TellsWhatIsWrongWithAHeader) {
  const auto told = [](const std::string& elements) { return read(header("ascii", elements) + "1 2 3\n").told; };
  const std::string vertex = "element vertex 1\n";
  EXPECT_THAT(read("").told, HasSubstr("points:1:1: error: the file does not begin with the line \"ply\"\n  hint: is this a PLY file?"));
  EXPECT_THAT(read("x,y,z\n1,2,3\n").told, HasSubstr("does not begin with the line \"ply\""));
  EXPECT_THAT(read("ply\nformat ascii 1.0\n").told, HasSubstr("error: the header has no line \"end_header\""));
  EXPECT_THAT(read("ply\n" + std::string(20000, '\n')).told, HasSubstr("points:10001:1: error: the header has no line \"end_header\""));
  EXPECT_THAT(read("ply\n" + std::string(2000000, 'x')).told, HasSubstr("a line of more than a megabyte"));
  EXPECT_THAT(read("ply\n" + vertex + xyz + "end_header\n1 2 3\n").told, HasSubstr("error: the header has no line \"format\""));
  EXPECT_THAT(read("ply\nformat ascii 2.0\n").told, HasSubstr("points:2:1: error: \"format ascii 2.0\" is no format of PLY"));
  EXPECT_THAT(told(""), HasSubstr("error: the header has no element vertex\n  hint: its vertices are the points"));
  EXPECT_THAT(told("element face 2\n"), HasSubstr("no element vertex"));
  EXPECT_THAT(told("element vertex 0\n" + xyz), HasSubstr("error: 0 vertices: from 1 to 2147483647 can be read"));
  EXPECT_THAT(told("element vertex\n"), HasSubstr("points:3:1: error: \"element vertex\" is no element with a count\n  hint: element vertex 1000"));
  EXPECT_THAT(told("element vertex -3\n"), HasSubstr("\"element vertex -3\" is no element with a count"));
  EXPECT_THAT(told(vertex + xyz + vertex), HasSubstr("error: a second element vertex"));
  EXPECT_THAT(told(vertex + "property double x\nproperty double y\n"), HasSubstr("error: the element vertex has no property z"));
  EXPECT_THAT(told(vertex + "property int x\n"), HasSubstr("points:4:1: error: x is \"int\", not float or double"));
  EXPECT_THAT(told(vertex + xyz + "property float x\n"), HasSubstr("error: a second property x"));
  EXPECT_THAT(told(vertex + "property quad x\n"), HasSubstr("error: \"property quad x\" is no property\n  hint: property double x"));
  EXPECT_THAT(told(vertex + "property list uchar int q\n" + xyz), HasSubstr("error: a list in the element vertex: every vertex would have another length\n  hint: write the points without it, or as xyz"));
  EXPECT_THAT(read(header("binary_little_endian", "element face 1\nproperty list uchar int q\n" + vertex + xyz)).told, HasSubstr("a list before the vertices"));
  EXPECT_THAT(told("element face 1\nproperty list uchar int q\n" + vertex + xyz), HasSubstr("the file ends after 0 vertices of 1"));  // text: a line a face
  EXPECT_THAT(told("elment vertex 1\n"), HasSubstr("error: \"elment vertex 1\" is no line of a PLY header"));
  std::string properties = vertex;
  for (int i = 0; i < 1001; ++i) properties += "property char q\n";
  EXPECT_THAT(told(properties), HasSubstr("error: more than 1000 properties"));
}

TEST(Ply, TellsWhatTheSystemSays) {
  Findings findings;
  EXPECT_EQ(read_cloud({"/nowhere/at/all.ply", "ply"}, findings), nullptr);
  EXPECT_THAT(test::text_of(findings), HasSubstr("/nowhere/at/all.ply:1:1: error: cannot be read: No such file or directory"));
}

}  // namespace
}  // namespace sagitta::prescription
