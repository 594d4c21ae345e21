// SPDX-License-Identifier: Apache-2.0
// Numbers in named columns of a text file, a row a line: what the formats xyz and polar share.
//
// `#` starts a comment; empty lines count for nothing. The first line that says something decides how the fields of the
// whole file are separated: by `;` where it has one, else by tabs where they make enough fields, else by commas, else by
// blanks. Where `;` or tabs separate, a comma in a number is a decimal comma (1,5;2,5;3): it can mean nothing else there.
//
// If no field of that line is a number it is a header: the columns are found by name (z, Z, z_mm, "z [mm]", z(mm)),
// others are ignored. Without a header there are exactly the wanted columns, in their order: one more makes it a guess
// which are meant.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lib/prescription/cloud_formats_internal.h"

namespace sagitta::prescription {

struct Column {
  std::string_view name;       // in messages
  std::string_view unit;       // in messages: "mm"
  std::array<std::string_view, 3> spellings;  // in a header, as many as not empty; case, blanks, quotes, brackets, _ do not count
};

class TableReader {
 public:
  // Both stay with the caller, and so do the errors.
  TableReader(const std::string& file, std::span<const Column> columns, CloudErrors& errors)
      : columns_(columns), errors_(errors), lines_(file), column_(columns.size()), value_(columns.size()) {
    for (std::size_t i = 0; i < columns.size(); ++i) column_[i] = i;
  }

  // The next row. Rows with an error are told of and passed over; false at the end.
  bool next();
  double value(std::size_t column) const { return value_[column]; }  // NaN: `nan`, or empty
  std::string_view text(std::size_t column) const { return trimmed(fields_[column_[column]]); }
  std::uint32_t line() const { return lines_.number(); }
  Place place_of(std::size_t column) const { return place_of(fields_[column_[column]]); }

 private:
  bool understand_first_line();  // false: nothing sensible can be said about the lines that follow
  bool read_header();
  bool read_row();
  void split();
  bool decimal_comma() const { return separator_ == ';' || separator_ == '\t'; }
  Place place_of(std::string_view field) const;

  std::span<const Column> columns_;
  CloudErrors& errors_;
  LineReader lines_;
  std::vector<std::size_t> column_;  // where each wanted column stands
  std::vector<double> value_;
  std::string_view line_;
  std::vector<std::string_view> fields_;
  char separator_ = ' ';
  bool has_header_ = false, first_ = true, understood_ = true;
  std::size_t columns_needed_ = columns_.size();
};

}  // namespace sagitta::prescription
