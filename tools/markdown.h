// SPDX-License-Identifier: Apache-2.0
// The tables and texts of the pages that studies write.
#pragma once

#include <fmt/format.h>

#include <string>
#include <vector>

#include "lib/output/text.h"

namespace sagitta::tools {

// Somebody's text in a cell of a table or a line of Markdown.
inline std::string plain(const std::string& text) {
  std::string result;
  for (const char c : output::printable(text, 10'000)) {
    if (c == '|' || c == '<' || c == '*' || c == '`') result += '\\';
    result += c;
  }
  return result;
}

inline std::string line_of(const std::vector<std::string>& cells) { return fmt::format("| {} |\n", fmt::join(cells, " | ")); }

// Numbers stand at the right; the first column, of texts, at the left.
inline std::string head_of(const std::vector<std::string>& names) {
  std::string rule = "|---|";
  for (std::size_t i = 1; i < names.size(); ++i) rule += "--:|";
  return line_of(names) + rule + "\n";
}

}  // namespace sagitta::tools
