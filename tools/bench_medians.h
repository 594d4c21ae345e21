// SPDX-License-Identifier: Apache-2.0
// The figures that the benchmarks' tables are made of.
#pragma once

#include <fmt/core.h>

#include <cmath>
#include <limits>
#include <map>
#include <string>

namespace sagitta::bench {

// Benchmark -> counter -> median over its repetitions.
using Medians = std::map<std::string, std::map<std::string, double>>;

// NaN where it has not run.
inline double median(const Medians& medians, const std::string& benchmark, const std::string& counter) {
  const auto found = medians.find(benchmark);
  if (found == medians.end() || !found->second.contains(counter)) return std::numeric_limits<double>::quiet_NaN();
  return found->second.at(counter);
}

// "-" for what has not run.
inline std::string decimal(double value, int digits) { return std::isnan(value) ? "-" : fmt::format("{:.{}f}", value, digits); }

}  // namespace sagitta::bench
