// SPDX-License-Identifier: Apache-2.0
// What this build of the program is.
#pragma once

#include <string>

namespace sagitta::tools {

// Such as "0.1.0".
const char* version();

// Such as "Release, GNU 12.2.0".
const char* build();

// What `sagitta --version` prints: the version, then what this build was made with and by, what it leaves out, the licence of
// the whole, and the instruction set that this machine gets.
std::string about_this_build();

}  // namespace sagitta::tools
