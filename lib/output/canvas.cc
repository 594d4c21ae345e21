// SPDX-License-Identifier: Apache-2.0
#include <cairo-ft.h>
#include <cairo-svg.h>
#include <cairo.h>

#include <algorithm>
#include <cmath>
#include <compare>
#include <map>
#include <utility>

#include "lib/output/canvas_internal.h"
#include "lib/output/font.h"
#include "lib/output/text.h"

namespace sagitta::output {
namespace {

// Half the height of the figures of DejaVu Sans, whose capitals and figures are 0.729 of the size.
constexpr double half_height = 0.729 / 2;
constexpr std::uint32_t white = 0xFFFFFF;

// One face for the whole run: Cairo keeps scaled copies of it in a cache that outlives every sheet.
cairo_font_face_t* font_face() {
  static cairo_font_face_t* const face = [] {
    FT_Library library = nullptr;
    FT_Face typeface = nullptr;
    const std::span<const std::byte> file = font_file();
    FT_Init_FreeType(&library);
    FT_New_Memory_Face(library, reinterpret_cast<const FT_Byte*>(file.data()), static_cast<FT_Long>(file.size()), 0,
                       &typeface);
    return cairo_ft_font_face_create_for_ft_face(typeface, FT_LOAD_NO_HINTING);
  }();
  return face;
}

cairo_font_options_t* font_options() {
  static cairo_font_options_t* const options = [] {
    cairo_font_options_t* made = cairo_font_options_create();
    cairo_font_options_set_antialias(made, CAIRO_ANTIALIAS_GRAY);
    cairo_font_options_set_hint_style(made, CAIRO_HINT_STYLE_NONE);
    cairo_font_options_set_hint_metrics(made, CAIRO_HINT_METRICS_OFF);
    return made;
  }();
  return options;
}

void set_font(cairo_t* context, double size) {
  cairo_set_font_options(context, font_options());
  cairo_set_font_face(context, font_face());
  cairo_set_font_size(context, size);
}

// How wide letters are in one size, each asked of Cairo once.
class Widths {
 public:
  explicit Widths(double size) {
    cairo_matrix_t scale, upright;
    cairo_matrix_init_scale(&scale, size, size);
    cairo_matrix_init_identity(&upright);
    font_.reset(cairo_scaled_font_create(font_face(), &scale, &upright, font_options()));
  }

  double of(const std::string& letter) {
    const auto [place, is_new] = known_.try_emplace(letter, 0);
    if (is_new) {
      cairo_text_extents_t extents;
      cairo_scaled_font_text_extents(font_.get(), letter.c_str(), &extents);
      place->second = extents.x_advance;
    }
    return place->second;
  }

 private:
  std::unique_ptr<cairo_scaled_font_t, decltype(&cairo_scaled_font_destroy)> font_{nullptr, &cairo_scaled_font_destroy};
  std::map<std::string, double> known_;
};

Widths& widths(double size) {
  static std::map<double, Widths> by_size;
  return by_size.try_emplace(size, size).first->second;
}

void set_color(cairo_t* context, Rgb8 color) {
  cairo_set_source_rgb(context, color[0] / 255.0, color[1] / 255.0, color[2] / 255.0);
}

cairo_status_t append(void* text, const unsigned char* bytes, unsigned count) {
  static_cast<std::string*>(text)->append(reinterpret_cast<const char*>(bytes), count);
  return CAIRO_STATUS_SUCCESS;
}

// As the text of an XML element.
std::string escaped(std::string_view text) {
  std::string result;
  for (const std::string& one : characters(text))
    result += one == "&" ? "&amp;" : one == "<" ? "&lt;" : one == ">" ? "&gt;" : one;
  return result;
}

}  // namespace

std::unique_lock<std::mutex> one_sheet_at_a_time() {
  static std::mutex drawing;
  return std::unique_lock(drawing);
}

struct Canvas::Cairo {
  Cairo(int width, int height, Paper paper) {
    if (paper == Paper::svg) {
      surface = cairo_svg_surface_create_for_stream(append, &svg, width, height);
      cairo_svg_surface_set_document_unit(surface, CAIRO_SVG_UNIT_PX);
    } else {
      raster = {width, height, std::vector<std::uint32_t>(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), white)};
      surface = cairo_image_surface_create_for_data(reinterpret_cast<unsigned char*>(raster.pixels.data()), CAIRO_FORMAT_RGB24, width, height, 4 * width);
    }
    context = cairo_create(surface);
    cairo_set_antialias(context, CAIRO_ANTIALIAS_BEST);
    if (paper == Paper::pixels) return;
    set_color(context, background);
    cairo_paint(context);
  }
  ~Cairo() {
    cairo_destroy(context);
    cairo_surface_destroy(surface);
  }
  Cairo(const Cairo&) = delete;
  Cairo& operator=(const Cairo&) = delete;

