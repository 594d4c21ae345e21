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

// 0: as many threads as the machine runs.
inline int thread_count_of(int asked) { return asked > 0 ? asked : static_cast<int>(std::max(1u, std::thread::hardware_concurrency())); }

// How many threads share the blocks: one is worth starting for four of them or more.
inline std::size_t worker_count(std::size_t block_count, int thread_count) {
  return std::clamp<std::size_t>((block_count + 3) / 4, 1, static_cast<std::size_t>(thread_count_of(thread_count)));
}

// Calls make_worker() once on each thread, then its result with every number below block_count, once each in all.
// thread_count 0: as many threads as the machine runs.
template <class MakeWorker>
void share_blocks(std::size_t block_count, int thread_count, const MakeWorker& make_worker) {
  std::atomic<std::size_t> next = 0;
  const auto work = [&] {
    auto worker = make_worker();
    for (std::size_t block; (block = next++) < block_count;) worker(block);
  };
  const std::size_t workers = worker_count(block_count, thread_count);
  std::vector<std::jthread> helpers;
  try {
    for (std::size_t i = 1; i < workers; ++i) helpers.emplace_back(work);
  } catch (const std::system_error&) {
    // The machine gives no more threads: those at hand do the work, with the same results.
  }
  work();
}

// Both, at the same time where more than one thread is asked for.
template <class First, class Second>
void do_both(int thread_count, const First& first, const Second& second) {
  std::jthread helper;
  try {
    if (thread_count_of(thread_count) > 1) helper = std::jthread(second);
  } catch (const std::system_error&) {
    // as in share_blocks
  }
  first();
  if (!helper.joinable()) second();
}

}  // namespace sagitta::numerics
