// SPDX-License-Identifier: Apache-2.0
// The part of the benchmarks that holds the kernels against the machine's own limit and against what is asked of them.
#pragma once

#include "tools/bench_medians.h"

namespace sagitta::bench {

// Registers the benchmarks kernel_*. The processor's instruction set is chosen once in a process: those for another one run in
// processes of their own, for which main first asks this.
bool is_kernel_process(int argc, char** argv);
int run_kernel_process(char** argv);

void register_kernels();

// A table of those that have run; the limit's figures come from bench_limit.h.
void print_kernels(const Medians& medians);

}  // namespace sagitta::bench
