// SPDX-License-Identifier: Apache-2.0
// When `verify` calls answers good, and which surface it names where they are not. Reports made by hand: the tracer gives none of these.
#include "lib/output/rounding_report.h"

#include <gmock/gmock.h>

#include <limits>

namespace sagitta::output {
namespace {

using surface::Status;
using ::testing::HasSubstr;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

// One ray that arrives through the launch and two surfaces, the first of the larger share in the OPD, the second in the place.
RoundingReport report_of(double position_mm, double opd_waves) {
  RoundingReport report;
  report.system.surface_names = {"lens", "image"};
  report.system.wavelengths_nm = {550};
  report.position_tolerance_mm = 1e-9, report.opd_tolerance_waves = 1e-4;
  report.rounding.scale_mm = 1;
  report.rounding.rays = 1;
  report.rounding.surfaces.resize(3);
  for (auto& surface : report.rounding.surfaces) surface.position_mm.add(0);
  report.rounding.surfaces[1].share_waves.add(2), report.rounding.surfaces[1].share_mm.add(1);
  report.rounding.surfaces[2].share_waves.add(1), report.rounding.surfaces[2].share_mm.add(2);
  report.rounding.fields.resize(1);
  report.rounding.fields[0].position_mm.add(position_mm);
  report.rounding.fields[0].opd_waves.add(opd_waves);
  report.rounding.fields[0].rays = report.rounding.fields[0].arrived = 1;
  return report;
}

TEST(RoundingReport, IsGoodUpToItsTolerances) {
  EXPECT_TRUE(is_good(report_of(1e-9, 1e-4)));
  EXPECT_FALSE(is_good(report_of(1.1e-9, 0)));
  EXPECT_FALSE(is_good(report_of(0, 1.1e-4)));
}

TEST(RoundingReport, NamesTheSurfaceOfTheLargestShareInWhatIsNotGood) {
  EXPECT_EQ(surface_to_blame(report_of(1, 0)), 2);
  EXPECT_EQ(surface_to_blame(report_of(0, 1)), 1);
  EXPECT_THAT(rounding_text(report_of(0, 1)), HasSubstr("\nlargest share: surface 1 (lens)\n"));
}

TEST(RoundingReport, IsNotGoodWhereAnAnswerIsNoNumber) {
  EXPECT_FALSE(is_good(report_of(nan, 0)));
  EXPECT_FALSE(is_good(report_of(0, nan)));
  const RoundingReport report = report_of(nan, 0);
  EXPECT_THAT(rounding_json({&report, 1}), HasSubstr("\"worst_position_mm\": null"));
}

TEST(RoundingReport, IsGoodWhereARayEndsDifferentlyOnARimAlone) {
  RoundingReport report = report_of(0, 0);
  report.rounding.disagreements.push_back({0, 0, .5, 0, Status::clipped, Status::ok, 2, 0, true});
  EXPECT_TRUE(is_good(report));
  report.rounding.disagreements.push_back({0, 0, 0, .5, Status::total_reflection, Status::missed, 2, 1, false});
  EXPECT_FALSE(is_good(report));
  EXPECT_EQ(surface_to_blame(report), 1);  // where the first of the two ends
}

}  // namespace
}  // namespace sagitta::output
