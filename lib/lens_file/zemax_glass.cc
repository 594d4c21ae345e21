// SPDX-License-Identifier: Apache-2.0
#include "lib/lens_file/zemax_glass_internal.h"

#include <fmt/format.h>

#include "lib/lens_file/numbers.h"
#include "lib/prescription/keys.h"

namespace sagitta::lens_file {
namespace {

Stated stated(const Word& word) {
  const std::optional<Real> value = parse_real(word.text);
  return value ? Stated{static_cast<double>(*value), static_cast<double>(half_a_digit(word.text))} : Stated{};
}

std::optional<Medium> model_glass(const Statement& statement, const Numbers& numbers, Report& report) {
  const Place at = numbers.place(statement);
  const std::optional<Real> nd = numbers.number(statement, 4), vd = statement.words.size() > 5 ? numbers.number(statement, 5) : Real(0);
  if (!nd || !vd) return std::nullopt;
  const double index = static_cast<double>(*nd), abbe = static_cast<double>(*vd);
  if (!(prescription::index_range.contains(index) && abbe >= 0)) {
    report.broken(at, fmt::format("GLAS: a model glass of nd {} and Vd {}", number_text(index), number_text(abbe)));
    return std::nullopt;
  }
  if (statement.words.size() > 6 && numbers.number(statement, 6).value_or(0) != 0)
    report.left_out(numbers.place(statement.words[6]), "GLAS: dPgF, the partial dispersion of a model glass", "give its index as a table or a formula in a file NAME.yml, and NAME here");
  return Medium{abbe == 0 ? Medium::Kind::index : Medium::Kind::nd_vd, {}, index, abbe, {}, at};
}

}  // namespace

std::optional<Medium> zemax_glass(const Statement& statement, const Numbers& numbers, Report& report) {
  const Place at = numbers.place(statement);
  if (statement.words.size() < 2) {
    report.broken(at, "GLAS: the name of the glass is missing");
    return std::nullopt;
  }
  const std::string& name = statement.words[1].text;
  if (name == "MIRROR") return Medium{Medium::Kind::mirror, {}, 1, 0, {}, at};
  const int code = statement.words.size() > 2 ? numbers.whole(statement, 2, 0, 99).value_or(0) : 0;
  if (code == 3) report.warning(numbers.place(statement.words[2]), "GLAS: a glass that optimisation may substitute is taken as the one that is named");
  if (code > 3)
    report.left_out(numbers.place(statement.words[2]), (code == 4 ? "GLAS: an offset from the index of a glass" : fmt::format("GLAS: what solve {} is, is not known", code)) + "; the glass that is named stands for it");
  if (name == "___BLANK" || code == 1) return model_glass(statement, numbers, report);
  Medium glass{Medium::Kind::glass, name, 1, 0, {}, at};
  if (code == 4 || statement.words.size() < 6) return glass;
  const Stated nd = stated(statement.words[4]), vd = stated(statement.words[5]);
  const bool is_placeholder = nd.value <= 1 || (nd.value == 1.5 && vd.value == 40);
  if (!is_placeholder) glass.stated_nd = nd, glass.stated_vd = vd;
  return glass;
}

}  // namespace sagitta::lens_file
