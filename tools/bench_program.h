// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fcntl.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <optional>
#include <string>
#include <vector>

#include "tools/bench_clock.h"

namespace sagitta::bench {

struct Run {
  double processor = 0, wall = 0;  // seconds: user and system, and of the clock
};

// The program that CMake names (SAGITTA_PROGRAM), in a process of its own; none where it fails.
inline std::optional<Run> run_program(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), SAGITTA_PROGRAM);
  std::vector<char*> pointers;
  for (std::string& argument : arguments) pointers.push_back(argument.data());
  pointers.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  const double before = now(0);
  pid_t child = 0;
  const bool has_started = posix_spawn(&child, SAGITTA_PROGRAM, &actions, nullptr, pointers.data(), environ) == 0;
  posix_spawn_file_actions_destroy(&actions);
  int status = 0;
  rusage use{};
  if (!has_started || wait4(child, &status, 0, &use) != child || status != 0) return std::nullopt;
  const auto seconds = [](const timeval& time) { return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec); };
  return Run{seconds(use.ru_utime) + seconds(use.ru_stime), now(0) - before};
}

}  // namespace sagitta::bench
