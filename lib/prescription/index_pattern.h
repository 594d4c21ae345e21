// SPDX-License-Identifier: Apache-2.0
// The whole numbers of a range as a regular expression (ECMA 262), for the JSON Schema, which knows no other way to say which keys a mapping may have.
#pragma once

#include <string>

#include "lib/numerics/key.h"

namespace sagitta::prescription {

// Matches, anchored, the decimal digits of the numbers first, first + step, ..., last (not negative; step 1 or 2), with zeros before them or without.
std::string index_pattern(numerics::IndexRange range);

}  // namespace sagitta::prescription
