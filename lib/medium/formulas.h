// SPDX-License-Identifier: Apache-2.0
// The closed list of dispersion formulas, and media made of them.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "lib/medium/formula.h"
#include "lib/medium/medium.h"

namespace sagitta::medium {

std::span<const Formula> formulas();

// Null where no formula has that number.
const Formula* find_formula(int number);

// `coefficients` are as many as the formula accepts.
Medium from_formula(std::string name, const Formula& formula, std::vector<double> coefficients, double shortest_um,
                    double longest_um);

}  // namespace sagitta::medium
