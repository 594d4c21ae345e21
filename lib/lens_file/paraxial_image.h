// SPDX-License-Identifier: Apache-2.0
// The last thickness of a system whose file asks for the image surface to stand in the paraxial image (CODE V's PIM).
//
// The marginal ray (y, u) is followed through the vertex curvatures c and the thicknesses t, at the primary wavelength:
//   n' u' = n u - y (n' - n) c,   y' = y + t u';   a mirror has n' = -n                                                (1)
// from y = 1, u = 0, or from the object point on the axis. The image is where y = 0: t = -y/u' behind the last surface before the image surface.
//
// The thickness that the file gives stands where it agrees with (1) to 1e-6 of itself, as it does in files that the program wrote: it is what that program
// traced. Else, and where the file gives 0, the solved one is taken.
#pragma once

#include <span>
#include <string>

#include "lib/lens_file/lens.h"
#include "lib/lens_file/report.h"
#include "lib/prescription/agf_reader.h"

namespace sagitta::lens_file {

// Nothing where the lens does not ask for it. An error where there is no image: the system is afocal.
void solve_paraxial_image(Lens& lens, const std::string& output, std::span<const prescription::AgfCatalog> catalogs, Report& report);

}  // namespace sagitta::lens_file
