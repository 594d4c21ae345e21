// SPDX-License-Identifier: Apache-2.0
// Lines and words of a lens file with their places.
#pragma once

#include <algorithm>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "lib/lens_file/numbers.h"
#include "lib/lens_file/report.h"

namespace sagitta::lens_file {

inline constexpr std::string_view blanks = " \t\f\v";

struct Word {
  std::string text;
  int line = 0, column = 0;
  bool quoted = false;
};

// Words separated by blanks: an operand or command with what belongs to it. `rest` is the text behind the first word, without blanks at its ends.
struct Statement {
  std::vector<Word> words;
  std::string rest;
  bool indented = false;

  const std::string& name() const { return words.front().text; }
};

inline std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(blanks);
  return begin == std::string_view::npos ? std::string_view() : text.substr(begin, text.find_last_not_of(blanks) + 1 - begin);
}

// What a reader does not take: an aperture that a prescription has not, or what is not known.
struct OtherAperture {
  std::string_view name, what;
};
inline void leave_out(const std::string& given, std::string_view name, std::span<const OtherAperture> apertures, Place at, Report& report) {
  const auto found = std::find_if(apertures.begin(), apertures.end(), [&](const OtherAperture& one) { return one.name == name; });
  if (found == apertures.end()) return report.left_out(std::move(at), prescription::excerpt(given) + " is not known");
  report.left_out(std::move(at), prescription::excerpt(given) + ": " + std::string(found->what), "apertures here are circles about a surface's vertex");
}

// Asks statements for their numbers, and says where there is none.
class Numbers {
 public:
  Numbers(const std::string& file, Report& report) : file_(file), report_(report) {}

  Place place(const Word& word) const { return {file_, word.line, word.column}; }
  Place place(const Statement& statement) const { return place(statement.words.front()); }

  std::optional<Real> number(const Statement& statement, std::size_t i) const {
    if (i >= statement.words.size()) {
      report_.broken(place(statement), statement.name() + ": a number is missing", i > 1 ? "the line ends too early" : "");
      return std::nullopt;
    }
    return number(statement.words[i], statement.name());
  }
  std::optional<Real> number(const Word& word, const std::string& of) const {
    const std::optional<Real> value = parse_real(word.text);
    if (!value) report_.broken(place(word), of + ": '" + prescription::excerpt(word.text) + "' is not a number of at most 1e30");
    return value;
  }
  // A whole number from `low` to `high`.
  std::optional<int> whole(const Statement& statement, std::size_t i, int low, int high) const {
    const std::optional<Real> value = number(statement, i);
    if (!value) return std::nullopt;
    if (*value >= Real(low) && *value <= Real(high) && *value == Real(static_cast<int>(*value))) return static_cast<int>(*value);
    report_.broken(place(statement.words[i]), statement.name() + ": '" + prescription::excerpt(statement.words[i].text) + "' is not a whole number from " + std::to_string(low) + " to " + std::to_string(high));
    return std::nullopt;
  }
  // All numbers of the statement, from its word `first`.
  std::optional<std::vector<Real>> list(const Statement& statement, std::size_t first) const {
    std::vector<Real> values;
    for (std::size_t i = first; i < statement.words.size(); ++i) {
      const std::optional<Real> value = number(statement.words[i], statement.name());
      if (!value) return std::nullopt;
      values.push_back(*value);
    }
    return values;
  }

 private:
  const std::string& file_;
  Report& report_;
};

}  // namespace sagitta::lens_file
