// SPDX-License-Identifier: Apache-2.0
#include <cairo-ft.h>
#include <cairo.h>

#include <algorithm>
#include <cstring>
#include <utility>

#include "lib/output/canvas_internal.h"
#include "lib/output/font.h"
#include "lib/output/text.h"

namespace sagitta::output {
namespace {

// Half the height of the figures of DejaVu Sans, whose capitals and figures are 0.729 of the size.
constexpr double half_height = 0.729 / 2;

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

void set_font(cairo_t* context, double size) {
  cairo_font_options_t* options = cairo_font_options_create();
  cairo_font_options_set_antialias(options, CAIRO_ANTIALIAS_GRAY);
  cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_NONE);
  cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
  cairo_set_font_options(context, options);
  cairo_font_options_destroy(options);
  cairo_set_font_face(context, font_face());
  cairo_set_font_size(context, size);
}

void set_color(cairo_t* context, Rgb8 color) {
  cairo_set_source_rgb(context, color[0] / 255.0, color[1] / 255.0, color[2] / 255.0);
}

}  // namespace

struct Canvas::Cairo {
  Cairo(int width, int height)
      : surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height)), context(cairo_create(surface)) {
    cairo_set_antialias(context, CAIRO_ANTIALIAS_BEST);
  }
  ~Cairo() {
    cairo_destroy(context);
    cairo_surface_destroy(surface);
  }
  Cairo(const Cairo&) = delete;
  Cairo& operator=(const Cairo&) = delete;

  void dash(bool dashed) const {
    const double lengths[] = {5, 3};
    cairo_set_dash(context, lengths, dashed ? 2 : 0, 0);
  }

  cairo_surface_t* surface;
  cairo_t* context;
};

Canvas::Canvas(int width, int height) : cairo_(std::make_unique<Cairo>(width, height)) {
  fill({0, 0, double(width), double(height)}, {255, 255, 255});
}
Canvas::~Canvas() = default;

double Canvas::text_width(std::string_view text, double size) {
  const Cairo measure(1, 1);
  set_font(measure.context, size);
  cairo_text_extents_t extents;
  cairo_text_extents(measure.context, std::string(text).c_str(), &extents);
  return extents.x_advance;
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
  cairo_t* context = cairo_->context;
  set_font(context, size);
  set_color(context, color);
  cairo_move_to(context,
                align == Align::left     ? x
                : align == Align::center ? x - width / 2
                                         : x - width,
                y + half_height * size);
  cairo_text_path(context, std::string(text).c_str());
  cairo_fill(context);
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
  cairo_->dash(false);
  cairo_set_line_width(context, 3);
  cairo_set_line_join(context, CAIRO_LINE_JOIN_ROUND);
  set_color(context, {255, 255, 255});
  cairo_stroke_preserve(context);
  set_color(context, color);
  cairo_fill(context);
}

void Canvas::fill(const Box& box, Rgb8 color) {
  set_color(cairo_->context, color);
  cairo_rectangle(cairo_->context, box.x, box.y, box.width, box.height);
  cairo_fill(cairo_->context);
}

void Canvas::frame(const Box& box, Rgb8 color) {
  set_color(cairo_->context, color);
  cairo_->dash(false);
  cairo_set_line_width(cairo_->context, 1);
  cairo_rectangle(cairo_->context, box.x - 0.5, box.y - 0.5, box.width + 1, box.height + 1);
  cairo_stroke(cairo_->context);
}

void Canvas::line(double x1, double y1, double x2, double y2, double width, Rgb8 color, bool dashed) {
  set_color(cairo_->context, color);
  cairo_->dash(dashed);
  cairo_set_line_width(cairo_->context, width);
  cairo_move_to(cairo_->context, x1, y1);
  cairo_line_to(cairo_->context, x2, y2);
  cairo_stroke(cairo_->context);
}

void Canvas::circle(double x, double y, double radius, double width, Rgb8 color, bool dashed, const Box& inside) {
  cairo_t* context = cairo_->context;
  cairo_save(context);
  cairo_rectangle(context, inside.x, inside.y, inside.width, inside.height);
  cairo_clip(context);
  cairo_new_path(context);
  cairo_arc(context, x, y, radius, 0, 6.283185307179586);
  set_color(context, color);
  cairo_->dash(dashed);
  cairo_set_line_width(context, width);
  cairo_stroke(context);
  cairo_restore(context);
}

void Canvas::pixels(int x, int y, int width, const std::vector<Rgb8>& colors) {
  cairo_surface_flush(cairo_->surface);
  unsigned char* data = cairo_image_surface_get_data(cairo_->surface);
  if (data == nullptr || width < 1) return;
  const std::ptrdiff_t stride = cairo_image_surface_get_stride(cairo_->surface);
  const int height = static_cast<int>(colors.size()) / width;
  auto color = colors.begin();
  for (int j = 0; j < height; ++j)
    for (int i = 0; i < width; ++i, ++color) {
      const std::uint32_t packed = (std::uint32_t{(*color)[0]} << 16U) | (std::uint32_t{(*color)[1]} << 8U) | (*color)[2];
      std::memcpy(data + (y + j) * stride + std::ptrdiff_t{4} * (x + i), &packed, sizeof packed);
    }
  cairo_surface_mark_dirty_rectangle(cairo_->surface, x, y, width, height);
}

Raster Canvas::raster() const {
  cairo_surface_flush(cairo_->surface);
  const unsigned char* data = cairo_image_surface_get_data(cairo_->surface);
  if (data == nullptr) return {};  // no memory for the sheet
  const std::ptrdiff_t stride = cairo_image_surface_get_stride(cairo_->surface);
  Raster raster{cairo_image_surface_get_width(cairo_->surface), cairo_image_surface_get_height(cairo_->surface), {}};
  raster.rgb.reserve(std::size_t{3} * static_cast<std::size_t>(raster.width) * static_cast<std::size_t>(raster.height));
  for (int y = 0; y < raster.height; ++y)
    for (int x = 0; x < raster.width; ++x) {
      std::uint32_t packed = 0;
      std::memcpy(&packed, data + y * stride + 4 * x, sizeof packed);
      for (const unsigned shift : {16U, 8U, 0U})
        raster.rgb.push_back(static_cast<std::uint8_t>(packed >> shift & 0xFFU));
    }
  return raster;
}

}  // namespace sagitta::output
