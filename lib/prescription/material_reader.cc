// SPDX-License-Identifier: Apache-2.0
#include "lib/prescription/material_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include "lib/medium/formulas.h"
#include "lib/medium/table.h"
#include "lib/prescription/search_path.h"
#include "lib/prescription/yaml_tree.h"

namespace sagitta::prescription {
namespace {

namespace fs = std::filesystem;

constexpr int most_errors = 20;
constexpr const char* number_form = "numbers with a decimal point, without units, separated by blanks";
constexpr const char* table_form = "`data: |` and then a row a line: um, n";

std::vector<std::string> words(std::string_view text) {
  constexpr std::string_view blanks = " \t\r\n";
  std::vector<std::string> found;
  for (std::size_t begin = text.find_first_not_of(blanks); begin != std::string_view::npos;) {
    const std::size_t end = std::min(text.find_first_of(blanks, begin), text.size());
    found.emplace_back(text.substr(begin, end - begin));
    begin = text.find_first_not_of(blanks, end);
  }
  return found;
}

class MaterialFile {
 public:
  MaterialFile(std::string file, Findings& findings)
      : file_(std::move(file)), name_(fs::path(file_).stem().string()), findings_(findings), errors_before_(findings.error_count()) {}

  std::optional<medium::Medium> read() {
    Findings of_text;
    const YamlNode::Pointer root = read_yaml(file_, of_text);
    for (const Finding& one : of_text.all()) {
      if (is_full()) return std::nullopt;
      findings_.add(one);
    }
    if (!root) return std::nullopt;
    const YamlNode::Pointer data = root->find("DATA");
    if (!data || data->kind != YamlNode::Kind::sequence) {
      findings_.error(data ? data->place : Place{file_}, data ? "DATA is not a list" : "no DATA: not a medium",
                      "a medium is written as refractiveindex.info does: DATA, a list of entries with a type");
      return std::nullopt;
    }
    for (const YamlNode::Pointer& entry : data->items) {
      read_entry(*entry);
      if (is_full()) break;
    }
    if (!source_ && error_count() == 0)
      findings_.error(data->place, "no refractive index n in DATA", "an entry of type formula N, tabulated n or tabulated nk gives one");
    return error_count() == 0 ? std::move(medium_) : std::nullopt;
  }

 private:
  struct Row {
    medium::Sample sample;
    int line = 0;
  };

  int error_count() const { return findings_.error_count() - errors_before_; }

  // True, with a note once, when the file has had its share of errors.
  bool is_full() {
    if (error_count() < most_errors) return false;
    if (!std::exchange(told_full_, true)) findings_.note({file_}, "too many errors, the rest of this file was not read");
    return true;
  }

  void read_entry(const YamlNode& entry) {
    const YamlNode::Pointer type = entry.find("type");
    if (!type || type->kind != YamlNode::Kind::scalar) {
      findings_.error(entry.place, "an entry of DATA without a type", "such as `- type: tabulated nk`");
      return;
    }
    const std::vector<std::string> kind = words(type->text);
    const bool is_formula = kind.size() == 2 && kind[0] == "formula";
    const bool is_table = kind.size() == 2 && kind[0] == "tabulated";
    if (is_table && (kind[1] == "k" || kind[1] == "n2")) return;
    if (!is_formula && !(is_table && (kind[1] == "n" || kind[1] == "nk"))) {
      const std::string near = nearest_name(type->text, {"tabulated n", "tabulated nk", "tabulated k", "tabulated n2", "formula 1"});
      findings_.error(type->place, fmt::format("unknown type '{}'", excerpt(type->text)),
                      near.empty() ? "legal: formula 1 to 9, tabulated n, nk, k, n2" : fmt::format("did you mean '{}'?", near));
      return;
    }
    if (source_) {
      findings_.warning(type->place, "n is given once more here, which is not used",
                        fmt::format("the entry on line {} counts; put the other into a file of its own", source_->line));
      return;
    }
    source_ = type->place;
    if (is_formula)
      read_formula(entry, *type, kind[1]);
    else
      read_table(entry, kind[1] == "nk" ? 3 : 2);
  }

