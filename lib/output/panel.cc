// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "lib/output/panel_internal.h"
#include "lib/output/text.h"

namespace sagitta::output {
namespace {

constexpr double tick_length = 4, tick_gap = 3, bar_gap = 12, bar_width = 13;
constexpr std::size_t most_characters = 400;  // of any text of a panel

// Puts the ticks on the scale; place(value) is where a value stands along it.
void put(Scale& scale, const Ticks& ticks, const auto& place) {
  for (std::size_t i = 0; i < ticks.values.size(); ++i) {
    scale.ticks.push_back({place(ticks.values[i]), ticks.labels[i]});
    scale.widest = std::max(scale.widest, Canvas::text_width(ticks.labels[i], tick_size));
  }
}

// An axis of `extent` about `center`; `pixels` long.
Scale axis_scale(const std::string& name, double center, double extent, bool unit_mm, double pixels) {
  Scale scale;
  const LengthUnit unit = unit_mm ? length_unit(extent) : LengthUnit{1, ""};
  // Far from zero the middle, rounded well below a tick, becomes the origin.
  double origin = 0;
  std::string from;
  if (unit_mm && std::abs(center) > extent && std::isfinite(center)) {
    const int decimals = static_cast<int>(std::clamp(2 - std::floor(std::log10(extent)), 0.0, 12.0));
    const double power = std::pow(10.0, decimals);
    origin = std::round(center * power) / power;
    from = fmt::format(" {} {:.{}f} mm", origin < 0 ? "+" : "−", std::abs(origin), decimals);
  }
  scale.label = printable(name, most_characters) + from + (unit_mm ? fmt::format(" ({})", unit.name) : "");
  const double low = (center - origin - extent / 2) * unit.per_mm, high = (center - origin + extent / 2) * unit.per_mm;
  put(scale,
      linear_ticks(low, high,
                   pixels > 320   ? 7
                   : pixels > 150 ? 5
                                  : 2),
      [&](double value) { return (value - low) / (high - low); });
  return scale;
}

// The range of the colours where none is given.
Range automatic_range(const Panel& panel) {
  double largest = 0, magnitude = 0, least_positive = std::numeric_limits<double>::infinity();
  for (const float value : panel.map.values) {
    if (!std::isfinite(value)) continue;
    largest = std::max(largest, double(value));
    magnitude = std::max(magnitude, std::abs(double(value)));
    if (value > 0) least_positive = std::min(least_positive, double(value));
  }
  if (panel.color_map == ColorMap::diverging) return {-magnitude, magnitude};
  return {panel.log_scale && largest > 0 ? least_positive : 0, largest};
}

}  // namespace

PanelLayout::PanelLayout(const Panel& panel, double plot_side) : panel_(panel) {
  const Map& map = panel.map;
  const Axes& axes = panel.axes;
  // A size that is none (0, NaN) still gets a panel.
  const auto extent = [](int count, double pixel) {
    const double size = std::max(1, count) * pixel;
    return size > 0 && std::isfinite(size) ? size : 1;
  };
  const double extent_x = extent(map.width, axes.pixel_width), extent_y = extent(map.height, axes.pixel_height);
  const double larger = std::max(extent_x, extent_y);
  const auto pixels = [&](double size) {
    return static_cast<int>(std::lround(std::clamp(plot_side * size / larger, 24.0, plot_side)));
  };
  width_ = pixels(extent_x);
  height_ = pixels(extent_y);
  has_data_ = map.width > 0 && map.height > 0 &&
              map.values.size() == static_cast<std::size_t>(map.width) * static_cast<std::size_t>(map.height) &&
              std::any_of(map.values.begin(), map.values.end(), [](float v) { return std::isfinite(v); });

  x_scale_ = axis_scale(axes.x_label, axes.center_x, extent_x, axes.unit_mm, width_);
  y_scale_ = axis_scale(axes.y_label, axes.center_y, extent_y, axes.unit_mm, height_);

  range_ = panel.range.value_or(automatic_range(panel));
  if (!(range_.low < range_.high)) {  // all values are one
    const double size = range_.low != 0 && std::isfinite(range_.low) ? std::abs(range_.low) : 1;
    range_ = {panel.color_map == ColorMap::diverging ? -size
              : panel.log_scale                      ? size
                                                     : 0,
              panel.log_scale ? 10 * size : size};
  }
  const bool log_bar = panel.log_scale && range_.low > 0;
  const Magnitude power = log_bar ? Magnitude{} : magnitude(std::max(std::abs(range_.low), std::abs(range_.high)));
  const int most = height_ > 320 ? 9 : 7;
  const double smallest_step = panel.zero_is_background ? 1 : 0;  // counts are whole
  put(bar_scale_,
      log_bar ? log_ticks(range_.low, range_.high, most)
              : linear_ticks(range_.low / power.factor, range_.high / power.factor, most, smallest_step / power.factor),
      [&](double value) { return fraction(value * power.factor); });
  const std::string unit = power.label + printable(panel.unit, most_characters);
  bar_scale_.label = printable(panel.quantity, most_characters) + (unit.empty() ? "" : " (" + unit + ")");
}

double PanelLayout::left() const { return label_size * line_height + 4 + y_scale_.widest + tick_gap + tick_length; }
double PanelLayout::right() const {
  return bar_gap + bar_width + tick_length + tick_gap + bar_scale_.widest + 6 + label_size * line_height;
}
double PanelLayout::below() { return tick_length + tick_gap + tick_size * line_height + label_size * line_height + 2; }

std::vector<std::string> PanelLayout::title_lines(double width) const {
  return Canvas::wrap(printable(panel_.title, most_characters), panel_title_size, width);
}
std::vector<std::string> PanelLayout::subtitle_lines(double width) const {
  std::vector<std::string> lines;
  for (const std::string& text : panel_.subtitle)
    for (std::string& line : Canvas::wrap(printable(text, most_characters), tick_size, width))
      lines.push_back(std::move(line));
  return lines;
}
double PanelLayout::header_height(double width) const {
  return line_height * (panel_title_size * static_cast<double>(title_lines(width).size()) +
                        tick_size * static_cast<double>(subtitle_lines(width).size())) +
         5;
}

double PanelLayout::fraction(double value) const {
  if (panel_.log_scale && range_.low > 0)
    return value > 0 ? std::log(value / range_.low) / std::log(range_.high / range_.low) : 0;
  return (value - range_.low) / (range_.high - range_.low);
}

Rgb8 PanelLayout::color_of(float value) const {
  if (panel_.zero_is_background && value == 0) return background;
  return color(panel_.color_map, fraction(value));
}

void PanelLayout::draw(Canvas& canvas, int x, int y, double header_width) const {
  const double title_end = canvas.text_lines(title_lines(header_width), x, y - header_height(header_width), panel_title_size, Align::left, ink);
  canvas.text_lines(subtitle_lines(header_width), x, title_end, tick_size, Align::left, soft_ink);

  const Box plot{double(x), double(y), double(width_), double(height_)};
  if (has_data_) {
    draw_map(canvas, x, y);
    draw_bar(canvas, plot);
    draw_circles(canvas, plot);
  } else {
    canvas.no_data(plot, printable(panel_.empty_note, most_characters));
  }
  draw_axes(canvas, plot);
}

void PanelLayout::draw_map(Canvas& canvas, int x, int y) const {
  const Map& map = panel_.map;
  // The map's pixels [first, last) that each of `plot` pixels of the picture covers, at least one.
  struct Covered {
    std::size_t first, last;
    bool operator==(const Covered&) const = default;
  };
  const auto covered = [](int plot, int map_size) {
    std::vector<Covered> all;
    const auto count = static_cast<std::size_t>(map_size), of = static_cast<std::size_t>(plot);
    for (std::size_t i = 0; i < of; ++i) all.push_back({i * count / of, std::max((i + 1) * count / of, i * count / of + 1)});
    return all;
  };
  const std::vector<Covered> columns = covered(width_, map.width), rows = covered(height_, map.height);
  // Counts repeat, and so do neighbours: the last value of each of 256 classes and its colour.
  struct Known {
    std::uint32_t value, pixel;
  };
  std::array<Known, 256> known{};
  for (Known& one : known) one = {0, pixel_of(color_of(0))};
  const auto pixel_at = [&](float value) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    Known& one = known[bits * 0x9E3779B9U >> 24U];  // 2^32 over the golden ratio
    if (one.value != bits) one = {bits, pixel_of(color_of(value))};
    return one.pixel;
  };
  std::vector<std::uint32_t> pixels(columns.size());
  for (std::size_t j = 0; j < rows.size(); ++j) {
    if (j == 0 || rows[j] != rows[j - 1])
      for (std::size_t i = 0; i < columns.size(); ++i) {
        float shown = std::numeric_limits<float>::quiet_NaN();
        for (std::size_t row = rows[j].first; row < rows[j].last; ++row)
          for (std::size_t column = columns[i].first; column < columns[i].last; ++column) {
            const float value = map.values[row * static_cast<std::size_t>(map.width) + column];
            if (!(std::abs(value) <= std::abs(shown)) && !std::isnan(value)) shown = value;
          }
        pixels[i] = pixel_at(shown);
      }
    canvas.row(x, y + static_cast<int>(j), pixels);
  }
}

