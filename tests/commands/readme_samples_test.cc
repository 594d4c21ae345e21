// SPDX-License-Identifier: Apache-2.0
// What README shows is what the program prints, but for times: every indented command `build/sagitta ...` that a block in fences follows. (One
// of them, fit, triangulates.)
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <regex>
#include <string>

#include "tests/support/program.h"

namespace sagitta::test {
namespace {

std::string without_times(const std::string& text) { return std::regex_replace(text, std::regex(" in [0-9.]+ (µs|ms|s)\\b"), " in TIME"); }

// Found by review, 2026-11-22: rays differed from the sample in their last digits.
TEST(Readme, shows_what_the_program_prints) {
  std::ifstream file(SAGITTA_SOURCE_DIR "/README.md");
  const std::string readme{std::istreambuf_iterator<char>(file), {}};
  const std::string command = "\n    build/sagitta ", fence = "\n\n```\n";
  const Folder folder;
  int samples = 0;
  for (std::size_t at = readme.find(command); at != std::string::npos; at = readme.find(command, at + 1)) {
    const std::size_t from = at + command.size(), line_end = readme.find('\n', from);
    if (readme.compare(line_end, fence.size(), fence) != 0) continue;
    const std::size_t shown = line_end + fence.size();
    std::string arguments = readme.substr(from, line_end - from);
    arguments = std::regex_replace(arguments, std::regex("-o [^ ]+"), "-o " + folder.path("out"));
    EXPECT_EQ(without_times(run_program(arguments, "cd '" SAGITTA_SOURCE_DIR "' && ").out), without_times(readme.substr(shown, readme.find("```", shown) - shown))) << arguments;
    ++samples;
  }
  EXPECT_GE(samples, 5);
}

}  // namespace
}  // namespace sagitta::test
