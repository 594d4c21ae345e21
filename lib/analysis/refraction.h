// SPDX-License-Identifier: Apache-2.0
// The refraction of an eye: the power of the thin lens that would make a distant object sharp on the retina, for one field and wavelength. (Where the
// object of the scene is near, its own vergence is taken out.)
//
// The eye at its entrance pupil wants light of one vergence, different in different meridians. With (u, v) across the chief ray at the pupil's
// centre, W(u, v) the wavefront error and V the vergence of the light that arrives (0 from infinity, -1/s from a point at s before the pupil),
//   P = V - H,   H_ij = d2W/du_i du_j,        W > 0 and H > 0: the eye is myopic, P < 0                            (1)
// a symmetric 2 x 2 matrix in D, the same as the power vector
//   M = (P_uu + P_vv)/2,   J0 = (P_uu - P_vv)/2,   J45 = P_uv                                                      (2)
// and the prescription in minus cylinders
//   cylinder = -2 sqrt(J0^2 + J45^2),   sphere = M - cylinder/2,   axis = atan2(J45, J0)/2 in (0, 180] deg          (3)
// Moved by a along the chief ray, against the light, to the cornea's vertex plane or a spectacle plane, in a medium of index n,
//   P' = P (1 + a P/n)^-1.                                                                                          (4)
//
// H comes four ways:
//   least squares   from the Zernike terms of order 2 of the wavefront over the entrance pupil, of radius r (never the exit pupil's: on the
//                   biconic test eye that makes -1.71 D of -1.40 D): H = (4 sqrt3 c20 +- 2 sqrt6 c22)/r^2, 2 sqrt6 c2-2/r^2. It balances
//                   aberrations of higher order against defocus, as the others do not
//   at the centre   the curvatures of all these terms at the centre of the pupil: a term of m = 0 or 2 has (-1)^(k-1) k(k+1)/(1 + m/2) rho^2, k = n/2,
//                   so that M = (-4 sqrt3 c20 + 12 sqrt5 c40 - 24 sqrt7 c60 + ...)/r^2. As good as the terms are
//   paraxial        W's own curvatures at the pupil's centre, from 17 rays within a tenth of the pupil:
//                   W'' = (16 E(h) - E(2h))/(6 h^2) + O(h^4),   E the even part of W                                 (5)
//                   and again, three passes in all, with light of vergence P, in which W is flat: then it does not matter how well the pupils are each
//                   other's image
//   far point       by places alone, no path: rays near the chief ray land at r = B p + C s, p the place in the pupil and s the slope
//                   they start with; the vergence that brings all p to r = 0 is s = -C^-1 B p, so P = n C^-1 B       (6)
//
// Frame: OSA's, for the report of an eye: examiner facing the patient, u to the examiner's right, v up, axis anticlockwise from u. In the tracer's
// frame, z into the eye and y up, x is to the examiner's left: J45 changes sign.
//
// Error: (5) and (6) agree to some 1e-6 D, 4e-6 at 60 degrees, 1e-3 at 80: the differences' sixth order. Rounding adds 4e-12 D mm^2 over the pupil's area,
// some 1e-12 D for 2 mm; where it would be 1e-3 D (a pupil of some micrometres) there is none. Off axis, and where the x and the y section have other pupils, the
// exit pupil that W is measured in is not where the entrance pupil is seen along the chief ray; that costs the first two some H^2 of the distance between them:
// .001 D of an eye of 4 D at 30 degrees, .03 D at 60, and nearly all at 80 (-70 for -39 D in Navarro's eye). A near object has its part in H.
//
// Source: Thibos, Wheeler and Horner, Optom. Vis. Sci. 74, 367 (1997), for (2) and (3); Keating, Am. J. Optom. Physiol. Opt. 58, 810 (1981), for matrices
// and (4); ANSI Z80.28-2017 for the frame.
#pragma once

#include <optional>
#include <string>

#include "lib/analysis/wavefront.h"

namespace sagitta::analysis {

// Symmetric, in D, in the OSA frame.
struct Power {
  double uu = 0, uv = 0, vv = 0;

  double M() const { return (uu + vv) / 2; }
  double J0() const { return (uu - vv) / 2; }
  double J45() const { return uv; }
};

struct Spectacles {
  double sphere = 0, cylinder = 0;  // D
  double axis_deg = 0;              // 180 where there is no cylinder
};
Spectacles spectacles(const Power& power);  // (3)

// (4), a in metres.
Power moved(const Power& power, double a, double index);

struct Refraction {
  std::optional<Power> least_squares, at_centre;  // none where the wavefront's samples do not determine its Zernike terms
  Power paraxial, far_point;
};

struct RefractionRequest {
  double vertex_distance = 0;  // mm: the plane is as far before the first vertex; 0 the cornea's own
  WavefrontRequest wavefront;  // for least squares; its indexing is OSA's
};

struct RefractionResult {
  std::optional<Refraction> refraction;
  std::string reason;  // why there is none
};

RefractionResult refraction(const scene::Scene& scene, const scene::Wavelength& wavelength, const scene::Field& field, const RefractionRequest& request);

}  // namespace sagitta::analysis