void PanelLayout::draw_axes(Canvas& canvas, const Box& plot) const {
  canvas.frame(plot, frame_ink);
  const double bottom = plot.y + plot.height;
  for (const Scale::Tick& tick : x_scale_.ticks) {
    const double at = std::floor(plot.x + tick.at * plot.width) + 0.5;
    canvas.line(at, bottom + 1, at, bottom + 1 + tick_length, 1, frame_ink);
    canvas.text(tick.label, at, bottom + tick_length + tick_gap + tick_size * line_height / 2, tick_size, Align::center,
                ink);
  }
  for (const Scale::Tick& tick : y_scale_.ticks) {
    const double at = std::floor(bottom - tick.at * plot.height) + 0.5;
    canvas.line(plot.x - 1 - tick_length, at, plot.x - 1, at, 1, frame_ink);
    canvas.text(tick.label, plot.x - 1 - tick_length - tick_gap, at, tick_size, Align::right, ink);
  }
  canvas.text(x_scale_.label, plot.x + plot.width / 2,
              bottom + tick_length + tick_gap + tick_size * line_height + label_size * line_height / 2, label_size,
              Align::center, ink, plot.width);
  canvas.text_upward(y_scale_.label, plot.x - left() + label_size * line_height / 2, plot.y + plot.height / 2,
                     label_size, ink, plot.height);
}

