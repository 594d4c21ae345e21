// SPDX-License-Identifier: Apache-2.0
#include "tools/given_rays.h"

#include <fmt/core.h>

#include <array>
#include <cmath>
#include <fstream>
#include <limits>
#include <string_view>

#include "lib/prescription/yaml_tree.h"

namespace sagitta::tools {
namespace {

using prescription::Findings;
using prescription::Place;

struct Cell {
  std::string_view text;
  int column;  // from 1, in bytes
};

std::vector<Cell> cells_of(std::string_view line) {
  std::vector<Cell> cells;
  for (std::size_t from = 0;;) {
    const std::size_t comma = std::min(line.find(',', from), line.size());
    std::size_t first = from, last = comma;
    while (first < last && (line[first] == ' ' || line[first] == '\t')) ++first;
    while (last > first && (line[last - 1] == ' ' || line[last - 1] == '\t')) --last;
    cells.push_back({line.substr(first, last - first), static_cast<int>(first) + 1});
    if (comma == line.size()) return cells;
    from = comma + 1;
  }
}

constexpr std::array<std::string_view, 7> column_names{"x_mm", "y_mm", "z_mm", "l", "m", "n", "wavelength_nm"};
constexpr std::size_t wavelength_column = 6, absent = std::numeric_limits<std::size_t>::max();
constexpr int most_errors = 20;

}  // namespace

std::vector<GivenRay> read_given_rays(const std::string& file, double default_wavelength_nm, Findings& findings) {
  std::vector<GivenRay> rays;
  std::ifstream stream(file);
  if (!stream) {
    findings.error({file, 1, 1}, "cannot be read", "--from takes a CSV file with the columns x_mm,y_mm,z_mm,l,m,n[,wavelength_nm]");
    return rays;
  }
  std::array<std::size_t, column_names.size()> where;
  where.fill(absent);
  bool have_header = false;
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (number == 1 && line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);
    if (line.find_first_not_of(" \t") == std::string::npos || line[0] == '#') continue;
    const std::vector<Cell> cells = cells_of(line);
    if (!have_header) {
      have_header = true;
      for (std::size_t i = 0; i < cells.size(); ++i)
        for (std::size_t c = 0; c < column_names.size(); ++c)
          if (cells[i].text == column_names[c]) where[c] = i;
      for (std::size_t c = 0; c < wavelength_column; ++c)
        if (where[c] == absent)
          findings.error({file, number, 1}, fmt::format("no column '{}' in the header line", column_names[c]),
                         "the first line names the columns: x_mm,y_mm,z_mm,l,m,n[,wavelength_nm]");
      if (findings.has_errors()) return rays;
      continue;
    }
    std::array<double, column_names.size()> value{};
    value[wavelength_column] = default_wavelength_nm;
    const int errors_before = findings.error_count();
    for (std::size_t c = 0; c < column_names.size(); ++c) {
      if (where[c] == absent) continue;
      if (where[c] >= cells.size()) {
        findings.error({file, number, static_cast<int>(line.size()) + 1}, fmt::format("the line ends before the column '{}'", column_names[c]));
        break;
      }
      const Cell& cell = cells[where[c]];
      const auto parsed = prescription::parse_number(cell.text);
      if (!parsed.ok || !std::isfinite(parsed.value) || (c == wavelength_column && !(parsed.value > 0)))
        findings.error({file, number, cell.column},
                       fmt::format("{}: '{}' is not a {} number", column_names[c], prescription::excerpt(std::string(cell.text)),
                                   c == wavelength_column ? "positive finite" : "finite"));
      value[c] = parsed.value;
    }
    numerics::Vec3<double> direction{value[3], value[4], value[5]};
    const double length = norm(direction);
    if (findings.error_count() == errors_before && !(std::abs(length - 1) <= 1e-3))
      findings.error({file, number, cells[where[3]].column}, fmt::format("the direction (l, m, n) has the length {:.6g}", length),
                     "direction cosines have the length 1");
    if (std::abs(length - 1) > 4 * std::numeric_limits<double>::epsilon()) direction = (1 / length) * direction;
    rays.push_back({{value[0], value[1], value[2]}, direction, value[wavelength_column]});
    if (findings.error_count() >= most_errors) return rays;
  }
  if (rays.empty() && !findings.has_errors()) findings.error({file, 1, 1}, "holds no ray");
  return rays;
}

bool set_wavelengths(prescription::Model& model, const std::vector<double>& wavelengths_nm, const std::string& source) {
  bool covered = true;
  const auto check = [&](const medium::Medium& medium, double nm) {
    if (medium.covers(nm / 1000)) return;
    covered = false;
    fmt::print(stderr, "sagitta rays: {}: {:g} nm lies outside the range of {}, {:g} to {:g} nm\n", source, nm, medium.name,
               medium.shortest_um * 1e3, medium.longest_um * 1e3);
  };
  for (const double nm : wavelengths_nm) {
    check(model.object.medium, nm);
    for (const auto& surface : model.surfaces)
      if (surface.medium) check(*surface.medium, nm);
  }
  model.primary_nm = model.primary_wavelength_nm();
  model.wavelengths_nm = wavelengths_nm;
  return covered;
}

}  // namespace sagitta::tools
