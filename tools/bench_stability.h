// SPDX-License-Identifier: Apache-2.0
// What stability costs: a step through a conic as lib/surface does it, and by the same formulas without what keeps their digits.
#pragma once

#include "tools/bench_medians.h"

namespace sagitta::bench {

// Registers the benchmarks stability_*.
void register_stability();

// A table of those that have run.
void print_stability(const Medians& medians);

}  // namespace sagitta::bench
