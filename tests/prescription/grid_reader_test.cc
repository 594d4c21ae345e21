// SPDX-License-Identifier: Apache-2.0
#include "lib/prescription/grid_reader.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "lib/surface/grid.h"
#include "tests/prescription/support.h"

namespace sagitta::prescription {
namespace {

using testing::HasSubstr;

struct GridRead {
  std::shared_ptr<const SagGrid> grid;
  std::string told;  // all findings, the folder taken off
};
GridRead read(const std::string& bytes, const std::string& format = "zemax") {
  const test::TemporaryFolder folder;
  Findings findings;
  GridRead result{read_grid({folder.write("grid", bytes), format}, findings), test::text_of(findings)};
  for (std::size_t at; (at = result.told.find(folder.path() + "/")) != std::string::npos;) result.told.erase(at, folder.path().size() + 1);
  EXPECT_EQ(result.grid == nullptr, findings.has_errors()) << result.told;
  return result;
}

// `count` times the line.
std::string times(int count, const std::string& line) {
  std::string text;
  for (int i = 0; i < count; ++i) text += line + "\n";
  return text;
}

TEST(GridFormats, AreTheChoicesOfTheKey) {
  const auto& keys = surface::BicubicGrid::keys;
  const auto format = std::find_if(keys.begin(), keys.end(), [](const auto& key) { return key.name == "format"; });
  ASSERT_NE(format, keys.end());
  EXPECT_EQ(grid_formats(), format->choices);
  EXPECT_THAT(read("", "sur").told, HasSubstr("error: \"sur\" is no format of grids\n  hint: one of zemax|xyz"));
}

// From the top left corner on, row by row; stored from the lowest.
TEST(ZemaxGrid, HasItsRowsFromTheTop) {
  std::string text = "! a comment\n\n 6 5 0.5 0.25 0 1 -2   ! and one more\n";
  for (int k = 0; k < 30; ++k) text += fmt::format("{} {} {} {} {}\r\n", k, k + .1, k + .2, k + .3, k == 29 ? "" : "0");
  const GridRead result = read("\xEF\xBB\xBF" + text + "\n! the end");
  EXPECT_EQ(result.told, "");
  ASSERT_TRUE(result.grid);
  const SagGrid& grid = *result.grid;
  EXPECT_EQ(grid.count_x, 6);
  EXPECT_EQ(grid.count_y, 5);
  EXPECT_EQ(grid.first_x, 1 - 1.25);
  EXPECT_EQ(grid.first_y, -2 - .5);
  EXPECT_EQ(grid.spacing_x, .5);
  EXPECT_EQ(grid.spacing_y, .25);
  EXPECT_TRUE(grid.has_given_slopes);
  ASSERT_EQ(grid.nodes.size(), 30u);
  for (int row = 0; row < 5; ++row)
    for (int i = 0; i < 6; ++i) {
      const SagGrid::Node& node = grid.nodes[static_cast<std::size_t>(row * 6 + i)];
      const double k = (4 - row) * 6 + i;
      EXPECT_EQ(node.z, k);
      EXPECT_EQ(node.dz_dx, k + .1);
      EXPECT_EQ(node.dz_dy, k + .2);
      EXPECT_EQ(node.d2z_dxdy, k + .3);
    }
}

// Slopes have no unit, twists its inverse; of spacings the size counts.
TEST(ZemaxGrid, IsInMillimetresCentimetresInchesOrMetres) {
  for (const auto& [flag, mm] : {std::pair{"0", 1.0}, {"1.0", 10.0}, {"2", 25.4}, {"3", 1000.0}}) {
    const GridRead result = read(fmt::format("5 5 -0.5 0.25 {} 2 3\n", flag) + times(25, "7 0.5 0.25 2"));
    ASSERT_TRUE(result.grid) << result.told;
    EXPECT_EQ(result.grid->spacing_x, .5 * mm);
    EXPECT_EQ(result.grid->spacing_y, .25 * mm);
    EXPECT_DOUBLE_EQ(result.grid->first_x, mm);
    EXPECT_DOUBLE_EQ(result.grid->first_y, 2.5 * mm);
    EXPECT_EQ(result.grid->nodes[3].z, 7 * mm);
    EXPECT_EQ(result.grid->nodes[3].dz_dx, .5);
    EXPECT_EQ(result.grid->nodes[3].dz_dy, .25);
    EXPECT_EQ(result.grid->nodes[3].d2z_dxdy, 2 / mm);
  }
}

TEST(ZemaxGrid, HasNoSlopesWhereAllAreZeroOrLeftOut) {
  const std::string header = "5 5 1 1 0 0 0\n";
  for (const char* line : {"3", "3 0 0 0", "3 0.0 -0 0e5 0"}) EXPECT_FALSE(read(header + times(25, line)).grid->has_given_slopes) << line;
  for (const char* line : {"3 1e-9 0 0", "3 0 1e-9 0", "3 0 0 1e-9 0"}) EXPECT_TRUE(read(header + times(24, "3") + line + "\n").grid->has_given_slopes) << line;
  // those of a node without data are nothing
  EXPECT_FALSE(read(header + times(24, "3") + "0 1 1 1 1\n").grid->has_given_slopes);
}

TEST(ZemaxGrid, HasNoDataWhereItIsFlaggedOrNan) {
  const GridRead result = read("5 5 1 1 0 0 0\n" + times(5, "3") + "4 1 1 1 1\n" + times(5, "3 0 0 0 0") + "nan\n" + times(13, "3"));
  EXPECT_EQ(result.told, "grid:7:1: note: 2 lines without data (flagged, or z is nan), the first one here: cells around it are holes\n");
  int count = 0;
  for (const SagGrid::Node& node : result.grid->nodes) count += std::isnan(node.z);
  EXPECT_EQ(count, 2);
  EXPECT_TRUE(std::isnan(result.grid->nodes[3 * 5].z));
  EXPECT_TRUE(std::isnan(result.grid->nodes[2 * 5 + 1].z));
}

TEST(ZemaxGrid, TellsWhatIsWrongWhereItIs) {
  EXPECT_THAT(read("").told, HasSubstr("error: holds no grid\n  hint: a line nx ny delx dely unitflag xdec ydec, then one for each node"));
  EXPECT_THAT(read("! nothing\n\n").told, HasSubstr("error: holds no grid"));
  EXPECT_THAT(read("5 5 1 1 0\n").told, HasSubstr("grid:1:1: error: 5 numbers where 7 are needed: \"5 5 1 1 0\""));
  EXPECT_THAT(read("4 5 1 1 0 0 0\n").told, HasSubstr("grid:1:1: error: nx is no whole number from 5 to 100000: \"4\""));
  EXPECT_THAT(read("5 100001 1 1 0 0 0\n").told, HasSubstr("grid:1:3: error: ny is no whole number from 5 to 100000: \"100001\""));
  EXPECT_THAT(read("5 5 1e-16 1 0 0 0\n").told, HasSubstr("grid:1:5: error: delx is below 1e-15: \"1e-16\""));
  EXPECT_THAT(read("5 5 1 1 0.5 0 0\n").told, HasSubstr("grid:1:9: error: unitflag is none of 0 (mm), 1 (cm), 2 (in) and 3 (m): \"0.5\""));
  EXPECT_THAT(read("5 5 1 1 0 nan 0\n").told, HasSubstr("grid:1:11: error: xdec is no number: \"nan\""));
  EXPECT_THAT(read("5 5 1 1 0 0 1e16\n").told, HasSubstr("grid:1:13: error: ydec is beyond 1e+15: \"1e16\""));
  EXPECT_THAT(read("5 5 1 1 0 0 0\n" + times(24, "1")).told, HasSubstr("grid:25:1: error: the file ends after 24 nodes of 5 x 5 = 25"));
  EXPECT_THAT(read("5 5 1 1 0 0 0\n" + times(26, "1")).told, HasSubstr("grid:27:1: error: more nodes than the first line announces: 5 x 5 = 25"));
  EXPECT_THAT(read("5 5 1 1 0 0 0\n1 2\n" + times(24, "1")).told, HasSubstr("grid:2:1: error: 2 numbers where 1, 4 or 5 are needed: \"1 2\""));
  EXPECT_THAT(read("5 5 1 1 0 0 0\n1 0 nan 0\n" + times(24, "1")).told, HasSubstr("grid:2:5: error: dz/dy is no number: \"nan\""));
  EXPECT_THAT(read("5 5 1 1 0 0 0\n-1e101 0 0 0\n" + times(24, "1")).told, HasSubstr("grid:2:1: error: z is beyond 1e+100: \"-1e101\""));
  EXPECT_THAT(read("5 5 1 1 0 0 0\n1 0 0 0 x\n" + times(24, "1")).told, HasSubstr("grid:2:9: error: nodata is no number: \"x\""));
  EXPECT_THAT(read("5 5 1 1 0 0 0\n1 0 0 0\0\n").told, HasSubstr("the file ends"));
  EXPECT_THAT(read(std::string("5 5 1 1 0 0 0\n1\0 0", 18)).told, HasSubstr("grid:2:1: error: a zero byte"));
}

// Every second column flagged: no four corners are left.
TEST(ZemaxGrid, NeedsACellWithDataAtItsCorners) {
  std::string nodes;
  for (int k = 0; k < 25; ++k) nodes += fmt::format("1 0 0 0 {}\n", k % 5 % 2);
  EXPECT_THAT(read("5 5 1 1 0 0 0\n" + nodes).told, HasSubstr("error: no cell of the grid has data at its four corners"));
  // the last of a row and the first of the next are no neighbours
  std::string ends;
  for (int k = 0; k < 25; ++k) ends += fmt::format("1 0 0 0 {}\n", static_cast<int>(k % 5 > 0 && k % 5 < 4));
  EXPECT_THAT(read("5 5 1 1 0 0 0\n" + ends).told, HasSubstr("no cell of the grid"));
}

// In any order, rounded to three decimals, with what is missing.
TEST(XyzGrid, FindsTheGridOfItsPoints) {
  std::string text = "z,x,y\n";
  for (int k = 0; k < 42; ++k) {
    const int node = k * 19 % 42, i = node % 6, j = node / 6;
    if (node == 8) continue;
    text += node == 20 ? fmt::format(",{:.5f},{:.5f}\n", i / 3.0 - 1, j * .25 + 2) : fmt::format("{},{:.5f},{:.5f}\n", 10 * i + j, i / 3.0 - 1, j * .25 + 2);
  }
  const GridRead result = read(text + "5,nan,1\n", "xyz");
  EXPECT_EQ(result.told, "grid:43:1: note: 1 line without a place (x or y is nan or empty), the first one here: left out\n"
                         "grid:1:1: note: 2 of 42 nodes have no z: cells around them are holes\n");
  const SagGrid& grid = *result.grid;
  EXPECT_EQ(grid.count_x, 6);
  EXPECT_EQ(grid.count_y, 7);
  EXPECT_NEAR(grid.spacing_x, 1 / 3.0, 1e-5);
  EXPECT_EQ(grid.spacing_y, .25);
  EXPECT_EQ(grid.first_x, -1);
  EXPECT_EQ(grid.first_y, 2);
  EXPECT_FALSE(grid.has_given_slopes);
  for (int node = 0; node < 42; ++node) {
    const double z = grid.nodes[static_cast<std::size_t>(node)].z;
    if (node == 8 || node == 20) {
      EXPECT_TRUE(std::isnan(z));
    } else {
      EXPECT_EQ(z, 10 * (node % 6) + node / 6);
    }
  }
}

TEST(XyzGrid, RefusesWhatIsNoGrid) {
  std::string grid, scattered;
  for (int i = 0; i < 5; ++i)
    for (int j = 0; j < 5; ++j) grid += fmt::format("{} {} 0\n", i, j);
  for (int k = 0; k < 100; ++k) scattered += fmt::format("{} {} 0\n", std::sin(k), std::cos(2 * k + 1));
  EXPECT_EQ(read(grid, "xyz").told, "");
  EXPECT_THAT(read(scattered, "xyz").told, HasSubstr("error: 100 points with 100 different x and 100 different y are no regular grid\n  hint: a grid has from 5 to 100000 of each; delaunay takes"));
  EXPECT_THAT(read("0 0 0\n1 0 0\n", "xyz").told, HasSubstr("2 points with 2 different x and 1 different y are no regular grid"));
  EXPECT_THAT(read(grid + "2.3 1 0\n", "xyz").told, HasSubstr("grid:6:1: error: (1, 0) lies on no node of a grid of 6 x 5"));
  EXPECT_THAT(read(grid + "2 1 0\n", "xyz").told, HasSubstr("grid:26:1: error: a second point at (2, 1)\n  hint: the first is in line 12"));
  EXPECT_THAT(read(grid + "2 1e16 0\n", "xyz").told, HasSubstr("grid:26:1: error: x and y go to 1e+15 mm, z to 1e+100"));
  EXPECT_THAT(read("# empty\n", "xyz").told, HasSubstr("holds no points"));
  EXPECT_THAT(read("1 2\n", "xyz").told, HasSubstr("2 columns where 3 are needed"));
}

}  // namespace
}  // namespace sagitta::prescription
