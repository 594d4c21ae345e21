// SPDX-License-Identifier: Apache-2.0
// Rays that the user gives: a CSV file with a header line that names the columns x_mm,y_mm,z_mm,l,m,n and, where wanted,
// wavelength_nm, in any order. The other columns of the listing that `sagitta rays` prints are passed over, so its rows
// can be sent on; any other column is an error. Global frame, direction cosines.
#pragma once

#include <string>
#include <vector>

#include "lib/numerics/vec3.h"
#include "lib/prescription/model.h"

namespace sagitta::tools {

struct GivenRay {
  numerics::Vec3<double> position, direction;
  double wavelength_nm;
};

// A direction whose length differs from 1 by more than 1e-3 is an error; a smaller difference (cosines printed to few
// digits) is divided out, one within rounding (4 eps) is left as it is.
std::vector<GivenRay> read_given_rays(const std::string& file, double default_wavelength_nm, prescription::Findings& findings);

}  // namespace sagitta::tools
