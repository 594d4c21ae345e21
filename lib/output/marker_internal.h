// SPDX-License-Identifier: Apache-2.0
// How the series of a chart are told apart: by colour, by the shape of the marker, and by whether it is filled. Series 0 to 11
// differ without their colours, series 0 to 83 with them.
//
// The colours are seven of the eight of Okabe and Ito, which people with any kind of colour vision can tell apart; yellow is hardly
// seen on white. Source: M. Okabe and K. Ito, Color Universal Design (2008), https://jfly.uni-koeln.de/color/.
#pragma once

#include <cstddef>

#include "lib/output/canvas_internal.h"

namespace sagitta::output {

inline constexpr double marker_reach = 7.5;  // no marker goes farther from its point

class Marker {
 public:
  explicit Marker(std::size_t series);
  Rgb8 color() const { return color_; }
  void draw(Canvas& canvas, Point at) const;

 private:
  enum class Shape { disc, square, triangle, diamond, triangle_down, cross };
  Rgb8 color_;
  Shape shape_;
  bool is_filled_;  // a cross that is not is an upright one
};

}  // namespace sagitta::output
