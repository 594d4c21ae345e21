// SPDX-License-Identifier: Apache-2.0
// Every shipped system as a study of its own; some of them triangulate.
#include <gmock/gmock.h>

#include "tests/support/program.h"

namespace sagitta::test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

TEST(StudySystemCommand, works_on_every_shipped_system) {
  int systems = 0, with_points = 0;
  for (const auto& entry : fs::directory_iterator(SAGITTA_SOURCE_DIR "/systems")) {
    if (entry.path().extension() != ".yaml") continue;
    SCOPED_TRACE(entry.path().string());
    const Folder folder;
    const Outcome run = run_program("study --system '" + entry.path().string() + "' -o '" + folder.path("out") + "'");
    EXPECT_EQ(run.status, 0);
    EXPECT_EQ(run.err, "");
    EXPECT_THAT(run.out, HasSubstr("rays give the spot RMS to "));
    EXPECT_THAT(run.out, HasSubstr("samples give the wavefront RMS to "));
    EXPECT_THAT(run.out, HasSubstr("samples give every Zernike coefficient to "));
    EXPECT_THAT(run.out, ::testing::Not(HasSubstr("no spot RMS")));
    EXPECT_THAT(run.out, ::testing::Not(HasSubstr("unknown amount")));
    const bool has_points = read_text(entry.path()).find("delaunay: {") != std::string::npos;
    EXPECT_EQ(run.out.find("cubic in place of c1") != std::string::npos, has_points);
    with_points += has_points;
    ++systems;
  }
  EXPECT_EQ(systems, 10);
  EXPECT_EQ(with_points, 3);
}

}  // namespace
}  // namespace sagitta::test
