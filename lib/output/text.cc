// SPDX-License-Identifier: Apache-2.0
#include "lib/output/text.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>

namespace sagitta::output {
namespace {

constexpr std::string_view replacement = "\xEF\xBF\xBD";  // U+FFFD

// The number of bytes of the code point at the start of the text; 0 where these bytes are not UTF-8.
std::size_t code_point_length(std::string_view text) {
  const auto at = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned lead = at(0);
  const std::size_t length = lead < 0x80   ? 1
                             : lead < 0xC2 ? 0
                             : lead < 0xE0 ? 2
                             : lead < 0xF0 ? 3
                             : lead < 0xF5 ? 4
                                           : 0;
  if (length > text.size()) return 0;
  for (std::size_t i = 1; i < length; ++i)
    if ((at(i) & 0xC0U) != 0x80) return 0;
  const bool overlong = (lead == 0xE0 && at(1) < 0xA0) || (lead == 0xF0 && at(1) < 0x90);
  const bool no_character = (lead == 0xED && at(1) >= 0xA0) || (lead == 0xF4 && at(1) >= 0x90);
  return overlong || no_character ? 0 : length;
}

// U+FDD0 to U+FDEF, and those that end in FFFE and FFFF.
bool is_noncharacter(std::string_view point) {
  const auto bits = [&](std::size_t i) { return static_cast<unsigned char>(point[i]) & 0x3FU; };
  if (point.size() < 3) return false;
  const std::size_t last = point.size() - 1;
  const unsigned low = (bits(last - 2) & 0xFU) << 12U | bits(last - 1) << 6U | bits(last);  // 16 bits of it
  return (low & 0xFFFEU) == 0xFFFEU || (point.size() == 3 && low >= 0xFDD0U && low <= 0xFDEFU);
}

// C0, DEL and C1.
bool is_control(std::string_view point) {
  const auto first = static_cast<unsigned char>(point[0]);
  return first < 0x20 || first == 0x7F || (first == 0xC2 && static_cast<unsigned char>(point[1]) < 0xA0);
}

}  // namespace

std::vector<std::string> characters(std::string_view text) {
  std::vector<std::string> result;
  while (!text.empty()) {
    const std::size_t length = code_point_length(text);
    const std::string_view point = length == 0 || is_noncharacter(text.substr(0, length)) ? replacement : text.substr(0, length);
    result.emplace_back(is_control(point) ? " " : point);
    text.remove_prefix(length == 0 ? 1 : length);
  }
  return result;
}

std::string printable(std::string_view text, std::size_t most) {
  const std::vector<std::string> all = characters(text);
  std::string result;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (i + 1 >= most && all.size() > most) return result + "…";
    result += all[i];
  }
  return result;
}

std::string significant(double value, int digits) {
  if (std::isnan(value)) return "-";
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  if (value == 0) return fmt::format("{:.{}f}", 0.0, digits - 1);
  const std::string scientific =
      fmt::format("{:.{}e}", value, digits - 1);  // its exponent is that of the rounded value
  const int exponent = std::stoi(scientific.substr(scientific.find('e') + 1));
  if (exponent < -4 || exponent > digits + 2) return scientific;
  return fmt::format("{:.{}f}", value, std::max(0, digits - 1 - exponent));
}

}  // namespace sagitta::output
