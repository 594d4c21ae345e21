// SPDX-License-Identifier: Apache-2.0
#include "lib/prescription/agf_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <initializer_list>
#include <utility>

#include "lib/medium/formulas.h"
#include "lib/prescription/text_file.h"
#include "lib/prescription/yaml_tree.h"

namespace sagitta::prescription {
namespace {

constexpr std::size_t coefficient_count = 10;
using Coefficients = std::array<double, coefficient_count>;  // [0] is c1

// Pairs K, L as they stand.
template <std::size_t terms>
std::vector<double> sellmeier(const Coefficients& c) {
  std::vector<double> result{0};
  result.insert(result.end(), c.begin(), c.begin() + 2 * terms);
  return result;
}

// A constant and powers of L, one for each further coefficient.
std::vector<double> powers(const Coefficients& c, std::initializer_list<double> exponents) {
  std::vector<double> result{c[0]};
  std::size_t i = 1;
  for (const double exponent : exponents) result.insert(result.end(), {c[i++], exponent});
  return result;
}

struct AgfFormula {
  const char* name;
  int number;  // of the formula of lib/medium that says the same with the coefficients that `coefficients` gives
  std::vector<double> (*coefficients)(const Coefficients& c);
};

// By number, from 1.
constexpr AgfFormula formulas[] = {
    {"Schott", 3, [](const Coefficients& c) { return powers(c, {2, -2, -4, -6, -8}); }},
    {"Sellmeier 1", 2, sellmeier<3>},
    {"Herzberger", 7, [](const Coefficients& c) { return std::vector<double>(c.begin(), c.begin() + 6); }},
    {"Sellmeier 2", 4, [](const Coefficients& c) { return std::vector<double>{1 + c[0], c[1], 2, c[2], 2, c[3], 0, c[4], 2}; }},
    {"Conrady", 5, [](const Coefficients& c) { return powers(c, {-1, -3.5}); }},
    {"Sellmeier 3", 2, sellmeier<4>},
    {"Handbook 1", 4, [](const Coefficients& c) { return std::vector<double>{c[0], c[1], 0, c[2], 1, 0, 0, 0, 0, -c[3], 2}; }},
    {"Handbook 2", 4, [](const Coefficients& c) { return std::vector<double>{c[0], c[1], 2, c[2], 1, 0, 0, 0, 0, -c[3], 2}; }},
    {"Sellmeier 4", 4, [](const Coefficients& c) { return std::vector<double>{c[0], c[1], 2, c[2], 1, c[3], 2, c[4], 1}; }},
    {"Extended", 3, [](const Coefficients& c) { return powers(c, {2, -2, -4, -6, -8, -10, -12}); }},
    {"Sellmeier 5", 2, sellmeier<5>},
    {"Extended 2", 3, [](const Coefficients& c) { return powers(c, {2, -2, -4, -6, -8, 4, 6}); }},
    {"Extended 3", 3, [](const Coefficients& c) { return powers(c, {2, 4, -2, -4, -6, -8, -10, -12}); }},
};

constexpr std::string_view blanks = " \t\f\v";

struct Word {
  std::string_view text;
  int column = 0;
};

std::vector<Word> words(const AgfLine& line) {
  std::vector<Word> found;
  const std::string_view text = line.text;
  for (std::size_t begin = text.find_first_not_of(blanks); begin != std::string_view::npos;) {
    const std::size_t end = std::min(text.find_first_of(blanks, begin), text.size());
    found.push_back({text.substr(begin, end - begin), line.column + static_cast<int>(begin)});
    begin = text.find_first_not_of(blanks, end);
  }
  return found;
}

std::string trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(blanks);
  return begin == std::string_view::npos ? std::string() : std::string(text.substr(begin, text.find_last_not_of(blanks) + 1 - begin));
}

// The letters at the start of a line, and what follows them.
struct Statement {
  std::string_view letters;
  AgfLine rest;
};

Statement statement(std::string_view line, int number) {
  const std::size_t begin = line.find_first_not_of(blanks);
  if (begin == std::string_view::npos) return {};
  const std::size_t end = std::min(line.find_first_of(blanks, begin), line.size());
  return {line.substr(begin, end - begin), {std::string(line.substr(end)), number, static_cast<int>(end) + 1}};
}

class CatalogFile {
 public:
  CatalogFile(const std::string& file, Findings& findings) : findings_(findings) { catalog_.file = file; }

