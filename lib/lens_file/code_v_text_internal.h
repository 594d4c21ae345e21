// SPDX-License-Identifier: Apache-2.0
// The words of a CODE V sequence: statements, names of commands and surfaces, codes of glasses.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lib/lens_file/lens_text_internal.h"

namespace sagitta::lens_file {

// Statements end at `;` and at the end of a line, unless that is a `&`; a comment goes from `!` to the end of its line. A word in quotes, ' or ", is taken
// without them; quotes behind other letters (L'A') stay.
std::vector<Statement> code_v_statements(std::string_view text);

std::string upper(std::string_view text);

// What counts of a command: three letters; of S, SO, SI, S12 all.
std::string command_name(std::string_view given);

// S, SO, SI, or S and a number, in capital letters.
bool is_surface_name(std::string_view name);

// 517642 or 517.642, with as many digits before and behind the point as there are: nd = 1.517, Vd = 64.2. At least three digits are before the point.
struct GlassCode {
  double nd = 1, vd = 0;
};
std::optional<GlassCode> glass_code(std::string_view text);

}  // namespace sagitta::lens_file
