// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ctime>

namespace sagitta::bench {

// Seconds: of the processor for one thread, so that other work on the machine counts less; of the clock for several.
inline double now(int thread_count) {
  timespec time{};
  clock_gettime(thread_count == 1 ? CLOCK_THREAD_CPUTIME_ID : CLOCK_MONOTONIC, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace sagitta::bench
