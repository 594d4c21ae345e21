// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>
#include <string_view>

namespace sagitta::numerics {

// The instructions that kernels use: the best of the machine's, or at most $SAGITTA_ISA (x86-64, x86-64-v3, x86-64-v4). The
// results have the same bits with each; chosen at the first call.
enum class InstructionSet { any, x86_64_v3, x86_64_v4 };

inline InstructionSet instruction_set() {
  static const InstructionSet chosen = [] {
#if defined(__x86_64__)
    const char* wanted = std::getenv("SAGITTA_ISA");
    const std::string_view most = wanted ? wanted : "x86-64-v4";
    if (most == "x86-64-v4" && __builtin_cpu_supports("x86-64-v4")) return InstructionSet::x86_64_v4;
    if (most != "x86-64" && __builtin_cpu_supports("x86-64-v3")) return InstructionSet::x86_64_v3;
#endif
    return InstructionSet::any;
  }();
  return chosen;
}

}  // namespace sagitta::numerics
