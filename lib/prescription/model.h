// SPDX-License-Identifier: Apache-2.0
// What the user wrote, checked: the prescription as values with their places. Units are the file's (mm, nm, degrees).
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lib/gradient_index/leap.h"
#include "lib/medium/medium.h"
#include "lib/numerics/vec3.h"
#include "lib/prescription/diagnostics.h"
#include "lib/prescription/documents.h"
#include "lib/prescription/expression.h"
#include "lib/prescription/parameters.h"
#include "lib/prescription/point_cloud.h"
#include "lib/prescription/sag_grid.h"

namespace sagitta::prescription {

enum class ApertureKind { entrance_pupil_diameter_mm, stop_diameter_mm, image_f_number, object_na };
struct Aperture {
  ApertureKind kind = ApertureKind::entrance_pupil_diameter_mm;
  double value = 0;
  bool is_of_stop = false;  // aim: stop
  Place place;
};

enum class FieldKind { angles_deg, object_heights_mm, visual_angles_deg, paraxial_image_heights_mm, real_image_heights_mm };
// compile() takes the first two kinds; the others become one of these before (trace/fields.h).
struct Fields {
  FieldKind kind = FieldKind::angles_deg;
  struct Point {
    double x = 0, y = 0;
  };
  std::vector<Point> points{{0, 0}};  // the default: on the axis
  FieldKind given_kind = FieldKind::angles_deg;
  std::vector<Point> given_points;  // as they were given, where that was another kind; else empty
  Place place;

  bool are_solved() const { return kind == FieldKind::angles_deg || kind == FieldKind::object_heights_mm; }
};

struct Object {
  double distance_mm = std::numeric_limits<double>::infinity();  // positive: a real object before surface 1
  medium::Medium medium = medium::air();
  Place place;
};

struct Shape {
  std::string kind = "plane";
  Parameters parameters;
  std::shared_ptr<const PointCloud> cloud;  // for shapes made of points
  std::shared_ptr<const SagGrid> grid = nullptr;  // for those made of heights on a grid
  Place place;
};

// A gradient-index medium: its form and what that needs. Its `index` is that of reference_nm; at another wavelength it is larger by as much as the index of the
// medium is that stands beside it.
struct GradientMedium {
  std::string kind;
  Parameters parameters;
  double reference_nm = 0;  // 0: the index is the same at every wavelength
};

struct Surface {
  std::string name;  // "" where none was given
  Shape shape;
  bool stop = false;
  double thickness_mm = 0;
  std::optional<medium::Medium> medium;  // what follows; none: a mirror
  std::optional<GradientMedium> gradient;  // if this follows, then `medium` has its dispersion
  double semi_diameter_mm = std::numeric_limits<double>::infinity();
  double inner_semi_diameter_mm = 0;
  numerics::Vec3<double> decenter_mm{}, tilt_deg{};
  Place place;

  bool is_mirror() const { return !medium.has_value(); }
};

struct Model {
  std::string file;
  std::vector<Document> documents;  // the file and the bases that it extends
  std::string name, source;
  std::vector<ParameterValue> parameters;  // as they were set, in the order of their declaration
  std::string eye;  // "right", "left"; "": not said
  std::vector<double> wavelengths_nm;
  std::optional<double> primary_nm;  // none: the first wavelength
  Aperture aperture;
  Fields fields;
  Object object;
  std::vector<Surface> surfaces;  // the last one is the image surface
  double tolerance_mm = gradient_index::default_tolerance_mm;
  Place place;

  double primary_wavelength_nm() const { return primary_nm ? *primary_nm : wavelengths_nm.front(); }
};

}  // namespace sagitta::prescription
