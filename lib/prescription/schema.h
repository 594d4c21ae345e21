// SPDX-License-Identifier: Apache-2.0
// The JSON Schema (draft 7, http://json-schema.org/draft-07/schema) of a prescription, for editors that complete and check YAML
// while it is typed. It is made from the tables of keys that the reader uses (keys.h, and those of the shapes), so the one knows
// a key exactly when the other does.
//
// What it says: keys, kinds of values, ranges, choices, one shape a surface, one of the alternatives where one is wanted, what
// must be there. What only the reader says: files and media that are missing, a thickness on all but the last surface, and what
// holds between values. A number may be arithmetic: a text that begins with '='. `.inf` is the number of that name where it is legal.
#pragma once

#include <string>

namespace sagitta::prescription {

std::string json_schema();

}  // namespace sagitta::prescription
