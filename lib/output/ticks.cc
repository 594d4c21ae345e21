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
struct LogTick {
  int m, e;
  double value() const { return decimal(m, e); }
  bool is_plain() const { return e >= -3 && e < 5; }
  std::string label(bool plain) const {
    if (plain) return fixed(value(), std::max(0, -e));
    return (m == 1 ? "" : fmt::format("{}×", m)) + power_of_ten(e);
  }
};

// Those in [low, high] whose exponents the stride divides, ascending.
std::vector<LogTick> log_ticks_of(double low, double high, const std::vector<int>& multiples, int stride) {
  const double slack = 1e-9;
  const int from = static_cast<int>(std::floor(std::log10(low)));
  const int to = static_cast<int>(std::ceil(std::log10(high)));
  std::vector<LogTick> ticks;
  for (int e = from; e <= to; ++e)
    for (const int m : multiples) {
      const LogTick tick{m, e};
      if (e % stride == 0 && tick.value() >= low * (1 - slack) && tick.value() <= high * (1 + slack)) ticks.push_back(tick);
    }
  return ticks;
}

// `label(tick)` is what is written at it.
Ticks labelled(const std::vector<LogTick>& all, const auto& label) {
  Ticks ticks;
  for (const LogTick& tick : all) {
    ticks.values.push_back(tick.value());
    ticks.labels.push_back(label(tick));
  }
  return ticks;
}

bool is_log_axis(double low, double high) { return low > 0 && low < high && std::isfinite(high); }

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
  if (!is_log_axis(low, high)) return {};
  std::vector<LogTick> ticks = log_ticks_of(low, high, {1, 2, 5}, 1);
  if (ticks.size() < 2) return linear_ticks(low, high, most);
  for (int stride = 1; static_cast<int>(ticks.size()) > most; ++stride) ticks = log_ticks_of(low, high, {1}, stride);
  return labelled(ticks, [](const LogTick& tick) { return tick.label(tick.is_plain()); });
}

ChartTicks chart_ticks(double low, double high, int most) {
  if (!is_log_axis(low, high)) return {};
  const bool is_short = std::log10(high / low) < 2.5;
  int stride = 1;
  std::vector<LogTick> major = log_ticks_of(low, high, is_short ? std::vector<int>{1, 2, 5} : std::vector<int>{1}, stride);
  while (!is_short && static_cast<int>(major.size()) > most) major = log_ticks_of(low, high, {1}, ++stride);
  const bool plain = std::all_of(major.begin(), major.end(), [](const LogTick& tick) { return tick.is_plain(); });
  ChartTicks ticks{labelled(major, [&](const LogTick& tick) { return tick.label(plain); }), {}};
  const auto minor = stride == 1 ? log_ticks_of(low, high, {2, 3, 4, 5, 6, 7, 8, 9}, 1) : log_ticks_of(low, high, {1}, 1);
  for (const LogTick& tick : minor)
    if (!std::binary_search(ticks.major.values.begin(), ticks.major.values.end(), tick.value())) ticks.minor.push_back(tick.value());
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
