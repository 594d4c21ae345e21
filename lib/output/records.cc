// SPDX-License-Identifier: Apache-2.0
#include "lib/output/records.h"

#include <algorithm>

#include "lib/output/summary_internal.h"
#include "lib/output/text.h"

namespace sagitta::output {
namespace {

using Cells = std::vector<std::string>;

std::string line_of(const Cells& cells) {
  std::string line;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (i > 0) line += ',';
    if (cells[i].find_first_of(",\"\n\r") == std::string::npos) {
      line += cells[i];
      continue;
    }
    line += '"';
    for (const char c : cells[i]) line += c == '"' ? std::string("\"\"") : std::string(1, c);
    line += '"';
  }
  return line + "\n";
}

Cells names_of(const std::vector<RecordColumn>& columns) {
  Cells names;
  for (const RecordColumn& column : columns) names.push_back(column.name);
  return names;
}

// The cells up to the end of the line, which is taken off the text.
Cells next_line(std::string_view& text) {
  Cells cells(1);
  bool is_quoted = false;
  std::size_t i = 0;
  for (; i < text.size() && (is_quoted || text[i] != '\n'); ++i) {
    if (text[i] == '"' && is_quoted && i + 1 < text.size() && text[i + 1] == '"') cells.back() += text[i++];
    else if (text[i] == '"') is_quoted = !is_quoted;
    else if (text[i] == ',' && !is_quoted) cells.emplace_back();
    else if (text[i] == '\r' && !is_quoted && text.substr(i + 1, 1) == "\n") continue;  // some editor's line end
    else cells.back() += text[i];
  }
  text.remove_prefix(std::min(text.size(), i + 1));
  return cells;
}

}  // namespace

std::string to_csv(const Records& records) {
  std::string csv = line_of(names_of(records.columns));
  for (const Cells& row : records.rows) csv += line_of(row);
  return csv;
}

std::optional<std::vector<Cells>> rows_of_csv(std::string_view text, const std::vector<RecordColumn>& columns) {
  if (next_line(text) != names_of(columns)) return std::nullopt;
  std::vector<Cells> rows;
  while (!text.empty())
    if (Cells cells = next_line(text); cells.size() == columns.size()) rows.push_back(std::move(cells));
    else return std::nullopt;
  return rows;
}

std::string to_json(const std::vector<std::pair<std::string, std::string>>& head, const Records& records) {
  nlohmann::ordered_json json;
  for (const auto& [key, value] : head) json[key] = printable(value, 10'000);
  json["rows"] = nlohmann::ordered_json::array();
  for (const Cells& row : records.rows) {
    nlohmann::ordered_json one;
    for (std::size_t i = 0; i < records.columns.size(); ++i) {
      const RecordColumn& column = records.columns[i];
      if (column.is_text) one[column.name] = printable(row[i], 10'000);
      else one[column.name] = nlohmann::ordered_json::parse(row[i], nullptr, false).is_number() ? nlohmann::ordered_json::parse(row[i]) : nlohmann::ordered_json();
    }
    json["rows"].push_back(std::move(one));
  }
  return text_of(json);
}

}  // namespace sagitta::output
