// SPDX-License-Identifier: Apache-2.0
// A surface of a CODE V sequence as its commands say it, and the step from that to a surface of a lens.
//
// Decenters: the frame is moved by XDE YDE ZDE and turned by ADE, BDE, CDE about its new x, y, z (ADE and BDE left-handed), and
//   basic            the surfaces behind stay in that frame
//   DAR              only this surface stands in it
//   REV              this surface does not; the frame behind it is moved back by it, the last turn first
//   BEN (a fold)     this surface stands in it; the frame behind is turned once more
#pragma once

#include <map>
#include <optional>
#include <string>

#include "lib/lens_file/lens.h"
#include "lib/lens_file/report.h"

namespace sagitta::lens_file {

struct CodeVSurface {
  Place place;
  std::string name;
  bool stop = false;
  std::optional<Real> radius;  // where it was given so
  Real curvature = 0, conic = 0, thickness = 0;
  Real curvature_rounding = 0;  // half a unit of its last digit, where it was given
  Place curvature_place, shape_place, thickness_place;  // shape: conic constant and powers
  std::map<int, Real> powers;  // coefficients of powers of r
  Medium medium;                      // what follows, where no mirror stands
  std::optional<Place> mirror_place;  // of a mirror, REFL
  Real semi_diameter = 0, inner_semi_diameter = 0;  // 0: none
  Place circle_place;
  enum class Decenter { basic, and_return, reverse, bend } decenter = Decenter::basic;
  Place decenter_kind_place;  // of DAR, REV, BEN
  numerics::Vec3<Real> shift{}, tilt{};  // tilt as in the file
  Place decenter_place;
};

// Numbers of `given` are in units of `unit_mm`.
Surface surface_of(const CodeVSurface& given, Real unit_mm, Report& report);

}  // namespace sagitta::lens_file
