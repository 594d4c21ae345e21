// SPDX-License-Identifier: Apache-2.0
// Arithmetic in a prescription: what stands behind the '=' of a value, `= 12.0 - 0.4 * accommodation_D`.
//
//   sum      = product {("+" | "-") product}
//   product  = signed {("*" | "/") signed}
//   signed   = ("+" | "-") signed | power
//   power    = operand ["^" signed]                      -2^2 = -4, 2^3^2 = 512, 2^-1 = 0.5
//   operand  = number | parameter | function "(" sum {"," sum} ")" | "(" sum ")"
//
// A number is 12, .5 or 9e-5. The functions are abs, exp, ln (natural), sqrt; sin_deg, cos_deg, tan_deg of an angle in
// degrees; min, max of one argument or more. Evaluated in double, from left to right, every step must give a finite
// number: 1/0, ln(0), (-8)^0.5 and exp(1000) are faults. At most 1000 bytes, nested 50 deep.
#pragma once

#include <cstddef>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace sagitta::prescription {

// A parameter of a system with its value.
struct ParameterValue {
  std::string name;
  double value = 0;
};

struct ExpressionFault {
  std::size_t at = 0;  // the byte of the text, from 0
  std::string what, hint;
};

struct Evaluation {
  double value = 0;  // where there is no fault
  std::optional<ExpressionFault> fault;
  std::set<std::string> used;  // the parameters that it names, up to a fault
};

// `text` begins with '='. Names that are unknown are looked for among the parameters, for a hint, if `look_for_hints`.
Evaluation evaluate(std::string_view text, const std::vector<ParameterValue>& parameters, bool look_for_hints = true);

// What to do where an expression ends before its ')'.
inline constexpr const char* hint_of_open_parenthesis = "quote the expression: in a line of [ ] or { } one with a comma needs quotes";

std::vector<std::string> function_names();

// A letter, then letters, digits and _, 64 at most; no function's name.
bool is_parameter_name(std::string_view name);

}  // namespace sagitta::prescription
