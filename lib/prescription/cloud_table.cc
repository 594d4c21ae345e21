// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <limits>

#include "lib/prescription/cloud_table_internal.h"

namespace sagitta::prescription {
namespace {

// Letters and digits of a column's name in lower case: "Z [mm]" and z_mm are zmm.
std::string column_name(std::string_view field) {
  std::string name;
  for (const char c : field) {
    if (std::string_view(" \t_[]()\"'").find(c) != std::string_view::npos) continue;
    name += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return name;
}

bool is_spelled(const Column& column, const std::string& name) {
  return std::any_of(column.spellings.begin(), column.spellings.end(),
                     [&](std::string_view spelling) { return !spelling.empty() && column_name(spelling) == name; });
}

// What `part` says of each column, in one line.
template <class Part>
std::string listed(std::span<const Column> columns, std::string_view separator, Part&& part) {
  std::string text;
  for (const Column& column : columns) text += fmt::format("{}{}", text.empty() ? "" : separator, part(column));
  return text;
}

}  // namespace

bool TableReader::next() {
  while (understood_ && lines_.next()) {
    line_ = lines_.line();
    if (const std::size_t comment = line_.find('#'); comment != std::string_view::npos) line_ = line_.substr(0, comment);
    if (trimmed(line_).empty()) continue;
    if (first_) {
      first_ = false;
      understood_ = understand_first_line();
      if (!understood_ || has_header_) continue;
    }
    if (read_row()) return true;
  }
  if (!lines_.fault().empty()) errors_.add(errors_.at(lines_.number()), lines_.fault());
  return false;
}

bool TableReader::understand_first_line() {
  for (const char separator : {';', '\t', ',', ' '}) {
    separator_ = separator;
    if (separator != ' ' && line_.find(separator) == std::string_view::npos) continue;
    split();
    if (separator != '\t' || fields_.size() >= columns_.size()) break;
  }
  const auto is_number = [&](std::string_view field) {
    const NumberFault fault = parse_cloud_number(field, decimal_comma()).fault;
    return fault != NumberFault::garbage && fault != NumberFault::empty;
  };
  if (std::none_of(fields_.begin(), fields_.end(), is_number)) return read_header();
  if (fields_.size() <= columns_.size()) return true;
  const auto name = [](const Column& column) { return column.name; };
  errors_.add(errors_.at(lines_.number()), fmt::format("{} columns without a header line", fields_.size()),
              fmt::format("a first line such as {},quality names the columns; {} are read", listed(columns_, ",", name),
                          listed(columns_, ", ", name)));
  return false;
}

bool TableReader::read_header() {
  has_header_ = true;
  if (separator_ == ' ') {  // a unit that stands apart ("x [mm] y [mm]") is no column
    std::erase_if(fields_, [](std::string_view field) { return field.front() == '[' || field.front() == '('; });
  }
  std::vector<char> found(columns_.size(), false);
  for (std::size_t i = 0; i < fields_.size(); ++i) {
    const std::string name = column_name(fields_[i]);
    for (std::size_t k = 0; k < columns_.size(); ++k) {
      if (!is_spelled(columns_[k], name)) continue;
      if (found[k]) errors_.add(place_of(fields_[i]), fmt::format("a second column {}", columns_[k].name));
      found[k] = true;
      column_[k] = i;
    }
  }
  if (const auto absent = std::find(found.begin(), found.end(), false); absent != found.end()) {
    const auto spelled = [](const Column& column) {
      const auto end = std::find(column.spellings.begin(), column.spellings.end(), "");
      return fmt::format("{}", fmt::join(column.spellings.begin(), end, " or "));
    };
    errors_.add(errors_.at(lines_.number()),
                fmt::format("the header line names no column {}: {}", columns_[static_cast<std::size_t>(absent - found.begin())].name,
                            quoted(line_)),
                fmt::format("columns {} are found by name", listed(columns_, ", ", spelled)));
  }
  columns_needed_ = *std::max_element(column_.begin(), column_.end()) + 1;
  return errors_.none();
}

bool TableReader::read_row() {
  split();
  if (fields_.size() < columns_needed_ || (!has_header_ && fields_.size() > columns_.size())) {
    errors_.add(errors_.at(lines_.number()),
                fmt::format("{} {} where {}{} are needed: {}", fields_.size(), fields_.size() == 1 ? "column" : "columns",
                            has_header_ ? "at least " : "", columns_needed_, quoted(line_)),
                "a hole has nan for its z");
    return false;
  }
  for (std::size_t k = 0; k < columns_.size(); ++k) {
    const std::string_view field = fields_[column_[k]];
    const CloudNumber number = parse_cloud_number(field, decimal_comma());
    value_[k] = number.value;
    if (number.fault == NumberFault::none) continue;
    value_[k] = std::numeric_limits<double>::quiet_NaN();
    if (number.fault == NumberFault::empty) continue;
    errors_.add(place_of(field), fmt::format("{} is {}: {}", columns_[k].name, meaning_of(number.fault), quoted(field)),
                number.fault == NumberFault::garbage ? fmt::format("a number in {}, or nan for a hole", columns_[k].unit) : "");
    return false;
  }
  return true;
}

// Without a header a separator at the end of the line is no further column.
void TableReader::split() {
  if (separator_ == ' ') return split_at_blanks(line_, fields_);
  fields_.clear();
  for (std::string_view rest = line_;;) {
    const std::size_t stop = rest.find(separator_);
    fields_.push_back(rest.substr(0, stop));
    if (stop == std::string_view::npos) break;
    rest.remove_prefix(stop + 1);
  }
  if (!has_header_ && fields_.size() > columns_.size() && trimmed(fields_.back()).empty()) fields_.pop_back();
}

Place TableReader::place_of(std::string_view field) const {
  const std::size_t blanks = std::min(field.find_first_not_of(" \t"), field.size());
  return errors_.at(lines_.number(), static_cast<std::size_t>(field.data() - line_.data()) + blanks + 1);
}

}  // namespace sagitta::prescription
