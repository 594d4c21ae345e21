// SPDX-License-Identifier: Apache-2.0
// Format xyz: text with x, y, z in mm.
//
// One point a line; `#` starts a comment; empty lines count for nothing. The first line that says something decides how
// the fields of the whole file are separated: by `;` where it has one, else by tabs where they make three fields, else
// by commas, else by blanks. Where `;` or tabs separate, a comma in a number is a decimal comma (1,5;2,5;3): it can
// mean nothing else there.
//
// If no field of that line is a number it is a header: x, y and z are found by name (x, X, x_mm, "x [mm]", x(mm)),
// other columns are ignored. Without a header there are exactly three columns: a fourth makes it a guess which are meant.
//
// z `nan` or empty: a hole at (x, y). x or y `nan` or empty: no place; the line is left out and counted in a note.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>

#include "lib/prescription/cloud_formats_internal.h"

namespace sagitta::prescription {
namespace {

constexpr std::string_view axis_names = "xyz";

class XyzReader {
 public:
  XyzReader(const CloudRequest& request, Findings& findings)
      : request_(request), findings_(findings), errors_(request.file, findings), lines_(request.file) {}

  std::shared_ptr<const PointCloud> read() {
    auto cloud = std::make_shared<PointCloud>();
    cloud->file = request_.file;
    cloud_ = cloud.get();
    bool first = true, understood = true;
    while (understood && lines_.next()) {
      line_ = lines_.line();
      if (const std::size_t comment = line_.find('#'); comment != std::string_view::npos) line_ = line_.substr(0, comment);
      if (trimmed(line_).empty()) continue;
      if (first) {
        understood = read_first_line();
        first = false;
      } else {
        read_point();
      }
    }
    if (!lines_.fault().empty()) errors_.add(errors_.at(lines_.number()), lines_.fault());
    if (errors_.none() && cloud->points.empty()) errors_.add(errors_.at(0), "holds no points", "lines of x, y, z in mm");
    errors_.finish();
    tell_what_was_left_out();
    if (!errors_.none()) return nullptr;
    cloud->points.shrink_to_fit();
    cloud->lines.shrink_to_fit();
    return cloud;
  }

 private:
  // False: nothing sensible can be said about the lines that follow.
  bool read_first_line() {
    for (const char separator : {';', '\t', ',', ' '}) {
      separator_ = separator;
      if (separator != ' ' && line_.find(separator) == std::string_view::npos) continue;
      split();
      if (separator != '\t' || fields_.size() >= 3) break;
    }
    const auto is_number = [&](std::string_view field) {
      const NumberFault fault = parse_cloud_number(field, decimal_comma()).fault;
      return fault != NumberFault::garbage && fault != NumberFault::empty;
    };
    if (std::none_of(fields_.begin(), fields_.end(), is_number)) return read_header();
    if (fields_.size() > 3) {
      errors_.add(errors_.at(lines_.number()), fmt::format("{} columns without a header line", fields_.size()),
                  "a first line such as x,y,z,quality names the columns; x, y and z are read");
      return false;
    }
    read_point();
    return true;
  }

  bool read_header() {
    has_header_ = true;
    if (separator_ == ' ') {  // a unit that stands apart ("x [mm] y [mm]") is no column
      std::erase_if(fields_, [](std::string_view field) { return field.front() == '[' || field.front() == '('; });
    }
    std::array<bool, 3> found{};
    for (std::size_t i = 0; i < fields_.size(); ++i) {
      const std::string name = column_name(fields_[i]);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (name.empty() || name[0] != axis_names[axis]) continue;
        if (name.size() > 1 && name.substr(1) != "mm") continue;
        if (found[axis]) errors_.add(place_of(fields_[i]), fmt::format("a second column {}", axis_names[axis]));
        found[axis] = true;
        column_[axis] = i;
      }
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (found[axis]) continue;
      errors_.add(errors_.at(lines_.number()),
                  fmt::format("the header line names no column {}: {}", axis_names[axis], quoted(line_)),
                  "columns x, y and z (or x_mm, y_mm, z_mm) are found by name");
      break;
    }
    columns_needed_ = *std::max_element(column_.begin(), column_.end()) + 1;
    return errors_.none();
  }

