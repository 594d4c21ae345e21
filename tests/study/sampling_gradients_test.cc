// SPDX-License-Identifier: Apache-2.0
// Gradients, integrated to every tolerance.
#include "lib/study/settled.h"
#include "tests/study/subjects.h"

namespace sagitta::test {
namespace {

study::Sampling sampling_of(const std::string& medium, const std::string& more = {}) {
  const Folder folder;
  const auto read = prescription::read_prescription(folder.file("system.yaml",
      "sagitta: 1\nwavelengths_nm: [550]\naperture: {entrance_pupil_diameter_mm: 1}\n" + more + "surfaces:\n"
      "  - {stop: true, conic: {radius_mm: 20}, thickness_mm: 12, medium: " + medium + "}\n  - {thickness_mm: 3.2}\n  - {name: image}\n"));
  EXPECT_TRUE(read.model);
  study::SamplingRequest request;
  request.most_rays = 1000;
  request.most_grid = 24;
  return study::sample_system(*read.model, request, [](double) {});
}

constexpr const char* rod = "{grin: {selfoc: {index: 1.6, g_per_mm: 0.3}}}";

TEST(SamplingOfGradients, TellsWhatEveryToleranceLeavesAndTheStepsItTakes) {
  const study::Sampling sampling = sampling_of(rod, "tolerance_mm: 1e-9\n");
  const auto changes = study::tolerance_changes_of(sampling);
  ASSERT_EQ(changes.size(), 8u);  // seven and the system's own
  for (std::size_t i = 0; i < changes.size(); ++i) {
    const study::ToleranceRun& run = *changes[i].run;
    EXPECT_EQ(run.is_given, run.tolerance_mm == 1e-9);
    EXPECT_GE(run.steps, 1);
    EXPECT_GT(changes[i].time_ratio, 0);
    if (run.is_given) {
      EXPECT_EQ(changes[i].time_ratio, 1);
    }
    if (i == 0) {
      EXPECT_EQ(changes[i].change[0].main(), 0);
      continue;
    }
    EXPECT_GT(run.tolerance_mm, changes[i - 1].run->tolerance_mm);
    EXPECT_LE(run.steps, changes[i - 1].run->steps);
    // A ray is off by steps times tolerance at most, within a few, so a spot of some um by that; in percent of itself.
    const double spot_mm = sampling.tolerances.front().spots.answers.front().spot_rms_um.front() * 1e-3;
    EXPECT_LE(changes[i].change[0].percent, 100 * 10 * run.steps * run.tolerance_mm / spot_mm) << run.tolerance_mm;
  }
  EXPECT_LT(changes.back().run->steps, changes.front().run->steps);
  EXPECT_GT(changes.back().change[0].percent, changes[1].change[0].percent);
}

TEST(SamplingOfGradients, AreNoneWhereRaysAreStraight) { EXPECT_TRUE(sampling_of("{index: 1.6}").tolerances.empty()); }

}  // namespace
}  // namespace sagitta::test
