// SPDX-License-Identifier: Apache-2.0
#include "tools/given_rays.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <set>
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
// Columns of the listing that `sagitta rays` prints and that say nothing about where a ray starts.
constexpr std::array<std::string_view, 6> ignored_names{"ray", "field", "surface", "name", "opl_mm", "status"};
constexpr int most_errors = 20;
constexpr std::size_t longest_line = 1 << 20;

// std::getline with a bound, so that a file without line ends takes no more memory than that.
bool read_line(std::ifstream& stream, std::string& line) {
  line.clear();
  for (int c; (c = stream.get()) != EOF && c != '\n' && line.size() <= longest_line;) line.push_back(static_cast<char>(c));
  return stream.good() || !line.empty();
}

// Where each of column_names stands, or absent.
std::array<std::size_t, column_names.size()> read_header(const std::vector<Cell>& cells, const std::string& file, int number,
                                                         Findings& findings) {
  std::array<std::size_t, column_names.size()> where;
  where.fill(absent);
  std::vector<std::string> known(column_names.begin(), column_names.end());
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const auto found = std::find(column_names.begin(), column_names.end(), cells[i].text);
    const std::string text(cells[i].text);
    if (found == column_names.end()) {
      if (std::find(ignored_names.begin(), ignored_names.end(), cells[i].text) != ignored_names.end()) continue;
      const std::string near = prescription::nearest_name(text, known);
      findings.error({file, number, cells[i].column}, fmt::format("unknown column '{}'", prescription::excerpt(text)),
                     near.empty() ? "the columns are x_mm,y_mm,z_mm,l,m,n[,wavelength_nm]" : fmt::format("did you mean '{}'?", near));
      continue;
    }
    std::size_t& place = where[static_cast<std::size_t>(found - column_names.begin())];
    if (place != absent) findings.error({file, number, cells[i].column}, fmt::format("the column '{}' stands here a second time", text));
    place = i;
  }
  for (std::size_t c = 0; c < wavelength_column; ++c)
    if (where[c] == absent)
      findings.error({file, number, 1}, fmt::format("no column '{}' in the header line", column_names[c]),
                     "the first line names the columns: x_mm,y_mm,z_mm,l,m,n[,wavelength_nm]");
  return where;
}

}  // namespace

std::vector<GivenRay> read_given_rays(const std::string& file, double default_wavelength_nm, Findings& findings) {
  std::vector<GivenRay> rays;
  std::ifstream stream(file, std::ios::binary);
  if (!stream || stream.peek() == EOF) {
    std::error_code ignored;
    const char* const why = !std::filesystem::exists(file, ignored)         ? "there is no such file"
                            : std::filesystem::is_directory(file, ignored) ? "cannot be read: it is a folder"
                            : !stream.is_open()                             ? "cannot be read"
                                                                            : "the file is empty";
    findings.error({file, 1, 1}, why, "--from takes a CSV file with the columns x_mm,y_mm,z_mm,l,m,n[,wavelength_nm]");
    return rays;
  }
  std::array<std::size_t, column_names.size()> where{};
  std::size_t column_count = 0;
  bool have_header = false;
  std::string line;
  for (int number = 1; read_line(stream, line); ++number) {
    if (line.size() > longest_line) {
      findings.error({file, number, 1}, "the line is longer than 1 MiB");
      return rays;
    }
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (number == 1 && line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);
    if (line.find_first_not_of(" \t") == std::string::npos || line[0] == '#') continue;
    const std::vector<Cell> cells = cells_of(line);
    if (!have_header) {
      have_header = true;
      column_count = cells.size();
      where = read_header(cells, file, number, findings);
      if (findings.has_errors()) return rays;
      continue;
    }
    std::array<double, column_names.size()> value{};
    value[wavelength_column] = default_wavelength_nm;
    const int errors_before = findings.error_count();
    if (cells.size() > column_count)
      findings.error({file, number, cells[column_count].column}, fmt::format("more values than the {} columns of the header", column_count));
    for (std::size_t c = 0; c < column_names.size(); ++c) {
      if (where[c] == absent) continue;
      if (where[c] >= cells.size()) {
        findings.error({file, number, static_cast<int>(line.size()) + 1}, fmt::format("the line ends before the column '{}'", column_names[c]));
        break;
      }
      const Cell& cell = cells[where[c]];
      const auto parsed = prescription::parse_number(cell.text);
      if (parsed.ok && std::isfinite(parsed.value) && std::abs(parsed.value) > prescription::largest_number)
        findings.error({file, number, cell.column}, fmt::format("{}: {} is larger than {:g}, beyond which products are infinite", column_names[c],
                                                                prescription::excerpt(std::string(cell.text)), prescription::largest_number));
      else if (!parsed.ok || !std::isfinite(parsed.value) || (c == wavelength_column && !(parsed.value > 0)))
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

}  // namespace sagitta::tools
