// SPDX-License-Identifier: Apache-2.0
// Records of named columns for other programs: as CSV (RFC 4180, lines end in LF), read back, and as JSON. Cells are texts; a number's is
// written as it is to be printed, an empty cell is a number that does not exist: null in JSON.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace sagitta::output {

struct RecordColumn {
  std::string name;
  bool is_text = false;
};

struct Records {
  std::vector<RecordColumn> columns;
  std::vector<std::vector<std::string>> rows;  // a cell for every column
};

std::string to_csv(const Records& records);

// The rows of a text that to_csv() made of these columns, in this order; none of any other text.
std::optional<std::vector<std::vector<std::string>>> rows_of_csv(std::string_view text, const std::vector<RecordColumn>& columns);

// {HEAD ..., "rows": [{COLUMN: value, ...}, ...]}; the head's values are texts.
std::string to_json(const std::vector<std::pair<std::string, std::string>>& head, const Records& records);

}  // namespace sagitta::output
