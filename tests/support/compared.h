// SPDX-License-Identifier: Apache-2.0
// What `sagitta compare` and `sagitta trace` say of systems, as JSON.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/program.h"

namespace sagitta::test {

inline const std::string systems = SAGITTA_SOURCE_DIR "/systems/";

inline nlohmann::json compared(const std::string& arguments, int expected_status = 0) {
  const Folder folder;
  const Outcome run = run_program("compare " + arguments + " -o " + folder.path("out") + " --json");
  EXPECT_EQ(run.status, expected_status) << run.err;
  EXPECT_EQ(run.out, read_text(folder.path("out/summary.json")));
  return nlohmann::json::parse(run.out);
}

inline nlohmann::json traced(const std::string& system, const std::string& options = {}) {
  const Folder folder;
  const Outcome run = run_program("trace " + system + " -o " + folder.path("out") + " --json " + options);
  EXPECT_EQ(run.status, 0) << run.err;
  return nlohmann::json::parse(run.out);
}

}  // namespace sagitta::test
