// SPDX-License-Identifier: Apache-2.0
#include "lib/output/figure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lib/output/canvas_internal.h"
#include "lib/output/panel_internal.h"
#include "lib/output/text.h"

namespace sagitta::output {
namespace {

constexpr std::size_t most_panels = 64, most_rows = 16, most_characters = 600;
constexpr double gap = 22;  // between panels

}  // namespace

Raster render(const Figure& figure) {
  const auto lock = one_sheet_at_a_time();
  const std::size_t panel_count = std::min(figure.panels.size(), most_panels);
  const std::size_t least_columns = (panel_count + most_rows - 1) / most_rows;
  const std::size_t columns =
      std::clamp<std::size_t>(static_cast<std::size_t>(std::max(1, figure.columns)),
                              std::max<std::size_t>(1, least_columns), std::max<std::size_t>(1, panel_count));
  const std::size_t rows = (panel_count + columns - 1) / columns;
  const double side = panel_count <= 1 ? 512 : columns <= 2 && panel_count <= 4 ? 384 : 256;

  std::vector<PanelLayout> panels;
  double left = 0, right = 0;
  for (std::size_t i = 0; i < panel_count; ++i) {
    panels.emplace_back(figure.panels[i], side);
    left = std::max(left, panels.back().left());
    right = std::max(right, panels.back().right());
  }
  left = std::ceil(left);
  right = std::ceil(right);
  const double cell_width = left + side + right, header_width = side + right;
  const double content = static_cast<double>(columns) * cell_width + static_cast<double>(columns - 1) * gap;

  std::string footer_text = printable(figure.footer, most_characters);
  if (panel_count < figure.panels.size())
    footer_text +=
        fmt::format("{}{} of {} panels are shown.", footer_text.empty() ? "" : "  ", panel_count, figure.panels.size());
  const std::vector<std::string> title = Canvas::wrap(printable(figure.title, most_characters), title_size, content);
  const std::vector<std::string> footer = Canvas::wrap(footer_text, tick_size, content);

  // Down the sheet: the title, rows of panels aligned at the top edge of their plots, the footer.
  double y = margin + title_size * line_height * static_cast<double>(title.size());
  std::vector<int> plot_top;
  for (std::size_t row = 0; row < rows; ++row) {
    double header = 0, height = 0;
    for (std::size_t i = row * columns; i < std::min(panel_count, (row + 1) * columns); ++i) {
      header = std::max(header, panels[i].header_height(header_width));
      height = std::max(height, panels[i].plot_height());
    }
    y += (row == 0 ? 10 : gap) + header;
    plot_top.push_back(static_cast<int>(std::lround(y)));
    y = plot_top.back() + height + PanelLayout::below();
  }
  const double footer_top = y + 12;
  const double bottom = footer.empty() ? y : footer_top + tick_size * line_height * static_cast<double>(footer.size());

  Canvas canvas(static_cast<int>(std::ceil(content + 2 * margin)), static_cast<int>(std::ceil(bottom + margin)));
  canvas.text_lines(title, margin, margin, title_size, Align::left, ink);
  canvas.text_lines(footer, margin, footer_top, tick_size, Align::left, soft_ink);
  for (std::size_t i = 0; i < panel_count; ++i) {
    const double x = margin + left + static_cast<double>(i % columns) * (cell_width + gap);
    panels[i].draw(canvas, static_cast<int>(std::lround(x)), plot_top[i / columns], header_width);
  }
  return canvas.finish();
}

}  // namespace sagitta::output
