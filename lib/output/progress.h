// SPDX-License-Identifier: Apache-2.0
// One line that says how far a long piece of work has come: on a terminal only, only once the work has lasted for a
// second, at most ten times a second, and gone without a trace at the end. No terminal control is used but the carriage
// return.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <string>

namespace sagitta::output {

// "45 s", "3 min": rounded up.
std::string duration_in_words(double seconds);

struct ProgressManners {
  int descriptor = 2;  // standard error
  std::chrono::milliseconds silence{1000};
  std::chrono::milliseconds interval{100};
  bool tells_time_left = false;  // "WHAT  42 %, 3 min left", from the time that the steps so far have taken
};

class Progress {
 public:
  // "WHAT  42 %"; 100 % is `total` steps.
  Progress(std::string what, std::uint64_t total, ProgressManners manners = {});
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  ~Progress();  // erases the line

  // So many more steps are done; of 0 the line is drawn anew. From any thread, and cheap: one that finds another drawing does not wait for it.
  void advance(std::uint64_t steps = 1);

 private:
  void show(std::string line);

  const std::string what_;
  const std::uint64_t total_;
  const ProgressManners manners_;
  const bool on_terminal_;
  std::atomic<std::uint64_t> done_{0};
  std::mutex drawing_;
  const std::chrono::steady_clock::time_point start_;
  std::chrono::steady_clock::time_point next_;
  std::size_t shown_ = 0;  // bytes of the line that stands there, at least its width
};

}  // namespace sagitta::output
