// SPDX-License-Identifier: Apache-2.0
#include "lib/lens_file/numbers.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>

namespace sagitta::lens_file {
namespace {

constexpr int most_digits = 17;  // that tell any double from the others
constexpr Real half_of_the_tenth_digit = 5e-10L;

Real real_of(const std::string& decimal) {
  Real value = 0;
  std::from_chars(decimal.data(), decimal.data() + decimal.size(), value);
  return value;
}

}  // namespace

std::optional<Real> parse_real(std::string_view text) {
  const bool has_sign = text.starts_with('+') || text.starts_with('-');
  const std::string_view digits = text.substr(has_sign ? 1 : 0);
  if (digits.empty() || (digits.front() != '.' && (digits.front() < '0' || digits.front() > '9'))) return std::nullopt;
  if (text.front() == '+') text = digits;
  Real value = 0;
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (end != text.data() + text.size()) return std::nullopt;
  if (fault == std::errc::result_out_of_range && (text.find("e-") != std::string_view::npos || text.find("E-") != std::string_view::npos)) return 0;
  if (fault != std::errc{} || !(std::abs(value) <= largest_number)) return std::nullopt;
  return std::abs(value) < smallest_number ? 0 : value;
}

Real half_a_digit(std::string_view text) {
  const std::size_t end = std::min(text.find_first_of("eE"), text.size()), point = text.substr(0, end).find('.');
  const Real mantissa = real_of(fmt::format("5e{}", -1 - static_cast<int>(point == std::string_view::npos ? 0 : end - point - 1)));
  return end == text.size() ? mantissa : mantissa * real_of("1" + std::string(text.substr(end)));
}

double kept(Real value) { return std::abs(value) < smallest_number ? 0 : static_cast<double>(value); }

double shortest_within(Real value, Real error) {
  if (std::abs(value) <= error || std::abs(value) < smallest_number) return 0;
  for (int digits = 1; digits <= most_digits; ++digits) {
    const Real decimal = real_of(fmt::format("{:.{}e}", value, digits - 1));
    if (std::abs(decimal - value) <= error) return static_cast<double>(decimal);
  }
  return static_cast<double>(value);
}

double radius_of(Real curvature, Real rounding) {
  const double c = static_cast<double>(curvature);
  if (c == 0) return std::numeric_limits<double>::infinity();
  const Real radius = 1 / curvature;
  for (int digits = 1; digits <= most_digits; ++digits) {
    const double decimal = static_cast<double>(real_of(fmt::format("{:.{}e}", radius, digits - 1)));
    if (1 / decimal == c || (rounding <= half_of_the_tenth_digit * std::abs(curvature) && std::abs(1 / Real(decimal) - curvature) <= rounding)) return decimal;
  }
  return static_cast<double>(radius);
}

std::string number_text(double value) {
  if (std::isinf(value)) return value > 0 ? ".inf" : "-.inf";
  return value == 0 ? "0" : fmt::format("{}", value);
}

Real power(Real unit, int exponent) {
  Real result = 1;
  for (int i = 0; i < std::abs(exponent); ++i) result *= unit;
  return exponent < 0 ? 1 / result : result;
}

}  // namespace sagitta::lens_file
