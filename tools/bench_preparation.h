// SPDX-License-Identifier: Apache-2.0
// The part of the benchmarks that is about preparing point clouds.
#pragma once

#include "tools/bench_medians.h"

namespace sagitta::bench {

// Registers the benchmarks preparation_*.
void register_preparation();

// A table of those that have run.
void print_preparation(const Medians& medians);

}  // namespace sagitta::bench
