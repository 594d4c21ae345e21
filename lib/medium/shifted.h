// SPDX-License-Identifier: Apache-2.0
// A medium that disperses as another one does, from an index of its own at one wavelength:
//   n(L) = n_ref + (m(L) - m(L_ref)),   m the other medium                                                     (1)
// and in its range. Equal bits to n_ref at L_ref.
//
// An index that is added to all four nodes of Herzberger's interpolation (navarro.h) adds itself times the sum of the weights, which differs
// from 1 by less than 2e-7 from 365 to 1014 nm: (1) says the same to 2e-7 of what is added.
#pragma once

#include "lib/medium/medium.h"

namespace sagitta::medium {

Medium shifted(const Medium& other, double index, double reference_um);

}  // namespace sagitta::medium
