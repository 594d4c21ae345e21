// SPDX-License-Identifier: Apache-2.0
// Format zemax: the .DAT file of OpticStudio's Grid Sag surface.
//
//   nx ny delx dely unitflag xdec ydec
//   z dz/dx dz/dy d2z/dxdy [nodata]         nx ny lines, row by row from the top: the first has the least x and the largest y
//
// unitflag   of delx, dely, xdec, ydec, z and 1/(d2z/dxdy): 0 mm, 1 cm, 2 in, 3 m
// delx, dely spacings, of which the sizes count; xdec, ydec where the middle of the grid is
// nodata     not 0: nothing is known here. So too where z is nan
//
// `!` starts a comment; empty lines count for nothing. Where no line has a slope or twist but 0 the file has none: they follow from the heights
// (scene/compile_grid.h). A line may have z alone.
//
// OpticStudio itself takes a flagged node for a height of 0 and traces on, over a cliff; here rays end as outside_data in the cells around it.
//
// Source: Zemax OpticStudio's help, "Grid Sag".
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>

#include "lib/prescription/grid_formats_internal.h"
#include "lib/surface/grid.h"

namespace sagitta::prescription {
namespace {

constexpr std::array mm_per_unit{1.0, 10.0, 25.4, 1000.0};
constexpr std::string_view header_form = "nx ny delx dely unitflag xdec ydec";

class ZemaxGridReader {
 public:
  ZemaxGridReader(const GridRequest& request, CloudErrors& errors) : errors_(errors), lines_(request.file) {}

  std::shared_ptr<SagGrid> read(Findings& findings) {
    bool goes_on = next() ? read_header() : false;
    if (!goes_on && errors_.none() && lines_.fault().empty()) errors_.add(errors_.at(0), "holds no grid", fmt::format("a line {}, then one for each node", header_form));
    while (goes_on && next()) goes_on = read_node();
    if (!lines_.fault().empty()) errors_.add(errors_.at(lines_.number()), lines_.fault());
    else if (goes_on && grid_->nodes.size() < node_count())
      errors_.add(errors_.at(lines_.number()), fmt::format("the file ends after {} nodes of {}", grid_->nodes.size(), announced()));
    without_data_.tell(errors_, findings, "without data (flagged, or z is nan)", "cells around it are holes");
    if (errors_.none()) finish();
    return std::move(grid_);
  }

 private:
  std::size_t node_count() const { return static_cast<std::size_t>(grid_->count_x) * static_cast<std::size_t>(grid_->count_y); }
  std::string announced() const { return fmt::format("{} x {} = {}", grid_->count_x, grid_->count_y, node_count()); }

  // The next line that says something, as fields.
  bool next() {
    while (lines_.next()) {
      split_at_blanks(lines_.line().substr(0, lines_.line().find('!')), fields_);
      if (!fields_.empty()) return true;
    }
    return false;
  }
  void refuse(std::size_t field, std::string_view name, std::string_view what, std::string hint = {}) {
    const auto column = static_cast<std::size_t>(fields_[field].data() - lines_.line().data()) + 1;
    errors_.add(errors_.at(lines_.number(), column), fmt::format("{} {}: {}", name, what, quoted(fields_[field])), std::move(hint));
  }
  // NaN, with an error, where it is none of a size from least to most, or 0.
  double number(std::size_t field, std::string_view name, double most, bool may_be_nan = false) {
    const CloudNumber read = parse_cloud_number(fields_[field], false);
    if (read.fault != NumberFault::none) refuse(field, name, fmt::format("is {}", meaning_of(read.fault)));
    else if (std::isnan(read.value) && !may_be_nan) refuse(field, name, "is no number");
    else if (std::abs(read.value) > most) refuse(field, name, fmt::format("is beyond {:g}", most));
    else return read.value;
    return std::numeric_limits<double>::quiet_NaN();
  }
  int count(std::size_t field, std::string_view name) {
    const double value = number(field, name, largest_grid_length);
    if (std::isnan(value)) return 0;
    if (value == std::floor(value) && value >= surface::fewest_grid_nodes && value <= surface::most_grid_nodes) return static_cast<int>(value);
    refuse(field, name, fmt::format("is no whole number from {} to {}", surface::fewest_grid_nodes, surface::most_grid_nodes));
    return 0;
  }
  double spacing(std::size_t field, std::string_view name) {
    const double size = std::abs(number(field, name, largest_grid_length));
    if (size < smallest_grid_length) refuse(field, name, fmt::format("is below {:g}", smallest_grid_length));
    return size;
  }

