// SPDX-License-Identifier: Apache-2.0
// A sheet to draw on: Cairo behind the few strokes that figures need. Coordinates are pixels from the top left corner;
// y grows downward. Letters are filled outlines, unhinted: the same picture on every machine.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lib/output/color_map.h"
#include "lib/output/raster.h"

namespace sagitta::output {

struct Box {
  double x = 0, y = 0, width = 0, height = 0;
};

enum class Align { left, center, right };

class Canvas {
 public:
  Canvas(int width, int height);  // white
  ~Canvas();

  static double text_width(std::string_view text, double size);
  // As many lines as the text needs in that width; a word that is too long is broken. No text: no line.
  static std::vector<std::string> wrap(std::string_view text, double size, double width);

  // The anchor is the left end, middle or right end of the line; y is half way up the figures, so that a label is
  // centred on its tick. Text that is wider than `most` (where that is positive) is drawn smaller.
  void text(std::string_view text, double x, double y, double size, Align align, Rgb8 color, double most = 0);
  // Centred and turned; from the left with a white rim, for text on a map.
  void text_upward(std::string_view text, double x, double y, double size, Rgb8 color, double most);
  void text_with_halo(std::string_view text, double x, double y, double size, Rgb8 color, double most);

  void fill(const Box& box, Rgb8 color);
  void frame(const Box& box, Rgb8 color);  // one pixel wide, just outside the box
  void line(double x1, double y1, double x2, double y2, double width, Rgb8 color, bool dashed = false);
  void circle(double x, double y, double radius, double width, Rgb8 color, bool dashed, const Box& inside);
  void row(int x, int y, std::span<const std::uint32_t> pixels);  // from (x, y) to the right

  // The picture, and the end of the canvas. Empty where it is too large for Cairo.
  Raster finish();

 private:
  struct Cairo;
  std::unique_ptr<Cairo> cairo_;
};

}  // namespace sagitta::output
