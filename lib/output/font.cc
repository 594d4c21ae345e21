// SPDX-License-Identifier: Apache-2.0
// The assembler takes the file in as it is; CMake names it (SAGITTA_FONT_FILE).
#include "lib/output/font.h"

asm(R"(
  .pushsection .rodata
  .balign 16
sagitta_font_begin:
  .incbin ")" SAGITTA_FONT_FILE R"("
sagitta_font_end:
  .byte 0
  .popsection
)");

extern "C" const std::byte sagitta_font_begin[], sagitta_font_end[];

namespace sagitta::output {

std::span<const std::byte> font_file() { return {sagitta_font_begin, sagitta_font_end}; }

}  // namespace sagitta::output
