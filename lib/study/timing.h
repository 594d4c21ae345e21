// SPDX-License-Identifier: Apache-2.0
// How long work takes: processor time, which other work on the machine disturbs less, and the clock's; and how often it is repeated.
#pragma once

#include <algorithm>
#include <ctime>
#include <limits>
#include <vector>

namespace sagitta::study {

// In seconds. Of the processor: of this thread, or of the whole process where the work is shared among several.
struct Times {
  double processor = 0, wall = 0;
};
inline Times operator-(const Times& a, const Times& b) { return {a.processor - b.processor, a.wall - b.wall}; }
inline Times operator+(const Times& a, const Times& b) { return {a.processor + b.processor, a.wall + b.wall}; }

enum class Clocked { this_thread, process };
inline Times times_now(Clocked clocked) {
  const auto seconds = [](clockid_t clock) {
    timespec time{};
    clock_gettime(clock, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
  };
  return {seconds(clocked == Clocked::this_thread ? CLOCK_THREAD_CPUTIME_ID : CLOCK_PROCESS_CPUTIME_ID), seconds(CLOCK_MONOTONIC)};
}

// Of repeated runs: the median, the least and the most. NaN of none.
struct Spread {
  double median = std::numeric_limits<double>::quiet_NaN();
  double least = std::numeric_limits<double>::quiet_NaN();
  double most = std::numeric_limits<double>::quiet_NaN();
  int runs = 0;
};
inline Spread spread_of(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const std::size_t count = values.size();
  return {(values[(count - 1) / 2] + values[count / 2]) / 2, values.front(), values.back(), static_cast<int>(count)};
}

// How long one run of a search among all vertices may take: it is timed on as many rays as this allows.
inline constexpr double longest_search_s = 0.25;

// How often work is run again whose first run took so long: preparation at least so many times, up to seven while that is a tenth of a second; tracing,
// after a first run that warms the caches, in three or seven runs, each of as many passes as fill 2 ms.
inline int preparation_repeats(double first_s, int at_least) { return std::max(at_least, static_cast<int>(std::clamp(0.1 / first_s, 1.0, 7.0))); }
struct TracingRepeats {
  int runs, passes;
};
inline TracingRepeats tracing_repeats(double first_s) { return {first_s < 0.5 ? 7 : 3, static_cast<int>(std::clamp(2e-3 / first_s, 1.0, 1000.0))}; }

}  // namespace sagitta::study
