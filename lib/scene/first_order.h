// SPDX-License-Identifier: Apache-2.0
// First-order (paraxial) properties of a scene, in the y-z section (or, for reports, the x-z section) and along the undisturbed axis: decenters and
// tilts of surfaces play no part.
//
// The state of a paraxial ray is (y, V), V = n u the optical direction; n is negative in gaps that light crosses toward
// -z (after an odd number of mirrors), as are their thicknesses t. With c the vertex curvature:
//   refraction and reflection  V' = V - (n' - n) c y,       transfer  y' = y + (t/n) V                              (1)
// A gap with a gradient-index medium has a matrix of its own (gradient_index/paraxial.h). Where the image surface ends such a gap, the image space is taken to go on with
// the index there on the axis.
// The product from the first vertex to behind the last acting surface is the matrix [a b; -P d], P the power:
//   effective focal length 1/P,   rear focal length n'/P,   front focal length -n/P
//   F' = last vertex + n' a/P,   F = first vertex - n d/P                                                            (2)
//   H' = F' - n'/P,   H = F + n/P,   N' = F' - n/P,   N = F + n'/P                                                   (3)
// The image of a collimated bundle whose direction has the tangent t, or of an object point at the height t, lies at the height s t; V and V' are of the ray from the
// axial object point:
//   s = n/P (object at infinity),   s = V/V' (the lateral magnification)                                             (4)
// Pupils: the stop's centre imaged backwards through the surfaces before it, and forwards through the others (its own
// refraction, if it has any, is behind it).
// A quantity that does not exist (afocal system, pupil at infinity) is NaN here and null in outputs.
//
// Source: Welford, Aberrations of Optical Systems (1986), chapter 3; Hopkins' sign conventions.
#pragma once

#include "lib/scene/scene.h"

namespace sagitta::scene {

struct Pupil {
  double z = 0;              // global; infinite: telecentric
  double semi_diameter = 0;  // of the paraxial image of the stop
  double magnification = 0;  // semi_diameter per semi-diameter of the stop, signed
};

struct FirstOrder {
  double power = 0;  // 1/mm
  double effective_focal_length, front_focal_length, rear_focal_length, back_focal_length;  // mm
  double front_focal_point, rear_focal_point, front_principal_point, rear_principal_point, front_nodal_point,
      rear_nodal_point;    // global z
  Pupil entrance_pupil, exit_pupil;
  double image_scale;      // (4), mm or mm per mm; infinite if the image is afocal
  double image_z;          // of the paraxial image of the axial object point, global; infinite if the image is afocal
};

enum class Section { x, y };

// `entrance_pupil_semi_diameter` may be NaN: then the pupils' semi-diameters are.
FirstOrder first_order(const Scene& scene, const Wavelength& wavelength, double entrance_pupil_semi_diameter, Section section = Section::y);

// Height of the paraxial marginal ray (axial object point, rim of the entrance pupil) at a surface: the beam's radius there.
double marginal_height(const Scene& scene, const Wavelength& wavelength, const Pupil& entrance_pupil, int surface_number);
// The same of the ray from the axial object point that starts with this tangent to the axis; finite object.
double height_from_object(const Scene& scene, const Wavelength& wavelength, double tangent, int surface_number);

}  // namespace sagitta::scene
