// SPDX-License-Identifier: Apache-2.0
// Writes a lens as a prescription (YAML, version 1), as a person would: a head comment with the source and what was done, a surface a line where it fits,
// numbers with the fewest digits that are the same double.
#pragma once

#include <string>
#include <vector>

#include "lib/lens_file/lens.h"
#include "lib/lens_file/report.h"

namespace sagitta::lens_file {

// `file`: the lens file, named in the head comment. `catalogs`: as the prescription is to name them. All glasses have been found.
std::string prescription_text(const Lens& lens, const std::string& file, const std::vector<std::string>& catalogs, const Report& report);

// A text as a YAML scalar in braces: plain where that is the same text, else in double quotes. Control characters and what is no text become '?'; at most
// 200 bytes.
std::string yaml_text(const std::string& text);

}  // namespace sagitta::lens_file
