// SPDX-License-Identifier: Apache-2.0
#include "lib/output/table.h"

#include <algorithm>

#include "lib/output/text.h"

namespace sagitta::output {

std::string to_text(const Table& table) {
  constexpr std::size_t most_characters = 80;
  const std::size_t column_count = table.columns.size();

  std::vector<std::vector<std::string>> lines(2);
  for (const Column& column : table.columns) {
    lines[0].push_back(column.name);
    lines[1].push_back(column.unit);
  }
  if (std::all_of(lines[1].begin(), lines[1].end(), [](const std::string& unit) { return unit.empty(); }))
    lines.pop_back();
  const std::size_t head_count = lines.size();
  lines.insert(lines.end(), table.rows.begin(), table.rows.end());

  std::vector<std::size_t> widths(column_count, 0);
  for (auto& line : lines) {
    line.resize(column_count);
    for (std::size_t i = 0; i < column_count; ++i) {
      line[i] = printable(line[i], most_characters);
      widths[i] = std::max(widths[i], characters(line[i]).size());
    }
  }
  lines.emplace(lines.begin() + static_cast<std::ptrdiff_t>(head_count));
  for (const std::size_t width : widths) lines[head_count].emplace_back(width, '-');

  std::string text;
  for (const auto& line : lines) {
    std::string row;
    for (std::size_t i = 0; i < column_count; ++i) {
      const std::string pad(widths[i] - characters(line[i]).size(), ' ');
      if (i > 0) row += "  ";
      row += table.columns[i].text ? line[i] + pad : pad + line[i];
    }
    row.erase(row.find_last_not_of(' ') + 1);
    text += row + '\n';
  }
  return text;
}

}  // namespace sagitta::output
