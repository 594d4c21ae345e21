// SPDX-License-Identifier: Apache-2.0
// A table for people: aligned columns of plain text, names and units above a rule.
//
//   field  RMS radius
//                  µm
//   -----  ----------
//   0, 10       12.35
//
// Columns are as wide as their widest cell, two blanks apart; no line ends in a blank. Names and units stand over their
// column's side. Cells pass through printable(): a name from a file cannot steer the terminal.
#pragma once

#include <string>
#include <vector>

namespace sagitta::output {

struct Column {
  std::string name;
  std::string unit;   // a second line of the head, where any column has one
  bool text = false;  // from the left; numbers stand at the right
};

struct Table {
  std::vector<Column> columns;
  std::vector<std::vector<std::string>> rows;  // missing cells are blank, cells beyond the columns are not shown
};

std::string to_text(const Table& table);

}  // namespace sagitta::output
