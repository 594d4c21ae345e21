// SPDX-License-Identifier: Apache-2.0
// Somebody's text made safe to show: names come from users' files and may hold anything.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace sagitta::output {

// The text as UTF-8 code points, one string each. Control characters (line ends and terminal escapes too) become
// blanks; bytes that are not UTF-8 (RFC 3629: no overlong form, no surrogate, none above U+10FFFF) become U+FFFD, and so do the
// code points that Unicode keeps free of characters (U+FDD0 to U+FDEF, the last two of each plane), which Cairo and XML refuse.
std::vector<std::string> characters(std::string_view text);

// The same in one piece, "…" in place of what goes beyond `most` characters.
std::string printable(std::string_view text, std::size_t most);

// A number with so many significant digits, decimal where that is readable, "-" where there is none (NaN). 0.5 with
// three digits is "0.500". Free of the locale.
std::string significant(double value, int digits);

}  // namespace sagitta::output
