// SPDX-License-Identifier: Apache-2.0
// The paraxial transfer through a gradient-index medium along its z axis. With z(t) the axial ray, rays beside it obey
//   y'' = (1/2) (d^2 n^2/dy^2) y,   V = n dy/ds = y',   z'' = n dn/dz                                               (1)
// (' = d/dt, dt = ds/n: leap.h), linear in (y, V): two of them give the matrix. A slope of n^2 across the axis, which bends the axial ray itself, plays no part,
// as decenters of surfaces play none.
//
// Source: Sands, J. Opt. Soc. Am. 60, 1436 (1970).
#pragma once

#include "lib/gradient_index/forms.h"

namespace sagitta::gradient_index {

// (y, V) -> (y_y y + y_v V, v_y y + v_v V)
struct ParaxialTransfer {
  double y_y, y_v, v_y, v_v;
  double index_start, index_end;  // on the axis
};

// From z on, by `thickness`; `heading` is 1 for light that travels toward +z, else -1. All NaN where the axis leaves the medium.
ParaxialTransfer paraxial_transfer(const Form& form, double z, double thickness, double heading);

}  // namespace sagitta::gradient_index
