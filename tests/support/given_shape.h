// SPDX-License-Identifier: Apache-2.0
// What a shape's from() asks of parameters, without a reader: numbers, fallbacks from the shape's table of keys, and one list of coefficients.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "lib/numerics/arena.h"

namespace sagitta::tests {

using Coefficients = std::vector<std::pair<int, double>>;

struct GivenShape {
  std::map<std::string, double, std::less<>> numbers;
  Coefficients coefficients;
  std::string indexing = "osa";

  double number(std::string_view key) const { return numbers.find(key)->second; }
  const std::string& text(std::string_view) const { return indexing; }
  const Coefficients& list(std::string_view) const { return coefficients; }
};

template <class Shape>
Shape made(GivenShape given, numerics::Arena& arena) {
  for (const auto& key : Shape::keys) given.numbers.try_emplace(std::string(key.name), key.fallback);
  return Shape::from(given, arena);
}

}  // namespace sagitta::tests
