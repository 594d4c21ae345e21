// SPDX-License-Identifier: Apache-2.0
// What fuzzing kept, and what it began with, through the same entry points: every input as the fuzzer reads it, without the fuzzer.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "tests/fuzz/targets.h"

namespace sagitta::fuzz {
namespace {

namespace fs = std::filesystem;

int replay(const Target& target, const fs::path& inputs) {
  const Folder folder;
  put_named_files(folder);
  int count = 0;
  for (const auto& input : fs::directory_iterator(inputs)) {
    std::ifstream stream(input.path(), std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
    EXPECT_EQ(target.run(folder, bytes), "") << input.path();
    ++count;
  }
  return count;
}

class EveryTarget : public testing::TestWithParam<Target> {};

TEST_P(EveryTarget, StandsWhatFuzzingKept) {
  const fs::path here = fs::path(SAGITTA_SOURCE_DIR) / "tests/fuzz";
  EXPECT_GT(replay(GetParam(), here / "seeds" / GetParam().name), 0);
  EXPECT_GT(replay(GetParam(), here / "corpus" / GetParam().name), 20);
}

INSTANTIATE_TEST_SUITE_P(Fuzz, EveryTarget, testing::ValuesIn(targets), [](const auto& one) { return std::string(one.param.name); });

}  // namespace
}  // namespace sagitta::fuzz
