// SPDX-License-Identifier: Apache-2.0
// What must hold between values that are each legal by themselves.
#pragma once

#include <string>
#include <vector>

#include "lib/medium/medium.h"
#include "lib/prescription/diagnostics.h"
#include "lib/prescription/model.h"

namespace sagitta::prescription {

// A medium and where the prescription names or describes it.
struct MediumUse {
  medium::Medium medium;
  Place place;
};

// Each wavelength lies in the medium's range and has an index there; an error at the place of use that names those that do not.
void check_medium(const MediumUse& use, const std::vector<double>& wavelengths_nm, Findings& findings);

// What is to be said of a medium that these wavelengths extrapolate; "" where they do not.
std::string told_extrapolation(const medium::Medium& medium, const std::vector<double>& wavelengths_nm);

// Every wavelength lies in the range of every medium and has a positive index there, with a warning, once of a medium, where that is extrapolated; image_f_number has an infinite
// object, object_na and object_heights_mm a finite one; object_na is less than the index of the object's medium. An
// object distance that could not be read is NaN: nothing is said about it again.
void check_model(const Model& model, const std::vector<MediumUse>& media, Findings& findings);

}  // namespace sagitta::prescription
