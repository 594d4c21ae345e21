// SPDX-License-Identifier: Apache-2.0
// The part of the benchmarks that is about the program as a whole: how long it takes to start, and how large it is.
#pragma once

#include "tools/bench_medians.h"

namespace sagitta::bench {

// Registers the benchmarks startup_*, each a command of the program in a process of its own.
void register_startup();

// A table of those that have run, and the sizes of the program and its module of pictures.
void print_startup(const Medians& medians);

}  // namespace sagitta::bench