  void take_pen(double width, Rgb8 color, bool dashed, cairo_line_join_t join) const {
    const double lengths[] = {5, 3};
    cairo_set_dash(context, lengths, dashed ? 2 : 0, 0);
    cairo_set_line_join(context, join);
    cairo_set_line_width(context, width);
    set_color(context, color);
  }

  void stroke(double width, Rgb8 color, bool dashed = false, cairo_line_join_t join = CAIRO_LINE_JOIN_MITER) const {
    take_pen(width, color, dashed, join);
    cairo_stroke(context);
  }

  void fill_with_rim(Rgb8 color, double rim_width, Rgb8 rim) const {
    set_color(context, color);
    cairo_fill_preserve(context);
    stroke(rim_width, rim);
  }

  // Draws a line of text that begins at (x, y). On blank paper of pixels, where the same text has been drawn just so between the pixels, its
  // pixels are copied: to fill outlines is most of the work of a sheet, and its axes are alike.
  void letters(const std::string& text, double x, double y, double size, Rgb8 color) {
    set_font(context, size);
    set_color(context, color);
    cairo_move_to(context, x, y);
    if (raster.pixels.empty()) {  // each letter's outline stands in the file once
      cairo_show_text(context, text.c_str());
      cairo_new_path(context);
      return;
    }
    cairo_text_path(context, text.c_str());
    cairo_matrix_t matrix;
    cairo_get_matrix(context, &matrix);
    double x1 = 0, y1 = 0, x2 = 0, y2 = 0;
    cairo_path_extents(context, &x1, &y1, &x2, &y2);
    const int left = static_cast<int>(std::floor(x1)) - 1, right = static_cast<int>(std::ceil(x2)) + 1;
    const int top = static_cast<int>(std::floor(y1)) - 1, bottom = static_cast<int>(std::ceil(y2)) + 1;
    const bool is_upright = matrix.xy == 0 && matrix.yx == 0;
    if (!is_upright || left < 0 || top < 0 || right > raster.width || bottom > raster.height || !is_blank(left, right, top, bottom)) {
      cairo_fill(context);
      return;
    }
    const auto between_pixels = [](double at) { return std::llround(1e9 * (at - std::floor(at))); };
    const auto [drawn, is_new] = drawn_.try_emplace({text, size, color, between_pixels(x), between_pixels(y), right - left, bottom - top});
    if (is_new) {
      cairo_fill(context);
      cairo_surface_flush(surface);
      for (int row = top; row < bottom; ++row) drawn->second.insert(drawn->second.end(), pixel(left, row), pixel(right, row));
      return;
    }
    cairo_new_path(context);
    const std::ptrdiff_t width = right - left;
    for (int row = top; row < bottom; ++row) std::copy_n(drawn->second.begin() + (row - top) * width, width, pixel(left, row));
    cairo_surface_mark_dirty_rectangle(surface, left, top, right - left, bottom - top);
  }

