// SPDX-License-Identifier: Apache-2.0
#include "lib/prescription/index_pattern.h"

#include <fmt/format.h>

namespace sagitta::prescription {
namespace {

std::string digit_between(char low, char high) { return low == high ? std::string(1, low) : fmt::format("[{}-{}]", low, high); }

void add(std::string& alternatives, const std::string& one) { alternatives += (alternatives.empty() ? "" : "|") + one; }

// From `low` to `high`, which have as many digits: by the first digit, of which only the least and the greatest may bound those behind it.
std::string numbers_between(const std::string& low, const std::string& high) {
  if (low.size() == 1) return digit_between(low[0], high[0]);
  const std::string low_rest = low.substr(1), high_rest = high.substr(1), zeros(low_rest.size(), '0'), nines(low_rest.size(), '9');
  if (low[0] == high[0]) return fmt::format("{}({})", low[0], numbers_between(low_rest, high_rest));
  const bool cuts_low = low_rest != zeros, cuts_high = high_rest != nines;
  const char from = static_cast<char>(low[0] + cuts_low), to = static_cast<char>(high[0] - cuts_high);
  std::string all;
  if (cuts_low) add(all, fmt::format("{}({})", low[0], numbers_between(low_rest, nines)));
  if (from <= to) add(all, fmt::format("{}[0-9]{{{}}}", digit_between(from, to), low_rest.size()));
  if (cuts_high) add(all, fmt::format("{}({})", high[0], numbers_between(zeros, high_rest)));
  return all;
}

}  // namespace

std::string index_pattern(numerics::IndexRange range) {
  std::string all;
  const std::string last = std::to_string(range.last);
  for (std::string low = std::to_string(range.first); low.size() <= last.size(); low = "1" + std::string(low.size(), '0'))
    add(all, numbers_between(low, low.size() == last.size() ? last : std::string(low.size(), '9')));
  const char* parity = range.step == 1 ? "" : range.first % 2 == 0 ? "(?=[0-9]*[02468]$)" : "(?=[0-9]*[13579]$)";
  return fmt::format("^{}0*({})$", parity, all);
}

}  // namespace sagitta::prescription
