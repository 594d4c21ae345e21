// SPDX-License-Identifier: Apache-2.0
#include "tools/solve_fields.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "lib/analysis/job.h"
#include "lib/scene/compile.h"
#include "lib/trace/fields.h"

namespace sagitta::tools {
namespace {

using prescription::FieldKind;

constexpr double degree = std::numbers::pi / 180;

trace::Fields solve(const scene::Scene& scene, const prescription::Fields& given) {
  std::vector<trace::PupilPoint> points;
  for (const auto& point : given.points) points.push_back({point.x, point.y});
  if (given.kind == FieldKind::real_image_heights_mm) return fields_of_real_images(scene, points);
  if (given.kind == FieldKind::paraxial_image_heights_mm) return fields_of_paraxial_images(scene, points);
  for (trace::PupilPoint& point : points) point = {std::tan(point.x * degree), std::tan(point.y * degree)};
  return fields_of_visual_angles(scene, points);
}

void tell_that_there_is_none(const prescription::Fields& given, const prescription::Fields::Point& point, double primary_nm, prescription::Findings& findings) {
  if (given.kind == FieldKind::real_image_heights_mm)
    findings.error(given.place, fmt::format("no chief ray was found that meets the image surface at [{:g}, {:g}] mm, at {:g} nm", point.x, point.y, primary_nm),
                   "places nearer to the axis may be met; `sagitta rays` shows where the chief rays of angles_deg or object_heights_mm go");
  else if (given.kind == FieldKind::paraxial_image_heights_mm)
    findings.error(given.place, "the paraxial image is at infinity: there are no heights in it", "give another kind of field");
  else
    findings.error(given.place, "the system is afocal and has no nodal point", "give another kind of field");
}

}  // namespace

prescription::Findings solve_fields(prescription::Model& model) {
  const prescription::Fields given = model.fields;
  if (given.are_solved()) return {};
  const bool is_distant = std::isinf(model.object.distance_mm), are_real = given.kind == FieldKind::real_image_heights_mm;
  prescription::Model on_axis = model;
  on_axis.fields = {};
  on_axis.fields.kind = is_distant ? FieldKind::angles_deg : FieldKind::object_heights_mm;
  // chief rays may go anywhere; paraxially nothing but the vertices of clouds counts
  scene::CompileResult compiled = scene::compile(on_axis, are_real ? scene::Beam{} : analysis::beam_of_job());
  if (!compiled.scene) return std::move(compiled.findings);

  prescription::Findings findings;
  prescription::Fields solved{on_axis.fields.kind, {}, given.kind, given.points, given.place};
  const trace::Fields fields = solve(*compiled.scene, given);
  for (std::size_t i = 0; i < fields.size(); ++i) {
    const prescription::Fields::Point& point = given.points[i];
    if (!fields[i]) tell_that_there_is_none(given, point, model.primary_wavelength_nm(), findings);
    else if (fields[i]->is_height) solved.points.push_back({fields[i]->x, fields[i]->y});
    else solved.points.push_back({std::atan(fields[i]->x) / degree, std::atan(fields[i]->y) / degree});
  }
  if (!findings.has_errors()) model.fields = std::move(solved);
  return findings;
}

}  // namespace sagitta::tools
