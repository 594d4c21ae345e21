// SPDX-License-Identifier: Apache-2.0
// UTF-8 as Unicode 15.0, table 3-7, defines it: no overlong forms, no surrogates, nothing beyond U+10FFFF.
#pragma once

#include <cstddef>
#include <string_view>

namespace sagitta::prescription {

// The number of bytes of the character at the start of `text`, 1 to 4; 0 where its bytes are not UTF-8.
std::size_t utf8_length(std::string_view text);

// True for the C0 controls (tab and line ends among them) and DEL, and for the C1 controls, U+0080 to U+009F, which
// terminals may obey.
bool starts_with_control(std::string_view text);

}  // namespace sagitta::prescription
