// SPDX-License-Identifier: Apache-2.0
// What the panels of a report say.
#include <gtest/gtest.h>

#include "lib/output/report_internal.h"

namespace sagitta::output::test {
namespace {

// The real stop has no place in the paraxial entrance pupil's millimetres.
TEST(PupilPanel, has_the_size_of_the_pupil_and_of_the_stop_where_rays_are_aimed_at_it) {
  Report report;
  report.first_order.entrance_pupil.semi_diameter = 3.1;
  const std::vector<double> map(64 * 64, 0.25);
  const Panel pupil = pupil_panel(report, 64, map, "");
  EXPECT_TRUE(pupil.axes.unit_mm);
  EXPECT_EQ(pupil.axes.pixel_width, 3.1 / 31);
  EXPECT_EQ(pupil.axes.x_label + ", " + pupil.axes.y_label, "pupil x, pupil y");
  report.pupil_is_of_stop = true;
  const Panel stop = pupil_panel(report, 64, map, "");
  EXPECT_FALSE(stop.axes.unit_mm);
  EXPECT_EQ(stop.axes.pixel_width, 1. / 31);
  EXPECT_EQ(stop.axes.x_label + ", " + stop.axes.y_label, "stop x, stop y");
  EXPECT_EQ(pupil_map_attributes(report, 64)[2].name, "pupil");
}

}  // namespace
}  // namespace sagitta::output::test
