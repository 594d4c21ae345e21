// SPDX-License-Identifier: Apache-2.0
// A chart of several series on two axes, each logarithmic or linear, for a person to look at: errors against run times, and the like. Plain
// numbers and texts in, a picture out, as pixels and as SVG from the same drawing; what they mean is the caller's business.
//
// Series differ in colours that colour-blind people can tell apart and in their markers, the first 12 in these alone. The legend is
// to the right of the plot and covers no data. Texts that are too long are wrapped or shrunk; nothing is cut off. At most 36 series
// are shown; the footer says so where there are more.
//
// An axis spans what is shown, lines of reference and fitted lines too, a logarithmic one a decade at least. A value that it has no place
// for (NaN, infinite, beyond 1e300; of a logarithmic axis 0, negative, below 1e-300, too) leaves its point out, which the footer counts,
// and interrupts the series' line.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lib/output/raster.h"

namespace sagitta::output {

enum class AxisScale { logarithmic, linear };

struct ChartPoint {
  double x = 0, y = 0;
};

// y = factor x^order from x = low to x = high: a straight line on two logarithmic axes, for which it is meant, drawn dashed, and its
// label in the legend, "order 2.00".
struct PowerLaw {
  double factor = 1, order = 0;
  double low = 0, high = 0;
  std::string label;
};

struct ChartSeries {
  std::string name;
  std::vector<ChartPoint> points;
  bool is_joined = true;  // by a thin line, in the order of the points; otherwise markers alone
  std::optional<PowerLaw> fit;
  std::vector<ChartPoint> curve = {};  // where it is not empty, the line goes through these in place of the points; it has no markers
};

// Across the whole plot, labelled inside it where it covers least.
struct ReferenceLine {
  bool is_vertical = false;
  double at = 0;
  std::string label;
};

struct Chart {
  std::string title, footer;
  std::string x_label, y_label;  // with the unit: "time per ray (ns)"
  std::vector<ChartSeries> series;
  std::vector<ReferenceLine> references;
  std::string empty_note = "no data";  // what stands in the plot where no point can be shown
  AxisScale x_scale = AxisScale::logarithmic, y_scale = AxisScale::logarithmic;
};

// Empty only where there is no memory for it.
Raster render_chart(const Chart& chart);

// The same as the bytes of an SVG file: letters are outlines, so that it needs no font; the chart's title is its <title>.
std::string chart_svg(const Chart& chart);

}  // namespace sagitta::output
