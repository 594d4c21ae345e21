// SPDX-License-Identifier: Apache-2.0
#include "lib/lens_file/code_v_surface_internal.h"

#include <cmath>

#include "lib/lens_file/numbers.h"

namespace sagitta::lens_file {

Surface surface_of(const CodeVSurface& given, Real unit_mm, Report& report) {
  using Decenter = CodeVSurface::Decenter;
  Surface surface;
  surface.place = given.place, surface.name = given.name, surface.stop = given.stop, surface.medium = given.medium;
  if (given.mirror_place) {
    if (given.medium.kind != Medium::Kind::air) report.left_out(given.medium.place, "the glass of a mirror", "light stays in the medium that it comes in");
    surface.medium = {Medium::Kind::mirror, {}, 1, 0, {}, *given.mirror_place};
  }
  surface.curvature = given.curvature / unit_mm;
  surface.thickness = given.thickness * unit_mm;
  const double radius = given.radius ? static_cast<double>(*given.radius * unit_mm) : radius_of(surface.curvature, given.curvature_rounding / unit_mm);
  Indexed coefficients;
  for (const auto& [k, a] : given.powers)
    if (const double one = kept(a * power(unit_mm, 1 - k)); one != 0) coefficients[k] = one;
  if (std::isfinite(radius) || !coefficients.empty()) {
    surface.shape = {coefficients.empty() ? "conic" : "asphere", {{"radius_mm", radius}}};
    if (given.conic != 0) surface.shape.items.push_back({"conic_constant", static_cast<double>(given.conic)});
    if (!coefficients.empty()) surface.shape.items.push_back({"coefficients", coefficients});
  }
  if (given.semi_diameter != 0 && !(given.inner_semi_diameter < given.semi_diameter)) report.broken(given.circle_place, "CIR: the obscuration is not smaller than the clear aperture");
  if (given.semi_diameter != 0) surface.semi_diameter = static_cast<double>(given.semi_diameter * unit_mm);
  surface.inner_semi_diameter = static_cast<double>(given.inner_semi_diameter * unit_mm);
  if (given.decenter_place.line == 0) return surface;
  const Move move{unit_mm * given.shift, {-given.tilt.x, -given.tilt.y, given.tilt.z}};  // ADE and BDE are left-handed
  switch (given.decenter) {
    case Decenter::basic: surface.before.push_back(move); break;
    case Decenter::and_return: surface.own.push_back(move); break;
    case Decenter::reverse: surface.after.push_back(move.inverse()); break;
    case Decenter::bend:
      if (given.tilt.x != 0 && given.tilt.y != 0) report.left_out(given.decenter_place, "BEN about two axes, whose turn about the third is not known");
      surface.before.push_back(move);
      surface.after.push_back({{}, move.tilt_deg});
  }
  return surface;
}

}  // namespace sagitta::lens_file
