// SPDX-License-Identifier: Apache-2.0
// The letters of every picture: DejaVu Sans, inside the program, so that pictures do not depend on the fonts of the
// machine that draws them.
#pragma once

#include <cstddef>
#include <span>

namespace sagitta::output {

// DejaVuSans.ttf of the Debian package fonts-dejavu-core, as it was when the program was built.
std::span<const std::byte> font_file();

}  // namespace sagitta::output
