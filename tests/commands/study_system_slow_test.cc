// SPDX-License-Identifier: Apache-2.0
// Every shipped system as a study of its own; some of them triangulate, some integrate through gradients.
#include <gmock/gmock.h>

#include <algorithm>

#include "tests/support/program.h"

namespace sagitta::test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;

std::vector<fs::path> shipped_systems() {
  std::vector<fs::path> systems;
  for (const auto& entry : fs::directory_iterator(SAGITTA_SOURCE_DIR "/systems"))
    if (entry.path().extension() == ".yaml") systems.push_back(entry.path());
  std::sort(systems.begin(), systems.end());
  return systems;
}

bool has_points(const fs::path& system) { return read_text(system).find("delaunay: {") != std::string::npos; }

class StudyOfShippedSystem : public ::testing::TestWithParam<fs::path> {};

TEST_P(StudyOfShippedSystem, has_every_answer) {
  const Folder folder;
  const Outcome run = run_program("study --system '" + GetParam().string() + "' -o '" + folder.path("out") + "'");
  EXPECT_EQ(run.status, 0);
  EXPECT_EQ(run.err, "");
  EXPECT_THAT(run.out, HasSubstr("rays give the spot RMS to "));
  EXPECT_THAT(run.out, HasSubstr("samples give the wavefront RMS to "));
  EXPECT_THAT(run.out, HasSubstr("samples give every Zernike coefficient to "));
  EXPECT_THAT(run.out, Not(HasSubstr("no spot RMS")));
  EXPECT_THAT(run.out, Not(HasSubstr("unknown amount")));
  EXPECT_EQ(run.out.find("cubic in place of c1") != std::string::npos, has_points(GetParam()));
}

INSTANTIATE_TEST_SUITE_P(Systems, StudyOfShippedSystem, ::testing::ValuesIn(shipped_systems()), [](const auto& system) {
  std::string name = system.param.stem().string();
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

TEST(ShippedSystems, are_studied_with_points_and_without) {
  const std::vector<fs::path> systems = shipped_systems();
  EXPECT_GE(systems.size(), 28u);
  EXPECT_EQ(std::count_if(systems.begin(), systems.end(), has_points), 3);
}

}  // namespace
}  // namespace sagitta::test
