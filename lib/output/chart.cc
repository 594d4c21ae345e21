// SPDX-License-Identifier: Apache-2.0
#include "lib/output/chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "lib/output/canvas_internal.h"
#include "lib/output/marker_internal.h"
#include "lib/output/text.h"
#include "lib/output/ticks.h"

namespace sagitta::output {
namespace {

constexpr std::size_t most_series = 36, most_characters = 600;
constexpr double plot_width = 580, least_plot_height = 430, most_plot_height = 640;
constexpr int most_ticks = 12;
constexpr double tick_length = 5, minor_tick_length = 3, tick_gap = 4;
constexpr double legend_gap = 20, legend_text_width = 210, sample_width = 32, sample_gap = 8, entry_gap = 5;
constexpr double series_width = 1.1, fit_width = 1.6, reference_width = 1.2;
constexpr Rgb8 grid_ink{228, 228, 228};

// The ends of a fitted line.
std::vector<ChartPoint> ends(const PowerLaw& law) {
  std::vector<ChartPoint> result;
  for (const double x : {law.low, law.high}) result.push_back({x, law.factor * std::pow(x, law.order)});
  return result;
}

class Axis {
 public:
  explicit Axis(AxisScale scale) : is_log_(scale == AxisScale::logarithmic) {}

  bool has_place_for(double value) const { return is_log_ ? value >= 1e-300 && value <= 1e300 : std::abs(value) <= 1e300; }
  void include(double value) {
    low_ = std::min(low_, scaled(value));
    high_ = std::max(high_, scaled(value));
  }
  // When all is included: some room at the ends, and a decade at least; of a linear axis that has one value, some room around it.
  void lay_out() {
    if (!(low_ <= high_)) return;
    const double middle = (low_ + high_) / 2;
    double half = 0.535 * (high_ - low_);
    if (is_log_) half = std::max(0.5, half);
    else if (!(half > 1e-9 * std::abs(middle))) half = middle != 0 ? 0.05 * std::abs(middle) : 1;
    low_ = middle - half;
    high_ = middle + half;
    ticks = is_log_ ? chart_ticks(std::pow(10.0, low_), std::pow(10.0, high_), most_ticks) : ChartTicks{linear_ticks(low_, high_, most_ticks), {}};
  }
  double fraction(double value) const { return (scaled(value) - low_) / (high_ - low_); }

  ChartTicks ticks;

 private:
  double scaled(double value) const { return is_log_ ? std::log10(value) : value; }

  bool is_log_;
  double low_ = std::numeric_limits<double>::infinity(), high_ = -std::numeric_limits<double>::infinity();
};

class Sheet {
 public:
  explicit Sheet(const Chart& chart);

  int width() const { return width_; }
  int height() const { return height_; }
  void draw(Canvas& canvas);

 private:
  struct Entry {  // of the legend
    std::size_t series;
    bool is_fit;
    std::vector<std::string> lines;
  };

  bool can_be_shown(const ChartPoint& point) const { return x_.has_place_for(point.x) && y_.has_place_for(point.y); }
  void take_in(const ChartPoint& point);
  void take_in_series(std::size_t i);
  void lay_out();
  std::vector<std::string> footer_texts() const;

  Point place(const ChartPoint& point) const {
    return {plot_.x + plot_.width * x_.fraction(point.x), plot_.y + plot_.height * (1 - y_.fraction(point.y))};
  }
  void draw_axes(Canvas& canvas) const;
  void draw_line(Canvas& canvas, std::span<const Point> points, double width, Rgb8 color, bool dashed);
  void draw_series(Canvas& canvas);
  void draw_references(Canvas& canvas);
  void draw_legend(Canvas& canvas) const;

