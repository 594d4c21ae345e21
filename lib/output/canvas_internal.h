// SPDX-License-Identifier: Apache-2.0
// A sheet to draw on: Cairo behind the few strokes that figures need. Coordinates are pixels from the top left corner;
// y grows downward. Letters are filled outlines, unhinted: the same picture on every machine, as pixels and as SVG.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lib/output/color_map.h"
#include "lib/output/raster.h"

namespace sagitta::output {

// Text sizes and inks of the sheet, in pixels.
inline constexpr double title_size = 19, panel_title_size = 13.5, label_size = 12, tick_size = 11;
inline constexpr double line_height = 1.35;  // of any text, in units of its size
inline constexpr double margin = 22;         // around the sheet
inline constexpr Rgb8 ink{26, 26, 26}, soft_ink{92, 92, 92}, frame_ink{110, 110, 110}, background{255, 255, 255};

// To be held from the first measure of a text to the end of its sheet: Cairo, FreeType and what is kept of letters are shared.
std::unique_lock<std::mutex> one_sheet_at_a_time();

struct Point {
  double x = 0, y = 0;
};

struct Box {
  double x = 0, y = 0, width = 0, height = 0;
};

enum class Align { left, center, right };
enum class Paper { pixels, svg };

class Canvas {
 public:
  Canvas(int width, int height, Paper paper = Paper::pixels);  // white
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

  // One below the other from `top`; the result is where they end.
  double text_lines(const std::vector<std::string>& lines, double x, double top, double size, Align align, Rgb8 color);
  // In place of data: the box in grey, and in its middle why.
  void no_data(const Box& box, std::string_view note);

  void fill(const Box& box, Rgb8 color);
  void frame(const Box& box, Rgb8 color);  // one pixel wide, just outside the box
  void line(double x1, double y1, double x2, double y2, double width, Rgb8 color, bool dashed = false);
  void polyline(std::span<const Point> points, double width, Rgb8 color, bool dashed = false);
  void circle(double x, double y, double radius, double width, Rgb8 color, bool dashed, const Box& inside);
  // Filled, and the rim drawn upon it.
  void polygon(std::span<const Point> corners, Rgb8 color, double rim_width, Rgb8 rim);
  void disc(Point center, double radius, Rgb8 color, double rim_width, Rgb8 rim);
  void row(int x, int y, std::span<const std::uint32_t> pixels);  // from (x, y) to the right, on pixels alone

  // The picture, and the end of the canvas. Empty where it is too large for Cairo.
  Raster finish();
  std::string finish_svg(std::string_view title);  // the title is what a viewer names the picture by

 private:
  struct Cairo;
  std::unique_ptr<Cairo> cairo_;
};

}  // namespace sagitta::output
