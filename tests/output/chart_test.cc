// SPDX-License-Identifier: Apache-2.0
#include "lib/output/chart.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <boost/property_tree/xml_parser.hpp>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "tests/output/chart_support.h"
#include "tests/output/test_folder.h"

namespace sagitta::output {
namespace {

using ::testing::ElementsAre;

TEST(Chart, TheSvgIsWellFormedHasItsTitleAndIsTheSameBytesEachTime) {
  Chart chart = simple_chart();
  chart.title = "a < b & c > \"d\" \xEF\xBF\xBF \x1B µ";
  const std::string svg = chart_svg(chart);
  EXPECT_EQ(svg, chart_svg(chart));
  EXPECT_EQ(Drawing(svg).title, "a < b & c > \"d\" \uFFFD   µ");
  EXPECT_EQ(svg.find("<text"), std::string::npos);
  EXPECT_EQ(svg.find("<image"), std::string::npos);
  EXPECT_EQ(svg.find("surface"), std::string::npos);
}

TEST(Chart, ThePngIsTheSameDrawing) {
  const TestFolder folder;
  const Chart chart = simple_chart();
  const Raster raster = render_chart(chart);
  const Drawing drawing(chart_svg(chart));
  EXPECT_EQ(raster.width, drawing.width);
  EXPECT_EQ(raster.height, drawing.height);
  const auto all = markers(drawing, blue);
  ASSERT_EQ(all.size(), 4U);  // and one in the legend
  for (const Path& marker : all) EXPECT_EQ(pixel(raster, static_cast<int>(marker.middle().x), static_cast<int>(marker.middle().y)), 0x0072B2U);
  EXPECT_EQ(raster.pixels, render_chart(chart).pixels);
  EXPECT_EQ(write_png(folder / "a.png", raster).error, "");
}

TEST(Chart, PointsStandWhereTheirLogarithmsAre) {
  const Drawing drawing(chart_svg(simple_chart()));
  const auto all = markers(drawing, blue);
  ASSERT_EQ(all.size(), 4U);
  const ChartPoint a = all[0].middle(), b = all[1].middle(), c = all[2].middle();
  EXPECT_NEAR(b.x - a.x, c.x - b.x, rounding);
  EXPECT_NEAR(b.y - a.y, c.y - b.y, rounding);
  // Two decades of the plot's 580 x 430 pixels, with 7 % of room.
  EXPECT_NEAR(c.x - a.x, 580 / 1.07, rounding);
  EXPECT_NEAR(a.y - c.y, 430 / 1.07, rounding);
  const ChartPoint middle = frame(drawing).middle();
  EXPECT_NEAR(b.x, middle.x, rounding);
  EXPECT_NEAR(b.y, middle.y, rounding);
}

TEST(Chart, ARangeOfLessThanADecadeIsShownInOne) {
  Chart chart = simple_chart();
  chart.series = {series("a", {{20, 5}, {40, 5}})};
  const auto all = markers(Drawing(chart_svg(chart)), blue);
  ASSERT_EQ(all.size(), 3U);
  EXPECT_NEAR(all[1].middle().x - all[0].middle().x, 580 * std::log10(2.0), rounding);
}

TEST(Chart, TwelveSeriesDifferWithoutColourAndThirtySixWithIt) {
  Chart chart = simple_chart();
  chart.series.clear();
  for (int i = 0; i < 36; ++i) chart.series.push_back(series("s", {{1, 1.0 + i}}, false));
  const Drawing drawing(chart_svg(chart));
  const double right = frame(drawing).high(&ChartPoint::x);
  std::map<double, std::string> by_row;  // of the legend, by the middle of its marker
  for (const Path& path : drawing.paths) {
    if (path.points.empty() || path.low(&ChartPoint::x) <= right) continue;
    std::string& sample = by_row[std::round(path.middle().y / 3)];  // triangles' middles are off by a pixel; rows are 20 apart
    sample += path.style;
    for (const ChartPoint& point : path.points)
      sample += " " + std::to_string(std::lround(point.x - right)) + "," + std::to_string(std::lround(point.y - path.middle().y));
  }
  ASSERT_EQ(by_row.size(), 36U);
  std::set<std::string> with_color, without;
  const std::regex color("rgb\\((?!100%,100%,100%)[^)]*\\)");
  for (const auto& [row, sample] : by_row) {
    if (with_color.size() < 12) without.insert(std::regex_replace(sample, color, "ink"));
    with_color.insert(sample);
  }
  EXPECT_EQ(with_color.size(), 36U);
  EXPECT_EQ(without.size(), 12U);
}

TEST(Chart, TheLegendIsBesideThePlotAndThePointsAreInside) {
  Chart chart = simple_chart();
  chart.series.push_back(series("b", {{3, 30}, {4, 40}}, false));
  const Drawing drawing(chart_svg(chart));
  const Path plot = frame(drawing);
  for (const auto& [color, count] : {std::pair{blue, 3}, std::pair{orange, 2}}) {
    int inside = 0, beside = 0;
    for (const Path& marker : markers(drawing, color)) {
      if (marker.low(&ChartPoint::x) > plot.high(&ChartPoint::x))
        ++beside;
      else if (marker.low(&ChartPoint::x) > plot.low(&ChartPoint::x) && marker.low(&ChartPoint::y) > plot.low(&ChartPoint::y) &&
               marker.high(&ChartPoint::x) < plot.high(&ChartPoint::x) && marker.high(&ChartPoint::y) < plot.high(&ChartPoint::y))
        ++inside;
    }
    EXPECT_EQ(inside, count);
    EXPECT_EQ(beside, 1);
  }
  // Lines of the first series: of its points, and in the legend.
  EXPECT_EQ(drawing.of([](const Path& path) { return path.is_open_line() && path.has("stroke:" + blue); }).size(), 2U);
  EXPECT_TRUE(drawing.of([](const Path& path) { return path.is_open_line() && path.has("stroke:" + orange); }).empty());
}

TEST(Chart, WhatALogarithmicAxisHasNoPlaceForIsLeftOutAndCounted) {
  const std::string rest = " not shown: a logarithmic axis has no place for 0, negative or missing values.";
  Chart good = simple_chart();
  good.footer = "1 point is" + rest;
  int checked = 0;
  for (const double bad : {0.0, -1.0, nan, inf, -inf, 1e-310, 1e301})
    for (const ChartPoint& point : {ChartPoint{bad, 20}, ChartPoint{20, bad}}) {
      Chart chart = simple_chart();
      chart.series[0].points.push_back(point);
      EXPECT_EQ(chart_svg(chart), chart_svg(good)) << point.x << " " << point.y;
      ++checked;
    }
  EXPECT_EQ(checked, 14);

  Chart chart = simple_chart();
  chart.series[0].points.insert(chart.series[0].points.begin(), 3, {0, nan});
  chart.references = {{false, -1, "below"}, {true, nan, "nowhere"}};
  chart.series[0].fit = PowerLaw{1, 400, 1e-2, 10, "too steep"};
  good.series.push_back(good.series[0]);
  chart.series.push_back(good.series[0]);
  chart.series[1].points.push_back({-1, 1});
  good.footer = "4 points and 3 lines are" + rest;
  EXPECT_EQ(chart_svg(chart), chart_svg(good));
}

TEST(Chart, AValueThatIsMissingInterruptsTheLine) {
  Chart chart = simple_chart();
  chart.series[0].points = {{1, 10}, {2, 20}, {3, 0}, {4, 40}, {5, 50}, {6, 60}, {7, nan}, {8, 80}};
  const auto lines = Drawing(chart_svg(chart)).of([](const Path& path) { return path.is_open_line() && path.has("stroke:" + blue); });
  std::vector<std::size_t> lengths;
  for (const Path& line : lines) lengths.push_back(line.points.size());
  EXPECT_THAT(lengths, ElementsAre(2, 3, 2));  // the last is in the legend
}

TEST(Chart, AFittedLineIsDashedFromEndToEndAndHasItsEntry) {
  Chart chart = simple_chart();
  chart.series[0].is_joined = false;
  chart.series[0].fit = PowerLaw{10, 1, 1, 100, "order 1.00"};  // through all points
  const Drawing drawing(chart_svg(chart));
  const auto lines = drawing.of([](const Path& path) { return path.is_dashed(); });
  ASSERT_EQ(lines.size(), 2U);
  const auto all = markers(drawing, blue);
  ASSERT_EQ(all.size(), 4U);
  for (const std::size_t i : {0U, 1U}) {
    EXPECT_TRUE(lines[i].has("stroke:" + blue));
    ASSERT_EQ(lines[i].points.size(), 2U);
    EXPECT_NEAR(lines[0].points[i].x, all[2 * i].middle().x, rounding);
    EXPECT_NEAR(lines[0].points[i].y, all[2 * i].middle().y, rounding);
  }
  EXPECT_GT(lines[1].low(&ChartPoint::x), frame(drawing).high(&ChartPoint::x));
  EXPECT_GT(lines[1].low(&ChartPoint::y), all[3].middle().y + 10);

  // One that reaches farther than the points widens the axes.
  chart.series[0].fit->high = 1e4;
  const auto narrower = markers(Drawing(chart_svg(chart)), blue);
  EXPECT_NEAR(narrower[2].middle().x - narrower[0].middle().x, 580 / 1.07 / 2, rounding);
}

TEST(Chart, LinesOfReferenceCrossThePlotAndTheirLabelsCoverLeast) {
  Chart chart = simple_chart();
  chart.series[0].is_joined = false;
  chart.references = {{false, 100, "a label"}, {true, 10, "another"}};
  for (const bool is_rising : {true, false}) {
    // Points right above the horizontal line's right half and right of the upright one's upper half, or the other way round.
    chart.series[0].points = {{1, 10}, {100, 1000}};
    for (double t = 0.02; t < 0.98; t += 0.02) chart.series[0].points.push_back({std::pow(10.0, is_rising ? 1 + t : t), is_rising ? 112 : 89.3});
    for (double t = 0.02; t < 0.98; t += 0.02) chart.series[0].points.push_back({is_rising ? 10.9 : 9.2, std::pow(10.0, is_rising ? 2 + t : 1 + t)});
    const Drawing drawing(chart_svg(chart));
    const Path plot = frame(drawing);
    const auto lines = drawing.of([](const Path& path) { return path.is_dashed() && path.has("stroke:" + grey); });
    ASSERT_EQ(lines.size(), 2U);
    EXPECT_NEAR(lines[0].high(&ChartPoint::x) - lines[0].low(&ChartPoint::x), 580, rounding);
    EXPECT_NEAR(lines[0].high(&ChartPoint::y), plot.middle().y, rounding);
    EXPECT_NEAR(lines[1].high(&ChartPoint::y) - lines[1].low(&ChartPoint::y), 430, rounding);
    EXPECT_NEAR(lines[1].high(&ChartPoint::x), plot.middle().x, rounding);
    const auto labels = drawing.of([](const Path& path) { return path.has("stroke:none") && path.has("fill:" + grey); });
    ASSERT_EQ(labels.size(), 2U);
    for (const Path& label : labels) {
      EXPECT_GT(label.low(&ChartPoint::x), plot.low(&ChartPoint::x));
      EXPECT_LT(label.high(&ChartPoint::x), plot.high(&ChartPoint::x));
      EXPECT_GT(label.low(&ChartPoint::y), plot.low(&ChartPoint::y));
      EXPECT_LT(label.high(&ChartPoint::y), plot.high(&ChartPoint::y));
      for (const Path& marker : markers(drawing, blue))
        EXPECT_TRUE(marker.low(&ChartPoint::x) > label.high(&ChartPoint::x) || marker.high(&ChartPoint::x) < label.low(&ChartPoint::x) ||
                    marker.low(&ChartPoint::y) > label.high(&ChartPoint::y) || marker.high(&ChartPoint::y) < label.low(&ChartPoint::y));
    }
  }
}

TEST(Chart, ALabelIsAtTheEndOfItsLineWhereNothingIsInTheWayAndALineBeyondThePointsWidensTheAxes) {
  Chart chart = simple_chart();
  chart.references = {{false, 1e4, "a label"}, {true, 1e4, "another"}};
  const Drawing drawing(chart_svg(chart));
  const Path plot = frame(drawing);
  const auto labels = drawing.of([](const Path& path) { return path.has("stroke:none") && path.has("fill:" + grey); });
  ASSERT_EQ(labels.size(), 2U);
  // The axes end 3.5 % of their length beyond the lines: less than a label needs.
  const double top = plot.middle().y - 430 / 1.07 / 2, right = plot.middle().x + 580 / 1.07 / 2;
  const auto lines = drawing.of([](const Path& path) { return path.is_dashed(); });
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_NEAR(lines[0].middle().y, top, rounding);
  EXPECT_NEAR(lines[1].middle().x, right, rounding);
  EXPECT_GT(labels[0].low(&ChartPoint::y), top);
  EXPECT_NEAR(labels[1].high(&ChartPoint::x), right - 5, 1.5);  // letters' bearings

  chart.references = {{false, 50, "a label"}};
  const Drawing other(chart_svg(chart));
  const auto label = other.of([](const Path& path) { return path.has("stroke:none") && path.has("fill:" + grey); });
  ASSERT_EQ(label.size(), 1U);
  EXPECT_NEAR(label[0].high(&ChartPoint::x), frame(other).high(&ChartPoint::x) - 5, 1.5);
  EXPECT_LT(label[0].high(&ChartPoint::y), other.of([](const Path& path) { return path.is_dashed(); })[0].middle().y);
}

TEST(Chart, NothingReachesIntoTheMargins) {
  std::string endless, words;
  for (int i = 0; i < 300; ++i) {
    endless += "W";
    words += "long ";
  }
  for (const std::string& text : {endless, words, std::string("\xff\x1b broken \n bytes \xEF\xBF\xBE"), std::string()}) {
    for (const double size : {1e-200, 1.0}) {
      Chart chart{text, text, text, text, {}, {{false, 3 * size, text}, {true, 2e-3 * size, text}}, text};
      for (int i = 0; i < 40; ++i) {
        chart.series.push_back(series(text, {{size, size * (1 + i)}, {1e-4 * size, size}, {size, nan}}));
        chart.series.back().fit = PowerLaw{1, 1, 1e-3 * size, size, text};
      }
      for (const bool is_empty : {false, true}) {
        if (is_empty)
          for (ChartSeries& one : chart.series) one.points.clear();
        const Raster raster = render_chart(chart);
        ASSERT_GT(raster.width, 600);
        int inked = 0, outside = 0;
        for (int y = 0; y < raster.height; ++y)
          for (int x = 0; x < raster.width; ++x) {
            if (pixel(raster, x, y) == 0xFFFFFF) continue;
            ++inked;
            outside += x < 18 || y < 18 || x >= raster.width - 18 || y >= raster.height - 18;
          }
        EXPECT_GT(inked, 5000);
        EXPECT_EQ(outside, 0);
        const Drawing drawing(chart_svg(chart));
        for (const ChartPoint& letter : drawing.letters) {
          EXPECT_TRUE(letter.x >= 18 && letter.x <= drawing.width - 18) << letter.x;
          EXPECT_TRUE(letter.y >= 18 && letter.y <= drawing.height - 18) << letter.y;
        }
        for (const Path& path : drawing.paths) {
          if (path.points.empty()) continue;  // blanks
          EXPECT_GE(path.low(&ChartPoint::x), 0);
          EXPECT_LE(path.high(&ChartPoint::x), drawing.width);
          EXPECT_GE(path.low(&ChartPoint::y), 0);
          EXPECT_LE(path.high(&ChartPoint::y), drawing.height);
        }
      }
    }
  }
}

TEST(Chart, AnEmptyChartSaysSo) {
  const auto greys = [](const Chart& chart) {
    const Raster raster = render_chart(chart);
    return std::count_if(raster.pixels.begin(), raster.pixels.end(), [](std::uint32_t one) { return (one & 0xFFFFFFU) == pixel_of(no_data_color); });
  };
  Chart chart{"", "", "x", "y", {}, {{false, 1, ""}}, ""};
  const auto without_note = greys(chart);
  EXPECT_NEAR(static_cast<double>(without_note), 580 * 430 + 30, 30);  // and a few in letters' edges
  chart.empty_note = "no variant has run";
  EXPECT_LT(greys(chart), without_note - 100);
  chart.series = {series("a", {{0, 1}})};
  EXPECT_LT(greys(chart), without_note - 100);
  chart.series = {series("a", {{1, 1}})};
  EXPECT_LT(greys(chart), 1000);
}

TEST(Chart, SeriesBeyondThirtySixAreCounted) {
  Chart chart = simple_chart();
  chart.series.assign(37, chart.series[0]);
  Chart fewer = chart;
  fewer.series.pop_back();
  fewer.footer = "36 of 37 series are shown.";
  EXPECT_EQ(chart_svg(chart), chart_svg(fewer));
}

}  // namespace
}  // namespace sagitta::output
