// SPDX-License-Identifier: Apache-2.0
#include "lib/output/ticks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace sagitta::output {
namespace {

// m 10^e as the double nearest to it: up to 1e22 powers of ten are exact, and one division or product rounds once.
double decimal(double m, int e) { return e < 0 ? m / std::pow(10.0, -e) : m * std::pow(10.0, e); }

std::string fixed(double value, int decimals) {
  return (value < 0 ? "−" : "") + fmt::format("{:.{}f}", std::abs(value), decimals);
}

std::string power_of_ten(int exponent) {
  static constexpr const char* superscripts[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string label = exponent < 0 ? "10⁻" : "10";
  for (const char digit : fmt::format("{}", std::abs(exponent))) label += superscripts[digit - '0'];
  return label;
}

// m 10^e on a logarithmic axis.
std::string log_label(int m, int e) {
  if (e >= -3 && e < 5) return fixed(decimal(m, e), std::max(0, -e));
  return (m == 1 ? "" : fmt::format("{}×", m)) + power_of_ten(e);
}

}  // namespace

Ticks linear_ticks(double low, double high, int most, double smallest_step) {
  if (!(high - low > 1e-290) || !std::isfinite(high - low) || most < 2) return {};
  const int first = static_cast<int>(std::floor(std::log10((high - low) / most))) - 1;
  // An end that lies on a tick but for rounding still carries it.
  const double slack = 1e-9 * (high - low);
  for (int e = first;; ++e) {
    for (const double m : {1.0, 2.0, 5.0}) {
      const double step = decimal(m, e);
      if (step < smallest_step) continue;
      const double from = std::ceil((low - slack) / step), to = std::floor((high + slack) / step);
      if (to - from + 1 > most) continue;
      Ticks ticks;
      for (int i = 0; i <= to - from; ++i) {
        const double k = from + i;
        ticks.values.push_back(k == 0 ? 0 : decimal(k * m, e));  // no negative zero
        ticks.labels.push_back(fixed(ticks.values.back(), std::max(0, -e)));
      }
      return ticks;
    }
  }
}

Ticks log_ticks(double low, double high, int most) {
  if (!(low > 0) || !(low < high) || !std::isfinite(high)) return {};
  const double slack = 1e-9;
  const int from = static_cast<int>(std::floor(std::log10(low)));
  const int to = static_cast<int>(std::ceil(std::log10(high)));
  const auto collect = [&](std::initializer_list<int> multiples, int stride) {
    Ticks ticks;
    for (int e = from; e <= to; ++e)
      for (const int m : multiples) {
        const double value = decimal(m, e);
        if (e % stride != 0 || value < low * (1 - slack) || value > high * (1 + slack)) continue;
        ticks.values.push_back(value);
        ticks.labels.push_back(log_label(m, e));
      }
    return ticks;
  };
  const auto fits = [&](const Ticks& ticks) { return static_cast<int>(ticks.values.size()) <= most; };
  Ticks ticks = collect({1, 2, 5}, 1);
  if (ticks.values.size() < 2) return linear_ticks(low, high, most);
  for (int stride = 1; !fits(ticks); ++stride) ticks = collect({1}, stride);
  return ticks;
}

LengthUnit length_unit(double extent_mm) {
  if (extent_mm >= 0.4) return {1, "mm"};
  if (extent_mm >= 4e-4) return {1e3, "µm"};
  return {1e6, "nm"};
}

Magnitude magnitude(double largest) {
  if (!(largest > 0) || !std::isfinite(largest) || (largest >= 0.01 && largest < 1e5)) return {};
  const int exponent = static_cast<int>(std::floor(std::log10(largest)));
  return {std::pow(10.0, exponent), "×" + power_of_ten(exponent) + " "};
}

}  // namespace sagitta::output
