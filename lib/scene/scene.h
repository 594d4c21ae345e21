// SPDX-License-Identifier: Apache-2.0
// The compiled scene: flat numbers in mm and radians, made from a prescription for one job. No YAML, no name, no
// dispersion formula and no triangulation exists from here on.
//
// Surfaces are numbered from 1; surfaces[i] is number i + 1. The last one is the image surface. Gap 0 is the object
// space, gap i lies behind surface i.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <vector>

#include "lib/gradient_index/forms.h"
#include "lib/gradient_index/leap.h"
#include "lib/numerics/arena.h"
#include "lib/numerics/rigid_transform.h"
#include "lib/surface/shapes.h"

namespace sagitta::scene {

using numerics::Vec3;

struct Surface {
  surface::Shape shape;
  bool mirror = false;
  bool image = false;                                   // rays end here, undeflected
  numerics::RigidTransform<double> local_from_previous;  // from the local frame of the surface before (of the first: global)
  bool centred = true;                                  // local_from_previous is a shift along z only
  numerics::RigidTransform<double> global_from_local;
  double axis_z = 0;                                    // global z of its vertex before decenter
  double vertex_curvature = 0, vertex_curvature_x = 0;  // 1/mm, of the y-z section, of the x-z section
  double semi_diameter = std::numeric_limits<double>::infinity();
  double inner_semi_diameter = 0;

  bool has_apertures() const { return std::isfinite(semi_diameter) || inner_semi_diameter > 0; }
  // A plane in one medium that stops no ray, but for those parallel to it: a dummy.
  bool does_nothing(double index_before, double index_after) const {
    return std::holds_alternative<surface::Plane>(shape) && index_before == index_after && !mirror && !image && !has_apertures();
  }
};

// The medium of a gap in which rays are curved. Behind a mirror it is the one before it.
struct GradientGap {
  gradient_index::Form form;
  int follows = 0;                                         // the surface whose frame its places are in
  numerics::RigidTransform<double> medium_from_surface{};  // from the frame of the surface before the gap
  double axial_shift = 0;                                  // what z is larger by in the medium's frame, both frames undisturbed
};

// The indices of all gaps at one wavelength.
struct Wavelength {
  double wavelength_um = 0;
  std::vector<double> index;            // index[i] of gap i, positive; NaN in a gradient, which has more than one
  std::map<int, GradientGap> gradients{};  // by gap

  const GradientGap* gradient(int gap) const {
    const auto found = gradients.find(gap);
    return found == gradients.end() ? nullptr : &found->second;
  }
  bool has_gradient_at(int surface_number) const { return gradients.contains(surface_number - 1) || gradients.contains(surface_number); }
};

struct Object {
  double z = -std::numeric_limits<double>::infinity();  // of the object plane, global
  bool at_infinity() const { return std::isinf(z); }
};

// A field: the tangents of the chief ray's angles in object space, or a height in the object plane.
struct Field {
  bool is_height = false;
  double x = 0, y = 0;  // tangents, or mm
};

// How large the beam is, in the form the launch needs.
struct LaunchPupil {
  bool telecentric = false;   // the entrance pupil is at infinity: chief rays are parallel to the axis
  double z = 0;               // of the entrance pupil, global
  double semi_diameter = 0;   // of the entrance pupil
  double edge_tangent = 0;    // telecentric only: tangent of the angle of the rim's rays
  bool is_of_stop = false;    // pupil points are those of the stop, and rays are aimed at them
  double stop_semi_diameter = 0;  // of the stop as that beam has it paraxially
};

struct Scene {
  std::vector<Surface> surfaces;
  std::vector<Wavelength> wavelengths;
  Wavelength primary;
  std::vector<Field> fields;
  Object object;
  LaunchPupil pupil;
  int stop = 1;  // number of the stop surface
  gradient_index::Tolerance tolerance{};  // of rays in gradients
  numerics::Arena arena;

  int surface_count() const { return static_cast<int>(surfaces.size()); }
  // Whether its x-z section is another than its y-z section, by more than the rounding of sums of terms.
  bool is_astigmatic() const {
    return std::any_of(surfaces.begin(), surfaces.end(), [](const Surface& one) {
      return !one.image && std::abs(one.vertex_curvature_x - one.vertex_curvature) > 1e-13 * std::max(std::abs(one.vertex_curvature_x), std::abs(one.vertex_curvature));
    });
  }
  const Surface& surface(int number) const { return surfaces[static_cast<std::size_t>(number - 1)]; }
};

}  // namespace sagitta::scene
