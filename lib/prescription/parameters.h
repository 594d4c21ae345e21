// SPDX-License-Identifier: Apache-2.0
// The checked values of one shape, by key. The reader fills it from the shape's table of keys, so every number that is
// asked for is there (with its fallback) and in its legal range.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "lib/prescription/diagnostics.h"

namespace sagitta::prescription {

struct Parameters {
  std::map<std::string, double, std::less<>> numbers;
  std::map<std::string, std::string, std::less<>> texts;  // texts, choices and file names
  std::map<std::string, std::vector<std::pair<int, double>>, std::less<>> indexed;  // by rising index; duplicates refused
  std::map<std::string, Place, std::less<>> places;       // of the values that were given

  double number(std::string_view key) const { return numbers.find(key)->second; }
  const std::string& text(std::string_view key) const { return texts.find(key)->second; }
  const std::vector<std::pair<int, double>>& list(std::string_view key) const {
    static const std::vector<std::pair<int, double>> none;
    const auto found = indexed.find(key);
    return found == indexed.end() ? none : found->second;
  }
};

}  // namespace sagitta::prescription
