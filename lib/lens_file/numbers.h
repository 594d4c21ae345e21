// SPDX-License-Identifier: Apache-2.0
// Numbers of lens files: how they are read, and how a prescription writes what is computed from them, so that a person could have written it.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "lib/lens_file/lens.h"

namespace sagitta::lens_file {

// What may be meant by a number of a file: 0, or a size of at most this. Sizes below `smallest_number` are 0, also when units are converted: the reader of
// prescriptions takes none.
inline constexpr Real largest_number = 1e30L, smallest_number = 1e-100L;

// A decimal number, whole: 1.5, -3E-4, +2, .5; finite and at most largest_number. None: it is no such number. Independent of the locale.
std::optional<Real> parse_real(std::string_view text);

// Half a unit of the last digit of such a number: what may lie between it and what was meant. 0.0152 gives 0.00005.
Real half_a_digit(std::string_view text);

// The shortest decimal number within `error` of a value, 0 if that is; where none of 17 digits is, the double nearest to it.
double shortest_within(Real value, Real error);

// Of the radii whose inverse is, in double precision, the curvature given (in 1/mm), the one of the fewest digits. Infinite for 0. Where no double has that
// inverse, the one nearest to 1/c. A curvature that was written with ten digits or more, so that `rounding` is half a unit of its last one, may also be the rounded
// inverse of a radius: then within `rounding`. One of fewer digits is what was meant.
double radius_of(Real curvature, Real rounding = 0);

// The shortest text that reads back as the same double; ".inf" and "-.inf" as YAML has them; "0" for -0.
std::string number_text(double value);

// A number of a lens as the prescription has it.
double kept(Real value);

// `unit` mm to a power, by repeated multiplication and one division.
Real power(Real unit, int exponent);

}  // namespace sagitta::lens_file
