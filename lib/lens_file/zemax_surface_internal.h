// SPDX-License-Identifier: Apache-2.0
// A surface of a Zemax file as its lines say it, and the step from that to a surface of a lens: one function a type.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "lib/lens_file/lens.h"
#include "lib/lens_file/report.h"

namespace sagitta::lens_file {

struct PlacedNumber {
  Real value = 0;
  Place place;
  Real rounding = 0;  // half a unit of its last digit
};

// The heights that stand in the file.
struct ZemaxGrid {
  std::optional<Place> place;              // of GDAT
  std::vector<Real> layout;                // GDAT nx ny dx dy
  std::vector<std::array<Real, 4>> nodes;  // GARR n z dz/dx dz/dy d2z/dxdy
  int first_node = 0;                      // n of the first one, 0 or 1
};

struct ZemaxSurface {
  Place place;
  std::string type = "STANDARD", comment;
  Place type_place;
  bool stop = false, infinite = false;
  PlacedNumber curvature, conic, thickness;     // in lens units
  std::optional<PlacedNumber> semi_diameter;    // DIAM
  std::map<int, PlacedNumber> parm, xdat;
  Medium medium;
  struct Clip {
    std::string operand;  // CLAP, FLAP or OBSC
    Real least = 0, most = 0;
    Place place;
  };
  std::optional<Clip> clip;
  bool clip_is_off_centre = false;
  std::optional<ZemaxGrid> grid;

  bool is_coordinate_break() const { return type == "COORDBRK"; }
};

// Shape, gradient and clipping of a surface whose lengths are in units of `unit_mm`. PARM and XDAT that the type has no use for, and are not 0, are left out.
Surface surface_of(const ZemaxSurface& given, Real unit_mm, Report& report);

// The heights of a surface of type GRID_SAG as a file that the shape `grid` reads; "", with a message, where there are none that are understood. There is no public
// specification: that the lines are GDAT nx ny dx dy and, for each node, GARR n z dz/dx dz/dy d2z/dxdy is what pyrate's reader takes them for (pyrateoptics, io/zmx.py),
// whose rows run as those of OpticStudio's grid files.
std::string grid_file_of(const ZemaxSurface& given, Real unit_mm, Report& report);

// A coordinate break: its move, without the thickness behind it.
Move move_of(const ZemaxSurface& given, Real unit_mm, Report& report);

}  // namespace sagitta::lens_file
