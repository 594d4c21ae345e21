// SPDX-License-Identifier: Apache-2.0
// The closed list of dispersion formulas, and media made of them.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lib/medium/formula.h"
#include "lib/medium/medium.h"

namespace sagitta::medium {

std::span<const Formula> formulas();

// By number, 1 to 9; by what stands behind "formula" in a file: the number, or the name of one that has none. Null where there is none.
const Formula* find_formula(int number);
const Formula* find_formula(std::string_view number_or_name);

// "formula 2 (Sellmeier-2)"; "formula Cornu".
std::string title_of(const Formula& formula);

// `coefficients` are as many as the formula accepts.
Medium from_formula(std::string name, const Formula& formula, std::vector<double> coefficients, double shortest_um,
                    double longest_um);

}  // namespace sagitta::medium
