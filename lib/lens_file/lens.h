// SPDX-License-Identifier: Apache-2.0
// What a lens file of another program says, whichever program: a system without that program's words and units. Readers make it, the writer makes a
// prescription of it.
//
// Lengths are mm. Numbers of the file are kept as `Real`, whose digits exceed those of a double: a decimal number times a unit, or one over a curvature,
// comes out as the double nearest to what was meant (0.1 inch is 2.54 mm).
#pragma once

#include <cstddef>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "lib/numerics/vec3.h"
#include "lib/prescription/diagnostics.h"
#include "lib/prescription/model.h"

namespace sagitta::lens_file {

using Real = long double;
using prescription::Place;

// A shape, or a gradient-index form, as a prescription has it: the kind and its keys with their values, in order. Kind "": a plane. Of a shape made of data `points` is
// the text of their file, until import gives that a name.
using Indexed = std::map<int, double>;
struct Item {
  std::string key;
  std::variant<double, std::string, Indexed> value;
};
struct Form {
  std::string kind;
  std::vector<Item> items;
};

// A number as a file has it, and half a unit of its last digit; 0: it has none.
struct Stated {
  double value = 0, rounding = 0;
};

struct Medium {
  enum class Kind { air, mirror, glass, index, nd_vd, gradient };
  Kind kind = Kind::air;
  std::string name;           // of a glass: as the file spells it, and once it is found (glasses.h) as the prescription does
  double index = 1, vd = 0;   // `index`, or nd
  Form gradient;
  Place place;
  Stated stated_nd{}, stated_vd{};  // of a glass, where the file has them beside its name
};

// A change of the frame: the origin is moved, then the axes are turned about the new x, the new y, the new z, right-handed. The other way round it is the
// inverse of such a change: the axes are turned about z, the new y, the new x, then the origin is moved along the new ones.
struct Move {
  numerics::Vec3<Real> decenter{}, tilt_deg{};
  bool tilts_first = false;

  Move inverse() const { return {-decenter, -tilt_deg, !tilts_first}; }
  static Move along_axis(Real thickness) { return {{0, 0, thickness}, {}, false}; }
};

struct Surface {
  std::string name;  // "": none
  bool stop = false;
  Form shape;
  Real curvature = 0;         // 1/mm, of the vertex in the y-z section
  // Its frame is that of the surface before, after the thickness there, with `before`; it stands in it moved by `own`, which the next one does not see; then
  // come `after` and the thickness.
  std::vector<Move> before, own, after;
  Real thickness = 0, thickness_before = 0;  // thickness_before: what is along the axis in `before`
  Medium medium;              // what follows
  double semi_diameter = std::numeric_limits<double>::infinity(), inner_semi_diameter = 0;
  Place place;
};

struct Aperture {
  prescription::ApertureKind kind{};
  double value = 0;
  Place place;
};

struct Lens {
  std::string program;  // "a Zemax lens file"
  std::string title;
  std::vector<double> wavelengths_nm;
  std::vector<Place> wavelength_places;
  std::size_t primary = 0;  // place in wavelengths_nm
  std::optional<Aperture> aperture;
  bool aims = false;        // rays, at the stop
  prescription::FieldKind field_kind = prescription::FieldKind::angles_deg;
  std::vector<std::pair<double, double>> fields;  // empty: on the axis
  Place fields_place;
  double object_distance = std::numeric_limits<double>::infinity();
  Medium object_medium;
  std::vector<Surface> surfaces;  // the last one is the image surface
  std::optional<Place> solves_image;  // the last thickness is to reach the paraxial image, besides `image_shift`, which it holds
  Real image_shift = 0;

  void add_wavelength(double nm, Place place) {
    wavelengths_nm.push_back(nm);
    wavelength_places.push_back(std::move(place));
  }

  // To the vertex of the next surface, as if no move turned the axis.
  Real axial_thickness(std::size_t i) const { return surfaces[i].thickness + (i + 1 < surfaces.size() ? surfaces[i + 1].thickness_before : 0); }

  std::vector<std::string> glass_catalogs;  // that the file says its glasses are of

  std::vector<std::string> remarks;  // sentences for the head comment
};

}  // namespace sagitta::lens_file