  void read_formula(const YamlNode& entry, const YamlNode& type, std::string_view number_text) {
    int number = 0;
    const auto [end, status] = std::from_chars(number_text.data(), number_text.data() + number_text.size(), number);
    const bool is_number = status == std::errc{} && end == number_text.data() + number_text.size();
    const medium::Formula* formula = is_number ? medium::find_formula(number) : nullptr;
    if (!formula) {
      findings_.error(type.place, fmt::format("unknown dispersion formula '{}'", excerpt(std::string(number_text))),
                      fmt::format("formulas are numbered 1 to {}", medium::formulas().size()));
      return;
    }
    const YamlNode::Pointer range_text = text_of(entry, entry.find("range") ? "range" : "wavelength_range");
    const YamlNode::Pointer coefficients_text = text_of(entry, "coefficients");
    const std::optional<std::vector<double>> range = numbers(range_text);
    const std::optional<std::vector<double>> coefficients = numbers(coefficients_text);
    if (range && !(range->size() == 2 && (*range)[0] >= medium::least_wavelength_um && (*range)[0] <= (*range)[1] && (*range)[1] <= medium::largest_wavelength_um))
      findings_.error(range_text->place,
                      fmt::format("the range '{}' is not two wavelengths in um, {} <= shortest <= longest <= {}", excerpt(range_text->text),
                                  medium::least_wavelength_um, medium::largest_wavelength_um),
                      range->size() == 2 && (*range)[0] > (*range)[1] ? "swap them" : "");
    if (coefficients && !formula->accepts(coefficients->size()))
      findings_.error(coefficients_text->place,
                      fmt::format("formula {} ({}) takes {} coefficients, not {}", number, formula->name, formula->counts, coefficients->size()),
                      "C1 comes first, then every term in full");
    if (!coefficients || !range || error_count() > 0) return;

    medium_ = medium::from_formula(name_, *formula, *coefficients, (*range)[0], (*range)[1]);
    if (const std::optional<double> bad_um = medium::wavelength_without_index(*medium_))
      findings_.error(coefficients_text->place,
                      fmt::format("formula {} ({}) gives no index from {} to {} at {:.6g} um, inside its range", number, formula->name, medium::least_index,
                                  medium::largest_index, *bad_um),
                      "check the coefficients, the number of the formula (1 squares C3, C5, ...; 2 does not) and the range");
  }

  // The value of a key that must be a text; null, and an error, where it is not.
  YamlNode::Pointer text_of(const YamlNode& entry, std::string_view key) {
    const YamlNode::Pointer node = entry.find(key);
    if (node && node->kind == YamlNode::Kind::scalar) return node;
    const std::string form = key == "data" ? table_form : number_form;
    if (node)
      findings_.error(node->place, fmt::format("the value of '{}' is not a text", key), form);
    else
      findings_.error(entry.place, fmt::format("the key '{}' is missing", key), form);
    return nullptr;
  }

  // The finite numbers of a text, which may go over several lines.
  std::optional<std::vector<double>> numbers(const YamlNode::Pointer& text) {
    if (!text) return std::nullopt;
    std::vector<double> values;
    for (const std::string& word : words(text->text)) {
      const ParsedNumber number = parse_number(word);
      if (!(number.ok && std::isfinite(number.value))) {
        findings_.error(text->place, fmt::format("'{}' is not a finite number (number {} here)", excerpt(word), values.size() + 1), number_form);
        return std::nullopt;
      }
      values.push_back(number.value);
    }
    return values;
  }

  void read_table(const YamlNode& entry, std::size_t column_count) {
    const YamlNode::Pointer data = text_of(entry, "data");
    if (!data) return;
    std::vector<Row> rows = read_rows(*data, column_count);
    if (rows.empty() && error_count() == 0) findings_.error(data->place, "the table is empty", table_form);
    const auto is_shorter = [](const Row& a, const Row& b) { return a.sample.wavelength_um < b.sample.wavelength_um; };
    if (const auto first = std::is_sorted_until(rows.begin(), rows.end(), is_shorter); first != rows.end()) {
      findings_.note({file_, first->line, 1}, "the rows are not in order of wavelength; they were sorted");
      std::stable_sort(rows.begin(), rows.end(), is_shorter);
    }
    std::vector<medium::Sample> samples;
    for (const Row& row : rows) {
      if (samples.empty() || samples.back().wavelength_um != row.sample.wavelength_um) {
        samples.push_back(row.sample);
      } else if (samples.back().index != row.sample.index) {
        findings_.error({file_, row.line, 1}, fmt::format("a second index at {} um", row.sample.wavelength_um), "one of the two rows must go");
        if (is_full()) break;
      }
    }
    if (error_count() == 0) medium_ = medium::from_table(name_, std::move(samples));
  }