  const Chart& chart_;
  std::vector<std::size_t> fits_;  // the series with a fitted line that can be shown
  std::vector<ReferenceLine> references_;
  std::size_t points_left_out_ = 0, lines_left_out_ = 0;
  bool has_data_ = false;
  Axis x_, y_;
  Box plot_;
  std::vector<Entry> legend_;
  std::vector<std::string> title_, footer_;
  double footer_top_ = 0;
  int width_ = 0, height_ = 0;
  std::vector<Point> drawn_;  // where in the plot something is, a few pixels apart
};

Sheet::Sheet(const Chart& chart) : chart_(chart), x_(chart.x_scale), y_(chart.y_scale) {
  for (std::size_t i = 0; i < std::min(chart.series.size(), most_series); ++i) take_in_series(i);
  for (const ReferenceLine& line : chart.references) {
    Axis& axis = line.is_vertical ? x_ : y_;
    if (!axis.has_place_for(line.at)) {
      ++lines_left_out_;
      continue;
    }
    references_.push_back(line);
    axis.include(line.at);
  }
  lay_out();
}

void Sheet::take_in(const ChartPoint& point) {
  x_.include(point.x);
  y_.include(point.y);
}

void Sheet::take_in_series(std::size_t i) {
  const ChartSeries& series = chart_.series[i];
  const auto add_entry = [&](bool is_fit, const std::string& text) {
    legend_.push_back({i, is_fit, Canvas::wrap(printable(text, most_characters), tick_size, legend_text_width)});
    if (legend_.back().lines.empty()) legend_.back().lines.emplace_back();
  };
  std::size_t shown = 0;
  for (const ChartPoint& point : series.points)
    if (can_be_shown(point)) {
      take_in(point);
      ++shown;
    }
  points_left_out_ += series.points.size() - shown;
  for (const ChartPoint& point : series.curve)
    if (can_be_shown(point)) {
      take_in(point);
      ++shown;
    }
  has_data_ = has_data_ || shown > 0;
  add_entry(false, series.name + (shown > 0 ? "" : " (no point)"));
  if (!series.fit) return;
  const std::vector<ChartPoint> line = ends(*series.fit);
  if (!can_be_shown(line.front()) || !can_be_shown(line.back())) {
    ++lines_left_out_;
    return;
  }
  for (const ChartPoint& end : line) take_in(end);
  fits_.push_back(i);
  add_entry(true, series.fit->label);
}

std::vector<std::string> Sheet::footer_texts() const {
  std::vector<std::string> texts{printable(chart_.footer, most_characters)};
  if (points_left_out_ + lines_left_out_ > 0) {
    const auto counted = [](std::size_t count, const char* what) { return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s"); };
    std::string what = points_left_out_ > 0 ? counted(points_left_out_, "point") : "";
    if (lines_left_out_ > 0) what += (what.empty() ? "" : " and ") + counted(lines_left_out_, "line");
    const bool any_is_log = chart_.x_scale == AxisScale::logarithmic || chart_.y_scale == AxisScale::logarithmic;
    texts.push_back(fmt::format("{} {} not shown: {}.", what, points_left_out_ + lines_left_out_ == 1 ? "is" : "are",
                                any_is_log ? "a logarithmic axis has no place for 0, negative or missing values" : "no axis has a place for missing values"));
  }
  if (chart_.series.size() > most_series) texts.push_back(fmt::format("{} of {} series are shown.", most_series, chart_.series.size()));
  return texts;
}

void Sheet::lay_out() {
  x_.lay_out();
  y_.lay_out();
  double widest_tick = 0, widest_name = 0;
  for (const std::string& label : y_.ticks.major.labels) widest_tick = std::max(widest_tick, Canvas::text_width(label, tick_size));
  double legend_height = 0;
  for (const Entry& entry : legend_) {
    for (const std::string& line : entry.lines) widest_name = std::max(widest_name, Canvas::text_width(line, tick_size));
    legend_height += tick_size * line_height * static_cast<double>(entry.lines.size()) + entry_gap;
  }
  const double left = std::ceil(margin + label_size * line_height + 2 * tick_gap + widest_tick + tick_length);
  const double legend_width = legend_.empty() ? 0 : legend_gap + sample_width + sample_gap + widest_name;
  const double content = left - margin + plot_width + legend_width;
  title_ = Canvas::wrap(printable(chart_.title, most_characters), title_size, content);
  for (const std::string& text : footer_texts())
    for (std::string& line : Canvas::wrap(text, tick_size, content)) footer_.push_back(std::move(line));

  plot_ = {left, std::ceil(margin + title_size * line_height * static_cast<double>(title_.size()) + (title_.empty() ? 0 : 12)), plot_width,
           std::ceil(std::clamp(legend_height, least_plot_height, most_plot_height))};
  const double axes_end = plot_.y + plot_.height + tick_length + tick_gap + (tick_size + label_size) * line_height;
  footer_top_ = std::max(axes_end, plot_.y + legend_height) + 12;
  const double bottom = footer_.empty() ? footer_top_ - 12 : footer_top_ + tick_size * line_height * static_cast<double>(footer_.size());
  width_ = static_cast<int>(std::ceil(content + 2 * margin));
  height_ = static_cast<int>(std::ceil(bottom + margin));
}

void Sheet::draw(Canvas& canvas) {
  canvas.text_lines(title_, margin, margin, title_size, Align::left, ink);
  if (has_data_) {
    draw_axes(canvas);
    draw_series(canvas);
    draw_references(canvas);
  } else {
    canvas.no_data(plot_, printable(chart_.empty_note, most_characters));
  }
  canvas.frame(plot_, frame_ink);
  canvas.text(printable(chart_.x_label, most_characters), plot_.x + plot_.width / 2,
              plot_.y + plot_.height + tick_length + tick_gap + (tick_size + label_size / 2) * line_height, label_size, Align::center, ink, plot_.width);
  canvas.text_upward(printable(chart_.y_label, most_characters), margin + label_size * line_height / 2, plot_.y + plot_.height / 2, label_size, ink,
                     plot_.height);
  draw_legend(canvas);
  canvas.text_lines(footer_, margin, footer_top_, tick_size, Align::left, soft_ink);
}

void Sheet::draw_axes(Canvas& canvas) const {
  const double bottom = plot_.y + plot_.height, right = plot_.x + plot_.width;
  const auto column = [&](double value) { return std::floor(plot_.x + plot_.width * x_.fraction(value)) + 0.5; };
  const auto row = [&](double value) { return std::floor(bottom - plot_.height * y_.fraction(value)) + 0.5; };
  for (const double value : x_.ticks.major.values) canvas.line(column(value), plot_.y, column(value), bottom, 1, grid_ink);
  for (const double value : y_.ticks.major.values) canvas.line(plot_.x, row(value), right, row(value), 1, grid_ink);
  for (const double value : x_.ticks.minor) canvas.line(column(value), bottom, column(value), bottom + minor_tick_length, 1, frame_ink);
  for (const double value : y_.ticks.minor) canvas.line(plot_.x - minor_tick_length, row(value), plot_.x, row(value), 1, frame_ink);
  for (std::size_t i = 0; i < x_.ticks.major.values.size(); ++i) {
    const double x = column(x_.ticks.major.values[i]);
    canvas.line(x, bottom, x, bottom + tick_length, 1, frame_ink);
    canvas.text(x_.ticks.major.labels[i], x, bottom + tick_length + tick_gap + tick_size * line_height / 2, tick_size, Align::center, ink);
  }
  for (std::size_t i = 0; i < y_.ticks.major.values.size(); ++i) {
    const double y = row(y_.ticks.major.values[i]);
    canvas.line(plot_.x - tick_length, y, plot_.x, y, 1, frame_ink);
    canvas.text(y_.ticks.major.labels[i], plot_.x - tick_length - tick_gap, y, tick_size, Align::right, ink);
  }
}

void Sheet::draw_line(Canvas& canvas, std::span<const Point> points, double width, Rgb8 color, bool dashed) {
  if (points.size() < 2) return;
  canvas.polyline(points, width, color, dashed);
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Point &a = points[i - 1], &b = points[i];
    const int steps = 1 + static_cast<int>(std::hypot(b.x - a.x, b.y - a.y) / 4);
    for (int k = 0; k <= steps; ++k) drawn_.push_back({a.x + (b.x - a.x) * k / steps, a.y + (b.y - a.y) * k / steps});
  }
}

// Lines first, that they hide no marker.
void Sheet::draw_series(Canvas& canvas) {
  const std::size_t count = std::min(chart_.series.size(), most_series);
  for (std::size_t i = 0; i < count; ++i) {
    if (!chart_.series[i].is_joined) continue;
    std::vector<Point> run;
    const ChartSeries& series = chart_.series[i];
    for (const ChartPoint& point : series.curve.empty() ? series.points : series.curve) {
      if (can_be_shown(point)) {
        run.push_back(place(point));
        continue;
      }
      draw_line(canvas, run, series_width, Marker(i).color(), false);
      run.clear();
    }
    draw_line(canvas, run, series_width, Marker(i).color(), false);
  }
  for (const std::size_t i : fits_) {
    const std::vector<ChartPoint> line = ends(*chart_.series[i].fit);
    const Point places[] = {place(line.front()), place(line.back())};
    draw_line(canvas, places, fit_width, Marker(i).color(), true);
  }
  for (std::size_t i = 0; i < count; ++i)
    for (const ChartPoint& point : chart_.series[i].points)
      if (can_be_shown(point)) {
        Marker(i).draw(canvas, place(point));
        drawn_.push_back(place(point));
      }
}

void Sheet::draw_references(Canvas& canvas) {
  const double right = plot_.x + plot_.width, bottom = plot_.y + plot_.height;
  const auto at = [&](const ReferenceLine& line) {
    return line.is_vertical ? plot_.x + plot_.width * x_.fraction(line.at) : bottom - plot_.height * y_.fraction(line.at);
  };
  for (const ReferenceLine& line : references_) {
    const Point across[] = {{plot_.x, at(line)}, {right, at(line)}}, upright[] = {{at(line), plot_.y}, {at(line), bottom}};
    draw_line(canvas, line.is_vertical ? upright : across, reference_width, soft_ink, true);
  }
  // A label lies beside its line: of its places inside the plot the one that covers least.
  constexpr double gap = 5, height = tick_size * line_height;
  const double most_width = plot_.width / 2 - 2 * gap;
  for (const ReferenceLine& line : references_) {
    const std::string label = printable(line.label, most_characters);
    if (label.empty()) continue;
    const double width = std::min(Canvas::text_width(label, tick_size), most_width);
    Box best;
    std::ptrdiff_t least = std::numeric_limits<std::ptrdiff_t>::max();
    for (const double along : {1.0, 0.0, 0.5})
      for (const bool is_before : {true, false}) {
        const Box box = line.is_vertical ? Box{is_before ? at(line) - gap - width : at(line) + gap, bottom - gap - height - along * (plot_.height - 2 * gap - height), width, height}
                                         : Box{plot_.x + gap + along * (plot_.width - 2 * gap - width), is_before ? at(line) - 2 - height : at(line) + 2, width, height};
        if (box.x < plot_.x || box.x + box.width > right || box.y < plot_.y || box.y + box.height > bottom) continue;
        const auto covered = std::count_if(drawn_.begin(), drawn_.end(), [&](const Point& point) {
          return point.x > box.x - marker_reach && point.x < box.x + box.width + marker_reach && point.y > box.y - marker_reach && point.y < box.y + box.height + marker_reach;
        });
        if (covered >= least) continue;
        least = covered;
        best = box;
      }
    canvas.text_with_halo(label, best.x, best.y + height / 2, tick_size, soft_ink, most_width);
    for (double x = best.x; x < best.x + best.width; x += 2)
      for (double y = best.y; y < best.y + best.height; y += 2) drawn_.push_back({x, y});
  }
}

void Sheet::draw_legend(Canvas& canvas) const {
  const double left = plot_.x + plot_.width + legend_gap;
  double top = plot_.y;
  for (const Entry& entry : legend_) {
    const Marker marker(entry.series);
    const double y = top + tick_size * line_height / 2;
    if (entry.is_fit || chart_.series[entry.series].is_joined)
      canvas.line(left, y, left + sample_width, y, entry.is_fit ? fit_width : series_width, marker.color(), entry.is_fit);
    if (!entry.is_fit) marker.draw(canvas, {left + sample_width / 2, y});
    top = entry_gap + canvas.text_lines(entry.lines, left + sample_width + sample_gap, top, tick_size, Align::left, entry.is_fit ? soft_ink : ink);
  }
}

}  // namespace

Raster render_chart(const Chart& chart) {
  const auto lock = one_sheet_at_a_time();
  Sheet sheet(chart);
  Canvas canvas(sheet.width(), sheet.height());
  sheet.draw(canvas);
  return canvas.finish();
}

std::string chart_svg(const Chart& chart) {
  const auto lock = one_sheet_at_a_time();
  Sheet sheet(chart);
  Canvas canvas(sheet.width(), sheet.height(), Paper::svg);
  sheet.draw(canvas);
  return canvas.finish_svg(printable(chart.title, most_characters));
}

}  // namespace sagitta::output