  std::optional<AgfCatalog> read(std::string_view text) {
    int number = 1;
    for (std::size_t begin = 0; begin < text.size(); ++number) {
      const std::size_t end = std::min(text.find_first_of("\r\n", begin), text.size());
      take(statement(text.substr(begin, end - begin), number));
      if (catalog_.glasses.size() > most_agf_glasses) {
        findings_.error({catalog_.file, number, 1}, fmt::format("more than {} glasses", most_agf_glasses), "split the catalogue");
        return std::nullopt;
      }
      begin = end + (text.substr(end).starts_with("\r\n") ? 2 : 1);
    }
    if (catalog_.glasses.empty()) {
      findings_.error({catalog_.file}, "no glass: not a catalogue in the AGF format", "a glass begins with a line `NM NAME FORMULA ...`");
      return std::nullopt;
    }
    if (repeated_count_ > 0)
      findings_.warning(first_repeated_, fmt::format("{} of the glasses {} a name that stands here before, the first one on this line; not used", repeated_count_,
                                                     repeated_count_ == 1 ? "has" : "have"));
    return std::move(catalog_);
  }

 private:
  void take(Statement line) {
    if (line.letters == "NM") return begin_glass(std::move(line.rest));
    if (line.letters == "CC" && catalog_.glasses.empty() && catalog_.comment.empty()) catalog_.comment = trimmed(line.rest.text);
    if (!glass_) return;
    AgfLine* const place = line.letters == "CD" ? &glass_->coefficients : line.letters == "LD" ? &glass_->range : line.letters == "GC" ? &glass_->comment : nullptr;
    if (!place) return;
    if (place->number == 0)
      *place = std::move(line.rest);
    else if (place->repeated == 0)
      place->repeated = line.rest.number;
  }

  // What follows a name that is repeated belongs to no glass.
  void begin_glass(AgfLine line) {
    glass_ = nullptr;
    const std::vector<Word> found = words(line);
    if (found.empty()) return;
    const std::string name(found[0].text);
    if (!catalog_.by_name.emplace(name, catalog_.glasses.size()).second) {
      if (repeated_count_++ == 0) first_repeated_ = {catalog_.file, line.number, found[0].column};
      return;
    }
    catalog_.glasses.push_back({name, std::move(line), {}, {}, {}});
    glass_ = &catalog_.glasses.back();
  }

  Findings& findings_;
  AgfCatalog catalog_;
  AgfGlass* glass_ = nullptr;
  int repeated_count_ = 0;
  Place first_repeated_;
};

class GlassReader {
 public:
  GlassReader(const AgfCatalog& catalog, const AgfGlass& glass, Findings& findings)
      : catalog_(catalog), glass_(glass), findings_(findings), errors_before_(findings.error_count()) {}

  std::optional<Material> read() {
    const int number = read_formula_number();
    const Coefficients c = read_coefficients();
    const std::array<double, 2> range = read_range();
    refuse_second(glass_.coefficients, "coefficients");
    refuse_second(glass_.range, "range");
    if (findings_.error_count() > errors_before_) return std::nullopt;
    const AgfFormula& formula = formulas[number - 1];
    const medium::Formula& same = *medium::find_formula(formula.number);
    Material material{medium::from_formula(glass_.name, same, formula.coefficients(c), range[0], range[1]), place(glass_.formula),
                      fmt::format("{}, AGF formula {}, {}", std::filesystem::path(catalog_.file).filename().string(), number, formula.name), trimmed(glass_.comment.text)};
    if (!catalog_.comment.empty()) material.references += "; " + catalog_.comment;
    if (const std::optional<double> bad_um = medium::wavelength_without_index(material)) {
      error(glass_.coefficients, fmt::format("formula {} ({}) gives no index from {} to {} at {:.6g} um, inside its range", number, formula.name, medium::least_index,
                                             medium::largest_index, *bad_um),
            "check CD, LD and the number of the formula in NM");
      return std::nullopt;
    }
    return material;
  }