  // Lower case letters of a column's name: "X [mm]" and x_mm are xmm.
  static std::string column_name(std::string_view field) {
    std::string name;
    for (const char c : field) {
      if (std::string_view(" \t_[]()\"'").find(c) != std::string_view::npos) continue;
      name += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    }
    return name;
  }

  void read_point() {
    split();
    if (fields_.size() < columns_needed_ || (!has_header_ && fields_.size() > 3)) {
      errors_.add(errors_.at(lines_.number()),
                  fmt::format("{} {} where {}{} are needed: {}", fields_.size(), fields_.size() == 1 ? "column" : "columns",
                              has_header_ ? "at least " : "", columns_needed_, quoted(line_)),
                  "a hole has nan for its z");
      return;
    }
    std::array<double, 3> value{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::string_view field = fields_[column_[axis]];
      const CloudNumber number = parse_cloud_number(field, decimal_comma());
      if (number.fault == NumberFault::empty) {
        value[axis] = std::numeric_limits<double>::quiet_NaN();
      } else if (number.fault != NumberFault::none) {
        errors_.add(place_of(field),
                    fmt::format("{} is {}: {}", axis_names[axis], meaning_of(number.fault), quoted(field)),
                    number.fault == NumberFault::garbage ? "a number in mm, or nan for a hole" : "");
        return;
      } else {
        value[axis] = number.value;
      }
    }
    if (std::isnan(value[0]) || std::isnan(value[1])) {
      if (without_place_++ == 0) first_without_place_ = lines_.number();
      return;
    }
    if (std::isnan(value[2]) && holes_++ == 0) first_hole_ = lines_.number();
    cloud_->points.push_back({request_.osa_axes ? -value[0] : value[0], value[1], value[2]});
    cloud_->lines.push_back(lines_.number());
  }

  // The fields of the line. Without a header a separator at the end of the line is no fourth column.
  void split() {
    fields_.clear();
    std::string_view rest = line_;
    if (separator_ == ' ') {
      for (rest = trimmed(rest); !rest.empty(); rest = trimmed(rest)) {
        const std::size_t stop = std::min(rest.find_first_of(" \t"), rest.size());
        fields_.push_back(rest.substr(0, stop));
        rest.remove_prefix(stop);
      }
      return;
    }
    for (;;) {
      const std::size_t stop = rest.find(separator_);
      fields_.push_back(rest.substr(0, stop));
      if (stop == std::string_view::npos) break;
      rest.remove_prefix(stop + 1);
    }
    if (!has_header_ && fields_.size() > 3 && trimmed(fields_.back()).empty()) fields_.pop_back();
  }

  bool decimal_comma() const { return separator_ == ';' || separator_ == '\t'; }

  Place place_of(std::string_view field) const {
    const std::size_t blanks = static_cast<std::size_t>(std::min(field.find_first_not_of(" \t"), field.size()));
    return errors_.at(lines_.number(), static_cast<std::size_t>(field.data() - line_.data()) + blanks + 1);
  }

  void tell_what_was_left_out() {
    const auto count = [](std::size_t lines) { return fmt::format("{} {}", lines, lines == 1 ? "line" : "lines"); };
    if (without_place_ > 0) {
      findings_.note(errors_.at(first_without_place_),
                     fmt::format("{} without a place (x or y is nan or empty), the first one here: left out",
                                 count(without_place_)));
    }
    if (holes_ > 0) {
      findings_.note(errors_.at(first_hole_),
                     fmt::format("{} without z (nan or empty), the first one here: holes", count(holes_)));
    }
  }

  const CloudRequest& request_;
  Findings& findings_;
  CloudErrors errors_;
  LineReader lines_;
  PointCloud* cloud_ = nullptr;

  std::string_view line_;
  std::vector<std::string_view> fields_;
  char separator_ = ' ';
  bool has_header_ = false;
  std::array<std::size_t, 3> column_{0, 1, 2};
  std::size_t columns_needed_ = 3;
  std::size_t without_place_ = 0, holes_ = 0;
  std::uint32_t first_without_place_ = 0, first_hole_ = 0;
};

}  // namespace

std::shared_ptr<const PointCloud> read_xyz(const CloudRequest& request, Findings& findings) {
  return XyzReader(request, findings).read();
}

}  // namespace sagitta::prescription
