// SPDX-License-Identifier: Apache-2.0
// The part of the benchmarks that is about preparing point clouds.
#pragma once

namespace sagitta::bench {

// Registers the benchmarks preparation_*.
void register_preparation();

}  // namespace sagitta::bench
