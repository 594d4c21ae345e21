// SPDX-License-Identifier: Apache-2.0
// Charts with linear axes, and curves.
#include <gmock/gmock.h>

#include "tests/output/chart_support.h"

namespace sagitta::output {
namespace {

using ::testing::ElementsAre;

TEST(Chart, OnLinearAxesPointsStandWhereTheirValuesAre) {
  Chart chart = simple_chart();
  chart.x_scale = chart.y_scale = AxisScale::linear;
  chart.series = {series("a", {{-10, 0}, {0, -2.5}, {30, -10}})};
  const Drawing drawing(chart_svg(chart));
  const auto all = markers(drawing, blue);
  ASSERT_EQ(all.size(), 4U);
  const ChartPoint a = all[0].middle(), b = all[1].middle(), c = all[2].middle();
  // A quarter of the way, the ends 7 % off; y grows upward.
  EXPECT_NEAR(c.x - a.x, 580 / 1.07, rounding);
  EXPECT_NEAR(b.x - a.x, 580 / 1.07 / 4, rounding);
  EXPECT_NEAR(c.y - a.y, 430 / 1.07, rounding);
  EXPECT_NEAR(b.y - a.y, 430 / 1.07 / 4, rounding);
  EXPECT_NEAR((a.x + c.x) / 2, frame(drawing).middle().x, rounding);

  // One axis of each kind; a value alone lies in the middle, with room around it.
  chart.x_scale = AxisScale::logarithmic;
  chart.series = {series("a", {{1, -2}, {10, -2}, {100, -2}})};
  const Drawing mixed(chart_svg(chart));
  const auto row = markers(mixed, blue);
  ASSERT_EQ(row.size(), 4U);
  EXPECT_NEAR(row[1].middle().x - row[0].middle().x, row[2].middle().x - row[1].middle().x, rounding);
  EXPECT_NEAR(row[0].middle().y, frame(mixed).middle().y, rounding);
}

TEST(Chart, ALinearAxisHasNoPlaceForMissingValuesAlone) {
  Chart good = simple_chart();
  good.x_scale = good.y_scale = AxisScale::linear;
  good.footer = "1 point is not shown: no axis has a place for missing values.";
  int checked = 0;
  for (const double bad : {nan, inf, -inf, 1e301, -1e301}) {
    Chart chart = good;
    chart.footer = "";
    chart.series[0].points.push_back({bad, 20});
    EXPECT_EQ(chart_svg(chart), chart_svg(good)) << bad;
    ++checked;
  }
  EXPECT_EQ(checked, 5);
}

TEST(Chart, ACurveIsDrawnInPlaceOfTheLineThroughThePointsAndWithoutMarkers) {
  Chart chart = simple_chart();
  chart.series[0].points = {{10, 100}};
  for (int i = 0; i <= 20; ++i)  // no two pieces in one line: Cairo would join them
    chart.series[0].curve.push_back({std::pow(10.0, 0.1 * i), std::pow(10.0, 1 + 0.1 * i + (i % 2 == 0 ? 0 : 0.01))});
  chart.series[0].curve[5] = {nan, nan};
  const Drawing drawing(chart_svg(chart));
  EXPECT_EQ(markers(drawing, blue).size(), 2U);  // the point's, and one in the legend
  std::vector<std::size_t> lengths;
  for (const Path& line : drawing.of([](const Path& path) { return path.is_open_line() && path.has("stroke:" + blue); })) lengths.push_back(line.points.size());
  EXPECT_THAT(lengths, ElementsAre(5, 15, 2));
  EXPECT_NEAR(markers(drawing, blue)[0].middle().x, frame(drawing).middle().x, rounding);  // the curve spans the axes
}

}  // namespace
}  // namespace sagitta::output
