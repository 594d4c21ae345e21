// SPDX-License-Identifier: Apache-2.0
#include "lib/lens_file/paraxial_image.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lib/lens_file/glasses.h"
#include "lib/lens_file/numbers.h"

namespace sagitta::lens_file {

void solve_paraxial_image(Lens& lens, const std::string& output, std::span<const prescription::AgfCatalog> catalogs, Report& report) {
  if (!lens.solves_image || lens.surfaces.size() < 2) return;
  const double wavelength_nm = lens.wavelengths_nm[lens.primary];
  const auto index = [&](const Medium& medium) { return Real(index_of(medium, wavelength_nm, output, catalogs)); };
  Real n = index(lens.object_medium), y = 1, nu = 0;
  if (std::isfinite(lens.object_distance)) y = lens.object_distance, nu = n;
  for (std::size_t i = 0; i + 1 < lens.surfaces.size(); ++i) {
    const Surface& surface = lens.surfaces[i];
    const bool is_mirror = surface.medium.kind == Medium::Kind::mirror;
    const Real behind = is_mirror ? -n : std::copysign(index(surface.medium), n);
    nu -= y * (behind - n) * surface.curvature;  // (1)
    n = behind;
    if (i + 2 < lens.surfaces.size()) y += lens.axial_thickness(i) * nu / n;
  }
  Surface& last = lens.surfaces[lens.surfaces.size() - 2];
  const Real solved = -y * n / nu, given = last.thickness - lens.image_shift;
  if (!std::isfinite(solved) || !(std::abs(solved) < 1e12L)) {
    report.broken(*lens.solves_image, "there is no paraxial image for the image surface to stand in", "give the last thickness, without a solve");
    return;
  }
  if (std::abs(solved - given) <= 1e-6L * std::abs(solved)) return;
  if (given != 0)
    report.warning(*lens.solves_image, fmt::format("the last thickness, {} mm, is not the one to the paraxial image; it is solved: {} mm", number_text(static_cast<double>(given)),
                                                   number_text(static_cast<double>(solved))));
  lens.remarks.push_back(lens.image_shift == 0 ? "The last thickness is solved: it reaches the paraxial image at the primary wavelength."
                                               : fmt::format("The last thickness is solved: it reaches the paraxial image at the primary wavelength, and the defocus of {} mm beyond it.",
                                                             number_text(static_cast<double>(lens.image_shift))));
  last.thickness = solved + lens.image_shift;
}

}  // namespace sagitta::lens_file
