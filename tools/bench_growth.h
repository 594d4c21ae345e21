// SPDX-License-Identifier: Apache-2.0
// The part of the benchmarks that is about growth: seconds against rays, fields, wavelengths and surfaces.
#pragma once

#include "tools/bench_medians.h"

namespace sagitta::bench {

// Registers the benchmarks growth_*.
void register_growth();

// A table of those that have run.
void print_growth(const Medians& medians);

}  // namespace sagitta::bench