  Raster raster;    // what the surface draws on, a word a pixel as Cairo has it,
  std::string svg;  // or what it writes to
  cairo_surface_t* surface = nullptr;
  cairo_t* context = nullptr;

 private:
  struct Label {
    std::string text;
    double size;
    Rgb8 color;
    long long x, y;  // between the pixels, in units of 1e-9
    int width, height;
    auto operator<=>(const Label&) const = default;
  };

  std::vector<std::uint32_t>::iterator pixel(int x, int y) { return raster.pixels.begin() + std::ptrdiff_t{y} * raster.width + x; }
  bool is_blank(int left, int right, int top, int bottom) {
    cairo_surface_flush(surface);
    for (int row = top; row < bottom; ++row)
      if (std::any_of(pixel(left, row), pixel(right, row), [](std::uint32_t one) { return one != white; })) return false;
    return true;
  }

  std::map<Label, std::vector<std::uint32_t>> drawn_;
};

Canvas::Canvas(int width, int height, Paper paper) : cairo_(std::make_unique<Cairo>(width, height, paper)) {}
Canvas::~Canvas() = default;

double Canvas::text_width(std::string_view text, double size) {
  Widths& of_size = widths(size);
  double sum = 0;
  for (const std::string& letter : characters(text)) sum += of_size.of(letter);
  return sum;
}

std::vector<std::string> Canvas::wrap(std::string_view text, double size, double width) {
  std::vector<std::string> lines;
  std::string line, word;
  const auto end_line = [&] {
    if (!line.empty()) lines.push_back(std::exchange(line, {}));
  };
  const auto end_word = [&] {
    if (word.empty()) return;
    if (!line.empty() && text_width(line + ' ' + word, size) > width) end_line();
    if (!line.empty()) line += ' ';
    line += std::exchange(word, {});
  };
  for (const std::string& character : characters(text)) {
    if (character == " ") {
      end_word();
      continue;
    }
    if (!word.empty() && text_width(word + character, size) > width) {  // too long for any line
      end_line();
      lines.push_back(std::exchange(word, {}));
    }
    word += character;
  }
  end_word();
  end_line();
  return lines;
}

void Canvas::text(std::string_view text, double x, double y, double size, Align align, Rgb8 color, double most) {
  double width = text_width(text, size);
  if (most > 0 && width > most) {
    size *= most / width;
    width = most;
  }
  const double left = align == Align::left     ? x
                      : align == Align::center ? x - width / 2
                                               : x - width;
  cairo_->letters(std::string(text), left, y + half_height * size, size, color);
}

void Canvas::text_upward(std::string_view text, double x, double y, double size, Rgb8 color, double most) {
  cairo_t* context = cairo_->context;
  cairo_save(context);
  cairo_translate(context, x, y);
  cairo_rotate(context, -1.5707963267948966);
  this->text(text, 0, 0, size, Align::center, color, most);
  cairo_restore(context);
}

void Canvas::text_with_halo(std::string_view text, double x, double y, double size, Rgb8 color, double most) {
  cairo_t* context = cairo_->context;
  size = std::min(size, size * most / text_width(text, size));
  set_font(context, size);
  cairo_move_to(context, x, y + half_height * size);
  cairo_text_path(context, std::string(text).c_str());
  cairo_->take_pen(3, background, false, CAIRO_LINE_JOIN_ROUND);
  cairo_stroke_preserve(context);
  set_color(context, color);
  cairo_fill(context);
}

double Canvas::text_lines(const std::vector<std::string>& lines, double x, double top, double size, Align align, Rgb8 color) {
  for (const std::string& line : lines) {
    text(line, x, top + size * line_height / 2, size, align, color);
    top += size * line_height;
  }
  return top;
}