 private:
  Place place(const AgfLine& line) const { return {catalog_.file, line.number, 1}; }
  void error(const AgfLine& line, std::string what, std::string hint = {}) {
    findings_.error(place(line), fmt::format("glass '{}': {}", excerpt(glass_.name), what), std::move(hint));
  }

  void refuse_second(const AgfLine& line, const char* what) {
    if (line.repeated > 0)
      findings_.error({catalog_.file, line.repeated, 1}, fmt::format("glass '{}': a second line of {}", excerpt(glass_.name), what), fmt::format("the first is line {}: one of them must go", line.number));
  }

  std::optional<double> number_of(const Word& word, const AgfLine& line) {
    const ParsedNumber number = parse_number(word.text);
    if (number.ok && std::isfinite(number.value)) return number.value;
    findings_.error({catalog_.file, line.number, word.column}, fmt::format("glass '{}': '{}' is not a finite number", excerpt(glass_.name), excerpt(std::string(word.text))));
    return std::nullopt;
  }

  int read_formula_number() {
    constexpr int count = static_cast<int>(std::size(formulas));
    const std::vector<Word> found = words(glass_.formula);
    if (found.size() < 2) {
      error(glass_.formula, "no number of a dispersion formula", fmt::format("NM NAME FORMULA ..., 1 to {}", count));
      return 0;
    }
    const std::optional<double> number = number_of(found[1], glass_.formula);
    if (number && !(*number >= 1 && *number <= count && *number == std::trunc(*number)))
      findings_.error({catalog_.file, glass_.formula.number, found[1].column},
                      fmt::format("glass '{}': unknown dispersion formula '{}'", excerpt(glass_.name), excerpt(std::string(found[1].text))),
                      fmt::format("formulas are numbered 1 to {}", count));
    return static_cast<int>(std::clamp(number.value_or(0), 0.0, double(count)));
  }

  Coefficients read_coefficients() {
    Coefficients c{};
    if (glass_.coefficients.number == 0) {
      error(glass_.formula, "no coefficients", "a line `CD c1 c2 ...` gives them");
      return c;
    }
    const std::vector<Word> found = words(glass_.coefficients);
    for (std::size_t i = 0; i < std::min(found.size(), c.size()); ++i) {
      const std::optional<double> number = number_of(found[i], glass_.coefficients);
      if (!number) return c;
      c[i] = *number;
    }
    if (std::all_of(c.begin(), c.end(), [](double one) { return one == 0; })) error(glass_.coefficients, "all coefficients are zero");
    return c;
  }

  std::array<double, 2> read_range() {
    const std::vector<Word> found = words(glass_.range);
    std::array<double, 2> range{};
    if (found.size() < 2) {
      error(glass_.range.number > 0 ? glass_.range : glass_.formula, "no range", "a line `LD MIN MAX` gives it, in um");
      return range;
    }
    for (std::size_t i = 0; i < 2; ++i) {
      const std::optional<double> number = number_of(found[i], glass_.range);
      if (!number) return range;
      range[i] = *number;
    }
    if (!(range[0] >= medium::least_wavelength_um && range[0] <= range[1] && range[1] <= medium::largest_wavelength_um))
      error(glass_.range, fmt::format("the range {} to {} is not two wavelengths in um, {} <= shortest <= longest <= {}", range[0], range[1], medium::least_wavelength_um,
                                      medium::largest_wavelength_um),
            range[0] > range[1] ? "swap them" : "");
    return range;
  }

  const AgfCatalog& catalog_;
  const AgfGlass& glass_;
  Findings& findings_;
  int errors_before_;
};

}  // namespace

const AgfGlass* AgfCatalog::find(const std::string& name) const {
  const auto found = by_name.find(name);
  return found == by_name.end() ? nullptr : &glasses[found->second];
}

std::optional<AgfCatalog> read_agf(const std::string& file, Findings& findings) {
  const std::optional<std::string> text = read_text_file(file, most_agf_bytes, "split the catalogue", findings);
  return text ? CatalogFile(file, findings).read(*text) : std::nullopt;
}

std::optional<Material> read_glass(const AgfCatalog& catalog, const AgfGlass& glass, Findings& findings) { return GlassReader(catalog, glass, findings).read(); }

}  // namespace sagitta::prescription
