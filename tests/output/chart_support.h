// SPDX-License-Identifier: Apache-2.0
// What the tests of charts share: an SVG file as the paths that it draws.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <boost/property_tree/xml_parser.hpp>
#include <cmath>
#include <functional>
#include <limits>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "lib/output/chart.h"

namespace sagitta::output {

inline constexpr double inf = std::numeric_limits<double>::infinity();
inline constexpr double nan = std::numeric_limits<double>::quiet_NaN();
// Cairo keeps coordinates in 1/256 of a pixel: a difference of two middles, each of two, is off by 2/256 at most.
inline constexpr double rounding = 2.0 / 256;
// Of the first series and of lines of reference, as Cairo writes them: 114/255 and 178/255; 92/255.
inline const std::string blue = "rgb(0%,44.705882%,69.803922%)", orange = "rgb(83.529412%,36.862745%,0%)", grey = "rgb(36.078431%,36.078431%,36.078431%)";

using Tree = boost::property_tree::ptree;

inline Tree parsed(const std::string& svg) {
  std::istringstream file(svg);
  Tree tree;
  read_xml(file, tree);
  return tree;
}

struct Path {
  std::string style;
  std::vector<ChartPoint> points;  // of curves, those that pull them too
  double low(double ChartPoint::*axis) const {
    double least = inf;
    for (const ChartPoint& point : points) least = std::min(least, point.*axis);
    return least;
  }
  double high(double ChartPoint::*axis) const {
    double most = -inf;
    for (const ChartPoint& point : points) most = std::max(most, point.*axis);
    return most;
  }
  ChartPoint middle() const {
    return {(low(&ChartPoint::x) + high(&ChartPoint::x)) / 2, (low(&ChartPoint::y) + high(&ChartPoint::y)) / 2};
  }
  bool has(const std::string& part) const { return style.find(part) != std::string::npos; }
  bool is_dashed() const { return has("stroke-dasharray"); }
  bool is_open_line() const { return style.starts_with("fill:none"); }
};

// Cairo leaves what it likes in the byte above red.
inline std::uint32_t pixel(const Raster& raster, int x, int y) {
  return raster.pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(raster.width) + static_cast<std::size_t>(x)] & 0xFFFFFFU;
}

// What a file draws: its paths outside of the letters' outlines, and where its letters stand.
struct Drawing {
  double width = 0, height = 0;
  std::string title;
  std::vector<Path> paths;
  std::vector<ChartPoint> letters;

  explicit Drawing(const std::string& svg) {
    const Tree tree = parsed(svg);
    const Tree& root = tree.get_child("svg");
    width = number(root, "width");
    height = number(root, "height");
    title = root.get<std::string>("title");
    collect(root);
  }
  std::vector<Path> of(const std::function<bool(const Path&)>& wanted) const {
    std::vector<Path> found;
    std::copy_if(paths.begin(), paths.end(), std::back_inserter(found), wanted);
    return found;
  }

 private:
  static double number(const Tree& element, const std::string& name) { return std::stod(element.get<std::string>("<xmlattr>." + name)); }
  void collect(const Tree& tree) {
    for (const auto& [name, element] : tree) {
      if (name == "use") letters.push_back({number(element, "x"), number(element, "y")});
      if (name == "path") {
        Path path{element.get<std::string>("<xmlattr>.style"), {}};
        EXPECT_FALSE(element.get_optional<std::string>("<xmlattr>.transform"));
        std::istringstream words(std::regex_replace(element.get<std::string>("<xmlattr>.d"), std::regex("[A-Z]"), " "));
        for (ChartPoint point; words >> point.x >> point.y;) path.points.push_back(point);
        paths.push_back(path);
      }
      if (name != "defs") collect(element);
    }
  }
};

inline ChartSeries series(const std::string& name, const std::vector<ChartPoint>& points, bool is_joined = true) { return {name, points, is_joined, std::nullopt}; }

// From 1 to 100 and 10 to 1000, in whole powers.
inline Chart simple_chart() { return {"Error against time", "", "time (ns)", "error (µm)", {series("a", {{1, 10}, {10, 100}, {100, 1000}})}, {}}; }

inline std::vector<Path> markers(const Drawing& drawing, const std::string& color) {
  return drawing.of([&](const Path& path) { return path.has("fill:" + color) && path.has("stroke:rgb(100%,100%,100%)"); });
}

inline Path frame(const Drawing& drawing) {
  const auto found = drawing.of([](const Path& path) { return path.is_open_line() && path.points.size() >= 4 && path.has("rgb(43.137255%"); });
  EXPECT_EQ(found.size(), 1U);
  return found.front();
}

}  // namespace sagitta::output
