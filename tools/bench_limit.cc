// SPDX-License-Identifier: Apache-2.0
// The instructions are written out, so that they are what is measured whatever the compiler makes of a loop: 12 of them in turn
// that do not wait for one another, enough to fill the longest pipeline (multiply-adds: 4 cycles, two at a time).
#include "tools/bench_limit.h"

#include <benchmark/benchmark.h>
#include <fmt/core.h>

#include <array>
#include <string>

#include "tools/bench_clock.h"

namespace sagitta::bench {
namespace {

enum class Operation { divide, root, multiply_add };
constexpr std::array<const char*, 3> names{"divide", "square_root", "multiply_add"};
constexpr std::array<int, 3> widths{128, 256, 512};  // bits
constexpr int chain_count = 12, round_count = 20000;

#if defined(__x86_64__)
template <int bits, Operation operation>
[[gnu::always_inline]] inline void run() {
  typedef double Vector __attribute__((vector_size(bits / 8)));
  Vector operand = Vector{} + 1.7, divisor = Vector{} + 1.3, results[chain_count];  // with a quotient and a root of all digits
#pragma GCC unroll 12
  for (int i = 0; i < chain_count; ++i) results[i] = operand;
  for (int round = 0; round < round_count; ++round) {
#pragma GCC unroll 12
    for (int i = 0; i < chain_count; ++i) {
      if constexpr (operation == Operation::divide) asm volatile("vdivpd %2, %1, %0" : "=v"(results[i]) : "v"(operand), "v"(divisor));
      if constexpr (operation == Operation::root) asm volatile("vsqrtpd %1, %0" : "=v"(results[i]) : "v"(operand));
      if constexpr (operation == Operation::multiply_add) asm volatile("vfmadd213pd %1, %1, %0" : "+v"(results[i]) : "v"(operand));
    }
  }
}

template <int bits, Operation operation>
[[gnu::target("arch=x86-64-v3")]] void run_v3() {
  run<bits, operation>();
}
template <int bits, Operation operation>
[[gnu::target("arch=x86-64-v4")]] void run_v4() {
  run<bits, operation>();
}
#endif

// None where the processor lacks it.
using Run = void (*)();
template <Operation operation>
Run run_of(int bits) {
#if defined(__x86_64__)
  const bool is_v3 = __builtin_cpu_supports("x86-64-v3"), is_v4 = __builtin_cpu_supports("x86-64-v4");
  if (bits == 128 && is_v3) return run_v3<128, operation>;
  if (bits == 256 && is_v3) return run_v3<256, operation>;
  if (bits == 512 && is_v4) return run_v4<512, operation>;
#endif
  return nullptr;
}

std::string name_of(Operation operation, int bits) { return fmt::format("limit_{}/{}", names[static_cast<std::size_t>(operation)], bits); }

void measure(benchmark::State& state, Run run, int bits) {
  run();
  for (auto _ : state) {
    const double before = now(1);
    run();
    state.SetIterationTime(now(1) - before);
  }
  state.SetItemsProcessed(state.iterations() * chain_count * round_count * (bits / 64));
}

double million_per_second(const Medians& medians, Operation operation, int bits) {
  return median(medians, name_of(operation, bits), "items_per_second") / 1e6;
}

}  // namespace

void register_limit() {
  for (const int bits : widths)
    for (const auto& [operation, run] : {std::pair{Operation::divide, run_of<Operation::divide>(bits)},
                                         {Operation::root, run_of<Operation::root>(bits)},
                                         {Operation::multiply_add, run_of<Operation::multiply_add>(bits)}})
      if (run)
        benchmark::RegisterBenchmark(name_of(operation, bits).c_str(), [run = run, bits](benchmark::State& state) { measure(state, run, bits); })
            ->UseManualTime()->Unit(benchmark::kMicrosecond);
}

void print_limit(const Medians& medians) {
  std::string rows;
  for (const Operation operation : {Operation::divide, Operation::root, Operation::multiply_add}) {
    if (std::isnan(million_per_second(medians, operation, widths.front()))) continue;
    rows += fmt::format("{:<16}", names[static_cast<std::size_t>(operation)]);
    for (const int bits : widths) {
      const double rate = million_per_second(medians, operation, bits);
      rows += fmt::format("{:>12}{:>10}", decimal(rate, 0), decimal(bits / 64 / rate * 1e3, 2));
    }
    rows += "\n";
  }
  if (rows.empty()) return;
  fmt::print("\nThe machine's own limit, one thread, medians: millions of doubles per second, and nanoseconds per vector\n\n"
             "{:<16}{:>22}{:>22}{:>22}\n{}", "operation", "128 bits: M/s, ns", "256 bits: M/s, ns", "512 bits: M/s, ns", rows);
}

double divider_limit(const Medians& medians, int bits, int root_count, int division_count) {
  return 1 / (root_count / million_per_second(medians, Operation::root, bits) + division_count / million_per_second(medians, Operation::divide, bits));
}

double port_limit(const Medians& medians, int bits, int operation_count) {
  return million_per_second(medians, Operation::multiply_add, bits) / operation_count;
}

}  // namespace sagitta::bench