  // False: what follows cannot be told.
  bool read_header() {
    if (fields_.size() != 7) {
      errors_.add(errors_.at(lines_.number()), fmt::format("{} numbers where 7 are needed: {}", fields_.size(), quoted(lines_.line())),
                  fmt::format("the first line is {}", header_form));
      return false;
    }
    grid_->count_x = count(0, "nx"), grid_->count_y = count(1, "ny");
    grid_->spacing_x = spacing(2, "delx"), grid_->spacing_y = spacing(3, "dely");
    const double unit = number(4, "unitflag", largest_grid_length);
    middle_x_ = number(5, "xdec", largest_grid_length), middle_y_ = number(6, "ydec", largest_grid_length);
    if (unit == 0 || unit == 1 || unit == 2 || unit == 3) unit_ = mm_per_unit[static_cast<std::size_t>(unit)];
    else if (!std::isnan(unit)) refuse(4, "unitflag", "is none of 0 (mm), 1 (cm), 2 (in) and 3 (m)");
    return errors_.none();
  }

  bool read_node() {
    if (grid_->nodes.size() == node_count()) {
      errors_.add(errors_.at(lines_.number()), fmt::format("more nodes than the first line announces: {}", announced()));
      return false;
    }
    if (fields_.size() != 1 && fields_.size() != 4 && fields_.size() != 5) {
      errors_.add(errors_.at(lines_.number()), fmt::format("{} numbers where 1, 4 or 5 are needed: {}", fields_.size(), quoted(lines_.line())),
                  "each node is z dz/dx dz/dy d2z/dxdy [nodata], or z alone");
      grid_->nodes.push_back({});
      return true;
    }
    SagGrid::Node node{number(0, "z", largest_grid_value, true), 0, 0, 0};
    if (fields_.size() > 1)
      node = {node.z, number(1, "dz/dx", largest_grid_value), number(2, "dz/dy", largest_grid_value), number(3, "d2z/dxdy", largest_grid_value)};
    const bool is_flagged = fields_.size() == 5 && number(4, "nodata", largest_grid_value) != 0;
    if (is_flagged || std::isnan(node.z)) {
      without_data_.add(lines_.number());
      node = {std::numeric_limits<double>::quiet_NaN(), 0, 0, 0};
    }
    grid_->nodes.push_back(node);
    return true;
  }

  // Into mm, and from the order of the file into rows of rising y.
  void finish() {
    SagGrid& grid = *grid_;
    grid.spacing_x *= unit_, grid.spacing_y *= unit_;
    grid.first_x = unit_ * middle_x_ - grid.spacing_x * (grid.count_x - 1) / 2;
    grid.first_y = unit_ * middle_y_ - grid.spacing_y * (grid.count_y - 1) / 2;
    grid.has_given_slopes = false;
    for (SagGrid::Node& node : grid.nodes) {
      node.z *= unit_, node.d2z_dxdy /= unit_;
      if (node.dz_dx != 0 || node.dz_dy != 0 || node.d2z_dxdy != 0) grid.has_given_slopes = true;
    }
    const auto row = static_cast<std::ptrdiff_t>(grid.count_x);
    for (std::ptrdiff_t low = 0, high = grid.count_y - 1; low < high; ++low, --high)
      std::swap_ranges(grid.nodes.begin() + low * row, grid.nodes.begin() + (low + 1) * row, grid.nodes.begin() + high * row);
  }

  CloudErrors& errors_;
  LineReader lines_;
  std::vector<std::string_view> fields_;
  std::shared_ptr<SagGrid> grid_ = std::make_shared<SagGrid>();
  double unit_ = 1, middle_x_ = 0, middle_y_ = 0;
  Tally without_data_;
};

}  // namespace

std::shared_ptr<SagGrid> read_zemax_grid(const GridRequest& request, CloudErrors& errors, Findings& findings) {
  return ZemaxGridReader(request, errors).read(findings);
}

}  // namespace sagitta::prescription
