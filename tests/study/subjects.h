// SPDX-License-Identifier: Apache-2.0
// Systems under study, for tests.
#pragma once

#include <gtest/gtest.h>

#include "lib/study/variant.h"
#include "tests/support/prescriptions.h"

namespace sagitta::test {

// A system of these surfaces and an image plane behind them, at 855 nm, light from infinity.
inline prescription::Model system_of(std::vector<prescription::Surface> surfaces, double pupil_diameter_mm, std::vector<double> angles_deg = {0}) {
  prescription::Model model;
  model.file = "study";
  model.wavelengths_nm = {855};
  model.aperture = {prescription::ApertureKind::entrance_pupil_diameter_mm, pupil_diameter_mm, false, {}};
  model.fields.points.clear();
  for (const double angle : angles_deg) model.fields.points.push_back({0, angle});
  model.surfaces = std::move(surfaces);
  model.surfaces.front().stop = true;
  model.surfaces.push_back(surface_of({}, 0, 1));
  return model;
}

// The lens of the founding paper's section 3.A: one sphere of R 65.77 mm in front of the index 1.64134164, pupil of 25 mm; its image plane
// in the paraxial focus, n R/(n - 1).
inline prescription::Model paper_lens(double angle_deg = 0) {
  constexpr double index = 1.64134164, radius = 65.77;
  return system_of({surface_of(conic_shape(radius, 0), index * radius / (index - 1), index)}, 25, {angle_deg});
}

inline study::Row row_of(study::Subject& subject, const study::Variant& variant) {
  const study::Measured measured = subject.measure(variant);
  EXPECT_TRUE(measured.row) << measured.reason;
  return measured.row.value_or(study::Row{});
}

}  // namespace sagitta::test
