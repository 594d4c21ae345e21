// SPDX-License-Identifier: Apache-2.0
// From frames that are moved and turned one after the other (Zemax' coordinate breaks, CODE V's decentered surfaces) to a prescription's: a straight axis, and
// surfaces that are each moved off it and turned, after which it goes on undisturbed.
//
// The frame of surface i is F_i = M_1 M_2 ... M_k, all moves up to it, thicknesses among them; it stands at F_i own. The axis of the prescription
// runs along z of the object's frame, and the thicknesses on it are those of the file, as if no move turned it: so paraxial optics, which looks along the axis
// of the light, is that of the unfolded system. With z_i their sum up to surface i, and R, t rotation and origin of F_i own,
//
//   decenter = t - (0, 0, z_i),   R = Rx(a) Ry(b) Rz(g):                                                              (1)
//   b = atan2(R_xz, hypot(R_xx, R_xy)),   a = atan2(-R_yz, R_zz),   g = atan2(-R_xy, R_xx)                               (2)
//   if R_xx = R_xy = 0: g = 0, a = atan2(R_zy, R_yy)                                                                 (3)
//
// Of the two triples of angles that turn alike, (a, b, g) and (a + 180, 180 - b, g + 180), the one of the smaller sum of sizes is taken.
//
// Numbers are computed as Real and rounded to the shortest decimal number within what the arithmetic may be off by: so moves that cancel leave 0, and moves of
// one surface come out as they stood in the file. Bound of the error of t: 16 u (number of moves + 1) sum of lengths, of an angle 16 u (number + 1) 180 degrees
// (u: half an epsilon of Real; each move multiplies by a matrix whose entries are off by at most 4 u, and sums three products), and a double's own rounding.
#pragma once

#include <vector>

#include "lib/lens_file/lens.h"
#include "lib/numerics/rigid_transform.h"

namespace sagitta::lens_file {

struct Placed {
  numerics::Vec3<double> decenter_mm{}, tilt_deg{};
  bool is_moved() const { return decenter_mm != numerics::Vec3<double>{} || tilt_deg != numerics::Vec3<double>{}; }
};

// One for each surface.
std::vector<Placed> place(const Lens& lens);

// p -> M p, from the new frame to the old one.
numerics::RigidTransform<Real> transform_of(const Move& move);

}  // namespace sagitta::lens_file
