// SPDX-License-Identifier: Apache-2.0
// Blocks of work shared among threads. Which thread does a block is left open: a block's result must depend on its number
// alone.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <system_error>
#include <thread>
#include <vector>

namespace sagitta::numerics {

// Calls make_worker() once on each thread, then its result with every number below block_count, once each in all.
// thread_count 0: as many threads as the machine runs.
template <class MakeWorker>
void share_blocks(std::size_t block_count, int thread_count, const MakeWorker& make_worker) {
  std::atomic<std::size_t> next = 0;
  const auto work = [&] {
    auto worker = make_worker();
    for (std::size_t block; (block = next++) < block_count;) worker(block);
  };
  std::size_t workers = thread_count > 0 ? static_cast<std::size_t>(thread_count) : std::max(1u, std::thread::hardware_concurrency());
  workers = std::min(workers, (block_count + 3) / 4);  // a thread is worth starting for four blocks or more
  std::vector<std::jthread> helpers;
  try {
    for (std::size_t i = 1; i < workers; ++i) helpers.emplace_back(work);
  } catch (const std::system_error&) {
    // The machine gives no more threads: those at hand do the work, with the same results.
  }
  work();
}

}  // namespace sagitta::numerics