void PanelLayout::draw_bar(Canvas& canvas, const Box& plot) const {
  const Box bar{plot.x + plot.width + bar_gap, plot.y, bar_width, plot.height};
  for (int j = 0; j < height_; ++j)
    canvas.row(static_cast<int>(bar.x), static_cast<int>(bar.y) + j,
               std::vector<std::uint32_t>(static_cast<std::size_t>(bar.width), pixel_of(color(panel_.color_map, 1 - (j + 0.5) / height_))));
  canvas.frame(bar, frame_ink);
  const double edge = bar.x + bar.width + 1;
  for (const Scale::Tick& tick : bar_scale_.ticks) {
    const double at = std::floor(bar.y + bar.height * (1 - tick.at)) + 0.5;
    canvas.line(edge, at, edge + tick_length, at, 1, frame_ink);
    // Right-aligned figures stand in columns, whatever their signs.
    canvas.text(tick.label, edge + tick_length + tick_gap + bar_scale_.widest, at, tick_size, Align::right, ink);
  }
  canvas.text_upward(bar_scale_.label, plot.x + plot.width + right() - label_size * line_height / 2,
                     plot.y + plot.height / 2, label_size, ink, plot.height);
}

void PanelLayout::draw_circles(Canvas& canvas, const Box& plot) const {
  constexpr Rgb8 circle_ink{213, 60, 20};
  const Axes& axes = panel_.axes;
  const double scale_x = plot.width / (std::max(1, panel_.map.width) * axes.pixel_width);
  const double scale_y = plot.height / (std::max(1, panel_.map.height) * axes.pixel_height);
  double y = plot.y + plot.height - 12 - 16 * (static_cast<double>(panel_.circles.size()) - 1);
  for (std::size_t i = 0; i < panel_.circles.size(); ++i) {
    const Circle& circle = panel_.circles[i];
    const double at_x = plot.x + plot.width / 2 + (circle.x - axes.center_x) * scale_x;
    const double at_y = plot.y + plot.height / 2 - (circle.y - axes.center_y) * scale_y;
    const double radius = circle.radius * scale_x;
    // Nothing of a circle beyond all measure (or of none: NaN) would be seen, and Cairo would draw it for ever.
    const auto in_reach = [](double v) { return std::abs(v) < 1e5; };
    if (in_reach(at_x) && in_reach(at_y) && in_reach(radius) && radius > 0)
      canvas.circle(at_x, at_y, radius, 1.4, circle_ink, i > 0, plot);
    if (circle.label.empty()) continue;
    canvas.line(plot.x + 8, y, plot.x + 26, y, 1.4, circle_ink, i > 0);
    canvas.text_with_halo(printable(circle.label, 40), plot.x + 32, y, tick_size, ink, plot.width - 40);
    y += 16;
  }
}

}  // namespace sagitta::output
