// SPDX-License-Identifier: Apache-2.0
// The machine's own limit: how many divisions, square roots and multiply-adds of doubles it does a second, in vectors of
// every width that it has.
#pragma once

#include "tools/bench_medians.h"

namespace sagitta::bench {

// Registers the benchmarks limit_*.
void register_limit();

// A table of those that have run.
void print_limit(const Medians& medians);

// Millions of rays and surfaces a second that the divider allows, where each needs so many roots and divisions, with vectors of
// `bits`; NaN where the limit was not measured.
double divider_limit(const Medians& medians, int bits, int root_count, int division_count);

// The same of the ports that multiply and add, where each needs so many operations.
double port_limit(const Medians& medians, int bits, int operation_count);

}  // namespace sagitta::bench
