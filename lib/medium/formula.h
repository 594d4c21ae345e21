// SPDX-License-Identifier: Apache-2.0
// What one dispersion formula consists of. Each formula has a header of its own, which defines one constant of this
// type; formulas.cc lists them.
// Source of those with a number: M. N. Polyanskiy, "Dispersion formulas", document of the refractiveindex.info database (CC0).
// It numbers coefficients from C1 and takes those that a file leaves out at the end as zero; L is the wavelength in um.
// Those that the database does not have are known by their names, so that no later number of its own means another formula.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

namespace sagitta::medium {

struct Formula {
  int number = 0;                                 // of refractiveindex.info; 0: not one of its formulas
  std::string_view name;
  std::string_view counts;                        // the legal numbers of coefficients, for messages: "1, 3, 5, ..."
  bool (*accepts)(std::size_t coefficient_count) = nullptr;
  // n from a legal number of coefficients; NaN, infinite or not positive where the formula has no physical value.
  double (*index)(std::span<const double> coefficients, double wavelength_um) = nullptr;
};

// Formulas of a constant and a sum of two-coefficient terms.
inline constexpr std::string_view constant_and_pairs_text = "1, 3, 5, ...";
inline constexpr bool constant_and_pairs(std::size_t coefficient_count) { return coefficient_count % 2 == 1; }

}  // namespace sagitta::medium
