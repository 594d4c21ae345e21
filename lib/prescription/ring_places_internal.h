// SPDX-License-Identifier: Apache-2.0
// What the formats of Placido topographers share: samples on rings and meridians, and where those stood that are missing.
//
// A missing sample becomes an explicit hole (z NaN) on its meridian, at the radius interpolated along its ring between
// the neighbours that have one; a ring without any leaves nothing. Rings are not round, so that place may lie inside a
// measured sample of an inner ring, and the hole would take good data with it: then it goes between the measured samples
// of its meridian, and beyond the last one it leaves nothing.
//
// The files have z out of the eye and x to the examiner's right; the contract's eye frame has z into the eye and x to
// the examiner's left: (x, z) -> (-x, -z).
#pragma once

#include <string_view>
#include <vector>

#include "lib/numerics/vec3.h"

namespace sagitta::prescription {

struct RingSample {
  double ring = 0;          // its number: larger is further out
  double meridian_deg = 0;  // any finite angle
  double radius = 0;        // mm; NaN: missing
};

// "-1" or "-1000", written just so, stand for a missing number; one that happens to be -1 mm has its decimals.
bool is_missing_marker(std::string_view text);

// The places of the missing samples (see above), NaN for those that leave nothing; the radii of the others as they are.
std::vector<double> places_of(const std::vector<RingSample>& samples);

// The point at an elevation (out of the eye), in the eye's frame. Exact on meridians that are multiples of 90 degrees.
numerics::Vec3<double> in_eye_frame(double radius, double meridian_deg, double elevation);

}  // namespace sagitta::prescription
