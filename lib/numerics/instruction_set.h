// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdlib>
#include <string_view>

// Under sanitizers there is but one set, and nothing is drawn in, which it does not need: the compiler takes half an hour over a
// function into which thousands of checks are drawn.
#if defined(__x86_64__) && !defined(__SANITIZE_ADDRESS__)
#define SAGITTA_CHOOSES_INSTRUCTIONS
#endif

namespace sagitta::numerics {

// The instructions that kernels use: the best of the machine's, or at most $SAGITTA_ISA, one of the names below (another name is no
// limit). The results have the same bits with each; chosen at the first call.
enum class InstructionSet { any, x86_64_v3, x86_64_v4 };
inline constexpr std::array<std::string_view, 3> instruction_set_names{"x86-64", "x86-64-v3", "x86-64-v4"};

inline InstructionSet instruction_set() {
  static const InstructionSet chosen = [] {
#if defined(SAGITTA_CHOOSES_INSTRUCTIONS)
    const char* wanted = std::getenv("SAGITTA_ISA");
    const std::string_view most = wanted ? wanted : "";
    if (most != instruction_set_names[0] && most != instruction_set_names[1] && __builtin_cpu_supports("x86-64-v4")) return InstructionSet::x86_64_v4;
    if (most != instruction_set_names[0] && __builtin_cpu_supports("x86-64-v3")) return InstructionSet::x86_64_v3;
#endif
    return InstructionSet::any;
  }();
  return chosen;
}

// Calls work.operator()<n>() in a function made for these instructions, with n the doubles that their vectors hold: 2, 4 or
// 8. Only what is drawn into that function becomes such instructions; the rest is code for any machine. The compiler decides
// what that is; `flat` draws in everything, as numerics/lanes.h needs it.
namespace chosen_instructions {
template <class Work>
[[gnu::noinline]] void run_for_any(const Work& work) {
  work.template operator()<2>();
}
template <class Work>
[[gnu::noinline, gnu::flatten]] void run_flat_for_any(const Work& work) {
  work.template operator()<2>();
}
#if defined(SAGITTA_CHOOSES_INSTRUCTIONS)
template <class Work>
[[gnu::noinline, gnu::target("arch=x86-64-v3")]] void run_for_v3(const Work& work) {
  work.template operator()<4>();
}
template <class Work>
[[gnu::noinline, gnu::flatten, gnu::target("arch=x86-64-v3")]] void run_flat_for_v3(const Work& work) {
  work.template operator()<4>();
}
template <class Work>
[[gnu::noinline, gnu::target("arch=x86-64-v4")]] void run_for_v4(const Work& work) {
  work.template operator()<8>();
}
template <class Work>
[[gnu::noinline, gnu::flatten, gnu::target("arch=x86-64-v4")]] void run_flat_for_v4(const Work& work) {
  work.template operator()<8>();
}
#endif
}  // namespace chosen_instructions

template <class Work>
void with_chosen_instructions(const Work& work) {
#if defined(SAGITTA_CHOOSES_INSTRUCTIONS)
  switch (instruction_set()) {
    case InstructionSet::x86_64_v4: return chosen_instructions::run_for_v4(work);
    case InstructionSet::x86_64_v3: return chosen_instructions::run_for_v3(work);
    case InstructionSet::any: break;
  }
#endif
  chosen_instructions::run_for_any(work);
}
template <class Work>
void with_chosen_instructions_flat(const Work& work) {
#if defined(SAGITTA_CHOOSES_INSTRUCTIONS)
  switch (instruction_set()) {
    case InstructionSet::x86_64_v4: return chosen_instructions::run_flat_for_v4(work);
    case InstructionSet::x86_64_v3: return chosen_instructions::run_flat_for_v3(work);
    case InstructionSet::any: return chosen_instructions::run_flat_for_any(work);
  }
#else
  chosen_instructions::run_for_any(work);
#endif
}

}  // namespace sagitta::numerics
