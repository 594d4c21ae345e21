// SPDX-License-Identifier: Apache-2.0
// A rectangle along the axes of (x, y), its sides included. From {inf, inf, -inf, -inf} on it grows by what it shall hold.
#pragma once

#include <algorithm>
#include <limits>

namespace sagitta::scene {

struct Rectangle {
  double low_x = std::numeric_limits<double>::infinity(), low_y = low_x, high_x = -low_x, high_y = -low_x;

  void include(double x, double y) {
    low_x = std::min(low_x, x), high_x = std::max(high_x, x);
    low_y = std::min(low_y, y), high_y = std::max(high_y, y);
  }
  bool contains(double x, double y) const { return x >= low_x && x <= high_x && y >= low_y && y <= high_y; }
  bool meets(const Rectangle& other) const {
    return other.high_x >= low_x && other.low_x <= high_x && other.high_y >= low_y && other.low_y <= high_y;
  }
  Rectangle grown(double by) const { return {low_x - by, low_y - by, high_x + by, high_y + by}; }
};

}  // namespace sagitta::scene
