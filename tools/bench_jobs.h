// SPDX-License-Identifier: Apache-2.0
// The part of the benchmarks that is about whole jobs: what `sagitta trace` takes beside its tracing.
#pragma once

#include "tools/bench_medians.h"

namespace sagitta::bench {

// Registers the benchmarks job_*.
void register_jobs();

// A table of those that have run.
void print_jobs(const Medians& medians);

}  // namespace sagitta::bench
