// SPDX-License-Identifier: Apache-2.0
// What stands for numbers in a CODE V sequence: names of surfaces, solves, pickups. A lens that CODE V saves has the solved numbers and those that were picked up.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lib/lens_file/code_v_surface_internal.h"
#include "lib/lens_file/lens_text_internal.h"

namespace sagitta::lens_file {

// Whether a word, in capital letters, is S3, SO, SI or S'LABEL'; and which surface that is. "S" and what is not a number: none.
bool names_surface(const std::string& word);
std::optional<std::size_t> surface_named(const std::string& word, const std::vector<CodeVSurface>& surfaces, bool has_image);

// THI HMY 0.0, CUY UMY -0.1: a condition in place of a number. The number that the surface has stands for it.
bool is_solve(const Statement& statement);
void take_solve(const Statement& statement, const CodeVSurface& surface, const Numbers& numbers, Report& report);

// PIK THI S3 Z1 THI S2 Z1 -1.0 0.5: the first is -1.0 times the second, plus 0.5; the second item where it is the same, Z1, scale and offset may be missing.
// Looks whether the surfaces have such numbers.
void check_pickup(const Statement& statement, const std::vector<CodeVSurface>& surfaces, bool has_image, const Numbers& numbers, Report& report);

}  // namespace sagitta::lens_file
