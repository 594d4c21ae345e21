// SPDX-License-Identifier: Apache-2.0
#include "lib/output/media_report.h"

#include <gtest/gtest.h>

namespace sagitta::output {
namespace {

const std::vector<ChartPoint> measured{{458, 1.43}, {543, 1.422}, {633, 1.418}};

bool same(const std::vector<ChartPoint>& a, const std::vector<ChartPoint>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const ChartPoint& p, const ChartPoint& q) { return p.x == q.x && p.y == q.y; });
}

MediumReport medium(bool is_table, std::vector<MediumValue> values) {
  MediumReport one;
  one.name = "lens";
  one.is_table = is_table;
  one.values = std::move(values);
  return one;
}

TEST(MediaChart, MarksTheMeasuredPointsOfATableAndNoOthers) {
  const Chart chart = media_chart({medium(true, {{"d", 587.6, 1.42}})}, {measured}, "1");
  ASSERT_EQ(chart.series.size(), 1u);
  EXPECT_TRUE(same(chart.series[0].points, measured));
  EXPECT_TRUE(same(chart.series[0].curve, measured));
  EXPECT_EQ(chart.footer, "markers of tables: the measured wavelengths; sagitta 1");
}

TEST(MediaChart, MarksWhatIsAskedFor) {
  const Chart chart = media_chart({medium(true, {{"", 500, 1.425}})}, {measured}, "1");
  EXPECT_TRUE(same(chart.series[0].points, {{500, 1.425}}));
  EXPECT_EQ(chart.footer, "markers: the wavelengths asked for; sagitta 1");
}

TEST(MediaChart, MarksAFormulaHereAndThere) {
  std::vector<ChartPoint> curve;
  for (int i = 0; i <= 600; ++i) curve.push_back({400. + i, 1.5});
  const Chart chart = media_chart({medium(false, {})}, {curve}, "1");
  EXPECT_EQ(chart.series[0].points.size(), 6u);
  EXPECT_EQ(chart.footer, "sagitta 1");
}

}  // namespace
}  // namespace sagitta::output
