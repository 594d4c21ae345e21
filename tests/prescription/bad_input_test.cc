// SPDX-License-Identifier: Apache-2.0
// Every diagnostic of the prescription reader has a broken file in bad/ and, beside it, the findings it must get. Files
// are printed by their base names, and the folders of the search path, which differ between machines, as FOLDERS.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "lib/prescription/reader.h"
#include "lib/prescription/search_path.h"
#include "tests/prescription/support.h"

namespace sagitta::prescription {
namespace {

namespace fs = std::filesystem;

const std::string folder = SAGITTA_SOURCE_DIR "/tests/prescription/bad";

std::vector<std::string> cases() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".expected") names.push_back(entry.path().stem().string());
  return names;
}

std::string text_of_file(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::string with_base_names(const Findings& findings) {
  std::string folders;
  for (const std::string& one : search_folders(folder)) folders += (folders.empty() ? "" : ", ") + one;
  std::string text;
  for (Finding finding : findings.all()) {
    finding.place.file = fs::path(finding.place.file).filename();
    if (const auto at = finding.hint.find(folders); at != std::string::npos)
      finding.hint.replace(at, folders.size(), "FOLDERS");
    text += format(finding) + "\n";
  }
  return text;
}

class BadInput : public testing::TestWithParam<std::string> {};

TEST_P(BadInput, GetsTheExpectedFindingsAndNoModel) {
  ::unsetenv("SAGITTA_DATA");
  const ReadResult result = read_prescription(folder + "/" + GetParam() + ".yaml");
  EXPECT_FALSE(result.model.has_value());
  EXPECT_EQ(with_base_names(result.findings), text_of_file(folder + "/" + GetParam() + ".expected"));
}

INSTANTIATE_TEST_SUITE_P(Files, BadInput, testing::ValuesIn(cases()), [](const auto& file) { return file.param; });

TEST(BadInputs, AreAllThere) {
  std::size_t yaml_count = 0;
  for (const auto& entry : fs::directory_iterator(folder)) yaml_count += entry.path().extension() == ".yaml";
  EXPECT_EQ(cases().size(), 84u);
  EXPECT_EQ(yaml_count, 83u);  // missing_file has none
}

}  // namespace
}  // namespace sagitta::prescription