void Canvas::no_data(const Box& box, std::string_view note) {
  fill(box, no_data_color);
  const std::vector<std::string> lines = wrap(note, label_size, box.width - 24);
  const double height = label_size * line_height * static_cast<double>(lines.size());
  text_lines(lines, box.x + box.width / 2, box.y + (box.height - height) / 2, label_size, Align::center, soft_ink);
}

void Canvas::fill(const Box& box, Rgb8 color) {
  set_color(cairo_->context, color);
  cairo_rectangle(cairo_->context, box.x, box.y, box.width, box.height);
  cairo_fill(cairo_->context);
}

void Canvas::frame(const Box& box, Rgb8 color) {
  cairo_rectangle(cairo_->context, box.x - 0.5, box.y - 0.5, box.width + 1, box.height + 1);
  cairo_->stroke(1, color);
}

void Canvas::line(double x1, double y1, double x2, double y2, double width, Rgb8 color, bool dashed) {
  const Point ends[] = {{x1, y1}, {x2, y2}};
  polyline(ends, width, color, dashed);
}

void Canvas::polyline(std::span<const Point> points, double width, Rgb8 color, bool dashed) {
  for (const Point& point : points) cairo_line_to(cairo_->context, point.x, point.y);  // the first is moved to
  // A line without joins is said to have square ones, which Cairo draws faster.
  cairo_->stroke(width, color, dashed, points.size() > 2 ? CAIRO_LINE_JOIN_ROUND : CAIRO_LINE_JOIN_MITER);
}

void Canvas::polygon(std::span<const Point> corners, Rgb8 color, double rim_width, Rgb8 rim) {
  for (const Point& corner : corners) cairo_line_to(cairo_->context, corner.x, corner.y);
  cairo_close_path(cairo_->context);
  cairo_->fill_with_rim(color, rim_width, rim);
}

void Canvas::disc(Point center, double radius, Rgb8 color, double rim_width, Rgb8 rim) {
  cairo_arc(cairo_->context, center.x, center.y, radius, 0, 6.283185307179586);
  cairo_close_path(cairo_->context);
  cairo_->fill_with_rim(color, rim_width, rim);
}

void Canvas::circle(double x, double y, double radius, double width, Rgb8 color, bool dashed, const Box& inside) {
  cairo_t* context = cairo_->context;
  cairo_save(context);
  cairo_rectangle(context, inside.x, inside.y, inside.width, inside.height);
  cairo_clip(context);
  cairo_new_path(context);
  cairo_arc(context, x, y, radius, 0, 6.283185307179586);
  cairo_->stroke(width, color, dashed);
  cairo_restore(context);
}

void Canvas::row(int x, int y, std::span<const std::uint32_t> pixels) {
  Raster& raster = cairo_->raster;
  cairo_surface_flush(cairo_->surface);
  std::copy(pixels.begin(), pixels.end(), raster.pixels.begin() + std::ptrdiff_t{y} * raster.width + x);
  cairo_surface_mark_dirty_rectangle(cairo_->surface, x, y, static_cast<int>(pixels.size()), 1);
}

Raster Canvas::finish() {
  if (cairo_surface_status(cairo_->surface) != CAIRO_STATUS_SUCCESS) return {};
  cairo_surface_finish(cairo_->surface);
  return std::move(cairo_->raster);
}

std::string Canvas::finish_svg(std::string_view title) {
  cairo_surface_finish(cairo_->surface);
  if (cairo_surface_status(cairo_->surface) != CAIRO_STATUS_SUCCESS) return {};
  std::string svg = std::move(cairo_->svg);
  // Cairo numbers its surfaces through the run: the same drawing would not be the same bytes.
  static const std::string numbered = "<g id=\"surface";
  if (const auto begin = svg.find(numbered); begin != std::string::npos) svg.erase(begin + 2, svg.find('>', begin) - begin - 2);
  return svg.insert(svg.find('>', svg.find("<svg")) + 1, "\n<title>" + escaped(title) + "</title>");
}

}  // namespace sagitta::output
