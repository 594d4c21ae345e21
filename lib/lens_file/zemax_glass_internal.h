// SPDX-License-Identifier: Apache-2.0
// What GLAS of a Zemax file says.
#pragma once

#include <optional>

#include "lib/lens_file/lens.h"
#include "lib/lens_file/lens_text_internal.h"

namespace sagitta::lens_file {

// GLAS name, code (0: fixed, 1: a model, 2: picked up, 3: to be substituted, 4: offset), pickup, nd, Vd, dPgF, ... None, after saying so, where it is broken.
std::optional<Medium> zemax_glass(const Statement& statement, const Numbers& numbers, Report& report);

}  // namespace sagitta::lens_file
