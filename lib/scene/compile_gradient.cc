// SPDX-License-Identifier: Apache-2.0
#include "lib/scene/compile_gradient.h"

#include <fmt/format.h>

#include <cmath>

#include "lib/gradient_index/paraxial.h"
#include "lib/medium/shifted.h"

namespace sagitta::scene {
namespace {

using prescription::Findings;
using prescription::Model;

gradient_index::Form form_of(const prescription::Surface& given, double wavelength_um, numerics::Arena& arena) {
  gradient_index::Form result;
  gradient_index::for_each_form([&]<class Form>(Form) {
    if (Form::kind == given.gradient->kind) result = Form::from(given.gradient->parameters, arena);
  });
  if (const double nm = given.gradient->reference_nm; nm > 0)
    std::visit([&](auto& form) { form.index = medium::shifted(*given.medium, form.index, nm / 1000).index(wavelength_um); }, result);
  return result;
}

void compile_gap(const Model& model, int number, double heading, Scene& scene, Wavelength& wavelength, Findings& findings) {
  const prescription::Surface& given = model.surfaces[static_cast<std::size_t>(number - 1)];
  const Surface& surface = scene.surface(number);
  GradientGap gap{.form = {}, .follows = number};
  if (given.gradient) {
    gap.form = form_of(given, wavelength.wavelength_um, scene.arena);
  } else {
    const GradientGap* before = given.is_mirror() ? wavelength.gradient(number - 1) : nullptr;
    if (!before) return;
    const Surface& followed = scene.surface(before->follows);
    gap = *before;
    gap.medium_from_surface = followed.global_from_local.inverse() * surface.global_from_local;
    gap.axial_shift = surface.axis_z - followed.axis_z;
  }
  const double thickness = scene.surface(number + 1).axis_z - surface.axis_z;
  if (!(paraxial_transfer(gap.form, gap.axial_shift, thickness, heading).index_end > 0))
    findings.error(given.place, fmt::format("the gradient-index medium has no index from {:g} to {:g} all along the axis at {:g} nm", gradient_index::indices.low,
                                            gradient_index::indices.high, wavelength.wavelength_um * 1000));
  wavelength.gradients.emplace(number, std::move(gap));
}

}  // namespace

void compile_gradients(const Model& model, Scene& scene, Findings& findings) {
  const auto compile_at = [&](Wavelength& wavelength) {
    double heading = 1;
    for (int number = 1; number < scene.surface_count(); ++number) {
      if (model.surfaces[static_cast<std::size_t>(number - 1)].is_mirror()) heading = -heading;
      compile_gap(model, number, heading, scene, wavelength, findings);
    }
  };
  scene.tolerance.mm = model.tolerance_mm;
  for (Wavelength& wavelength : scene.wavelengths) compile_at(wavelength);
  if (!findings.has_errors()) compile_at(scene.primary);
}

}  // namespace sagitta::scene