  std::vector<Row> read_rows(const YamlNode& data, std::size_t column_count) {
    std::vector<Row> rows;
    // A text of several lines is a literal block: its place is that of the `|`, and it begins on the line below.
    int line = data.place.line + (data.text.find('\n') == std::string::npos ? 0 : 1);
    for (std::size_t begin = 0; begin < data.text.size() && !is_full(); ++line) {
      const std::size_t end = std::min(data.text.find('\n', begin), data.text.size());
      const std::string text = data.text.substr(begin, end - begin);
      begin = end + 1;
      const std::vector<std::string> columns = words(text);
      if (columns.empty()) continue;
      const Place place{file_, line, 1};
      std::vector<double> values;
      for (const std::string& column : columns) {
        const ParsedNumber number = parse_number(column);
        if (number.ok && std::isfinite(number.value)) values.push_back(number.value);
      }
      if (columns.size() != column_count || values.size() != column_count)
        findings_.error(place, fmt::format("'{}' is not a row of {} finite numbers", excerpt(text), column_count),
                        fmt::format("{}; each row on a line of its own below `data: |`", column_count == 3 ? "um, n, k" : "um, n"));
      else if (!(values[0] >= medium::least_wavelength_um && values[0] <= medium::largest_wavelength_um && values[1] >= medium::least_index && values[1] <= medium::largest_index))
        findings_.error(place, fmt::format("'{}': the wavelength must be from {} to {} um, and n from {} to {}", excerpt(text), medium::least_wavelength_um,
                                           medium::largest_wavelength_um, medium::least_index, medium::largest_index));
      else
        rows.push_back({{values[0], values[1]}, line});
    }
    return rows;
  }

  std::string file_, name_;
  Findings& findings_;
  int errors_before_;
  bool told_full_ = false;
  std::optional<Place> source_;  // of the entry that gives n
  std::optional<medium::Medium> medium_;
};

bool is_plain_name(std::string_view name) {
  const auto is_harmful = [](char c) { return c == '/' || c == '\\' || static_cast<unsigned char>(c) < 0x20; };
  return !name.empty() && name.find("..") == std::string_view::npos && std::none_of(name.begin(), name.end(), is_harmful);
}

// The names of all media in the search path, in a fixed order.
std::vector<std::string> known_names(const std::string& beside) {
  std::set<std::string> names{"air"};
  for (const std::string& folder : search_folders(beside)) {
    std::error_code failure;
    for (fs::directory_iterator file(fs::path(folder) / "materials", failure), end; !failure && file != end; file.increment(failure)) {
      if (file->path().extension() == ".yml") names.insert(file->path().stem().string());
    }
  }
  return {names.begin(), names.end()};
}

std::string nearest_medium(const std::string& name, const std::vector<std::string>& known) {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; };
  for (const std::string& candidate : known) {
    if (std::ranges::equal(candidate, name, {}, lower, lower)) return candidate;
  }
  return nearest_name(name, known);
}

}  // namespace

std::optional<medium::Medium> read_material(const std::string& file, Findings& findings) {
  return MaterialFile(file, findings).read();
}

std::optional<medium::Medium> find_material(const std::string& name, const Place& named_at, Findings& findings) {
  if (name == "air") return medium::air();
  const std::string ways = "a medium is air, the name of a file materials/NAME.yml, {index: ...} or {nd: ..., vd: ...}";
  if (!is_plain_name(name)) {
    findings.error(named_at, fmt::format("'{}' is not the name of a medium", excerpt(name)), ways);
    return std::nullopt;
  }
  const std::string beside = fs::path(named_at.file).parent_path().string();
  const fs::path own = fs::path(beside) / (name + ".yml");
  std::error_code failure;
  const std::optional<std::string> file =
      fs::is_regular_file(own, failure) ? std::optional(own.string()) : find_file("materials/" + name + ".yml", beside);
  if (!file) {
    const std::string near = nearest_medium(name, known_names(beside));
    findings.error(named_at, fmt::format("unknown medium '{}'", excerpt(name)),
                   near.empty() ? ways : fmt::format("did you mean '{}'?", excerpt(near)));
    return std::nullopt;
  }
  const int errors_before = findings.error_count();
  std::optional<medium::Medium> medium = read_material(*file, findings);
  if (findings.error_count() > errors_before) findings.note(named_at, "named here");
  return medium;
}

}  // namespace sagitta::prescription
