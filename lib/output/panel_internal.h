// SPDX-License-Identifier: Apache-2.0
// One panel of a figure: what room it needs, and its drawing.
//
//      left | plot width | right
//           title, subtitle lines             header height
//   label   +------------+  bar and its
//   ticks   |    map     |  ticks, label      plot height
//           +------------+
//           ticks, label                      below
#pragma once

#include <string>
#include <vector>

#include "lib/output/canvas_internal.h"
#include "lib/output/figure.h"
#include "lib/output/ticks.h"

namespace sagitta::output {

// One axis, ready to draw: where its ticks stand as fractions of its length, and what is written there.
struct Scale {
  struct Tick {
    double at;  // 0 at the low end, 1 at the high end
    std::string label;
  };
  std::vector<Tick> ticks;
  std::string label;
  double widest = 0;  // of the tick labels
};

class PanelLayout {
 public:
  PanelLayout(const Panel& panel, double plot_side);

  double left() const;
  double right() const;
  double header_height(double width) const;
  double plot_height() const { return height_; }
  static double below();

  // The plot's top left corner, and how far the header may reach.
  void draw(Canvas& canvas, int x, int y, double header_width) const;

 private:
  std::vector<std::string> title_lines(double width) const;
  std::vector<std::string> subtitle_lines(double width) const;
  double fraction(double value) const;  // of the colour bar
  Rgb8 color_of(float value) const;
  void draw_map(Canvas& canvas, int x, int y) const;
  void draw_axes(Canvas& canvas, const Box& plot) const;
  void draw_bar(Canvas& canvas, const Box& plot) const;
  void draw_circles(Canvas& canvas, const Box& plot) const;

  const Panel& panel_;
  int width_, height_;  // of the plot
  bool has_data_ = false;
  Range range_;
  Scale x_scale_, y_scale_, bar_scale_;
};

}  // namespace sagitta::output
