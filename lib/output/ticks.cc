// SPDX-License-Identifier: Apache-2.0
#include "lib/output/ticks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace sagitta::output {
namespace {

// m 10^e as the double nearest to it: up to 1e22 powers of ten are exact, and one division or product rounds once.
double decimal(double m, int e) { return e < 0 ? m / std::pow(10.0, -e) : m * std::pow(10.0, e); }

}  // namespace

Ticks linear_ticks(double low, double high, int most, double smallest_step) {
  if (!(low < high) || !std::isfinite(high - low) || most < 2) return {};
  const int first = static_cast<int>(std::floor(std::log10((high - low) / most))) - 1;
  // An end that lies on a tick but for rounding still carries it.
  const double slack = 1e-9 * (high - low);
  for (int e = first;; ++e) {
    for (const double m : {1.0, 2.0, 5.0}) {
      const double step = decimal(m, e);
      if (step < smallest_step) continue;
      const double from = std::ceil((low - slack) / step), to = std::floor((high + slack) / step);
      if (to - from + 1 > most) continue;
      Ticks ticks{{}, std::max(0, -e)};
      for (double k = from; k <= to; ++k) ticks.values.push_back(k == 0 ? 0 : decimal(k * m, e));
      return ticks;
    }
  }
}

Ticks log_ticks(double low, double high, int most) {
  if (!(low > 0) || !(low < high) || !std::isfinite(high)) return {};
  const double slack = 1e-9;
  const int from = static_cast<int>(std::floor(std::log10(low)));
  const int to = static_cast<int>(std::ceil(std::log10(high)));
  const auto collect = [&](std::initializer_list<double> multiples, int stride) {
    Ticks ticks;
    for (int e = from; e <= to; ++e)
      for (const double m : multiples) {
        const double value = decimal(m, e);
        if (e % stride != 0 || value < low * (1 - slack) || value > high * (1 + slack)) continue;
        ticks.values.push_back(value);
        ticks.decimals = std::max(ticks.decimals, -e);
      }
    return ticks;
  };
  for (int stride = 1;; ++stride) {
    const Ticks decades = collect({1}, stride);
    if (static_cast<int>(decades.values.size()) > most) continue;
    if (decades.values.size() >= 2) return decades;
    const Ticks finer = collect({1, 2, 5}, 1);
    return finer.values.size() >= 2 ? finer : linear_ticks(low, high, most);
  }
}

std::string tick_label(double value, int decimals) {
  const std::string digits = fmt::format("{:.{}f}", std::abs(value), decimals);
  const bool is_zero = digits.find_first_not_of("0.") == std::string::npos;
  return value < 0 && !is_zero ? "−" + digits : digits;
}

LengthUnit length_unit(double extent_mm) {
  if (extent_mm >= 0.4) return {1, "mm"};
  if (extent_mm >= 4e-4) return {1e3, "µm"};
  return {1e6, "nm"};
}

Magnitude magnitude(double largest) {
  if (!(largest > 0) || !std::isfinite(largest) || (largest >= 0.01 && largest < 1e5)) return {};
  static constexpr const char* superscripts[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  const int exponent = static_cast<int>(std::floor(std::log10(largest)));
  std::string label = exponent < 0 ? "×10⁻" : "×10";
  for (const char digit : fmt::format("{}", std::abs(exponent))) label += superscripts[digit - '0'];
  return {std::pow(10.0, exponent), label + " "};
}

}  // namespace sagitta::output
