// SPDX-License-Identifier: Apache-2.0
// Every diagnostic of the readers of lens files has a broken file in bad/ and, beside it, what is said of it, NAME.zmx.expected. Files are printed by their base names.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "tests/lens_file/support.h"

namespace sagitta::lens_file::test {
namespace {

namespace fs = std::filesystem;

const std::string folder = SAGITTA_SOURCE_DIR "/tests/lens_file/bad/";

std::vector<std::string> files() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() != ".expected") names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

std::string contents(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

class BadLensFile : public testing::TestWithParam<std::string> {};

TEST_P(BadLensFile, GetsTheExpectedFindingsAndNoPrescription) {
  const Outcome refused = import_text(GetParam(), contents(folder + GetParam()));
  EXPECT_EQ(refused.prescription, "");
  EXPECT_EQ(refused.messages, contents(folder + GetParam() + ".expected"));
  // In part, there are either errors or a prescription that can be read (import_text looks).
  const Outcome partial = import_text(GetParam(), contents(folder + GetParam()), true);
  EXPECT_EQ(partial.prescription.empty(), partial.messages.find(": error: ") != std::string::npos) << partial.messages;
}

INSTANTIATE_TEST_SUITE_P(Files, BadLensFile, testing::ValuesIn(files()), [](const auto& file) {
  std::string name = file.param;
  for (char& c : name)
    if (c == '.') c = '_';
  return name;
});

TEST(BadLensFiles, AreAllThere) { EXPECT_EQ(files().size(), 85u); }

// Every file that begins like a good one, byte by byte: messages or a prescription, and no crash.
TEST(LensFiles, MayEndAnywhere) {
  const std::string seeds = SAGITTA_SOURCE_DIR "/tests/fuzz/seeds/lens_file/";
  int refused = 0;
  for (const char* name : {"shapes.zmx", "code-v.seq", "utf-16.zmx", "grid.zmx"}) {
    const std::string text = contents(seeds + name);
    EXPECT_NE(import_text(name, text).prescription, "") << import_text(name, text).messages;
    for (std::size_t end = 0; end < text.size(); end += 7) {
      const Outcome run = import_text(name, text.substr(0, end));
      EXPECT_EQ(run.prescription.empty(), run.messages.find(": error: ") != std::string::npos);
      refused += run.prescription.empty();
    }
  }
  EXPECT_GT(refused, 200);
}

}  // namespace
}  // namespace sagitta::lens_file::test
