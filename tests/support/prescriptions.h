// SPDX-License-Identifier: Apache-2.0
// Scenes for tests: compiled from a prescription given as text, or from a model built in code.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "lib/prescription/reader.h"
#include "lib/scene/compile.h"
#include "lib/trace/launch.h"
#include "lib/trace/trace.h"
#include "tests/support/program.h"

namespace sagitta::test {

using numerics::Vec3;

// What compile says of a prescription that reads without an error.
inline scene::CompileResult compile_text(const std::string& yaml) {
  const Folder folder;
  const prescription::ReadResult read = prescription::read_prescription(folder.file("system.yaml", yaml));
  for (const auto& finding : read.findings.all()) EXPECT_NE(finding.severity, prescription::Severity::error) << format(finding);
  return read.model ? scene::compile(*read.model) : scene::CompileResult{};
}

// "sagitta: 1", a wavelength of 550 nm, the given lines and surfaces.
inline std::string prescription_of(const std::string& surfaces, const std::string& aperture = "entrance_pupil_diameter_mm: 4",
                                   const std::string& more = {}) {
  return "sagitta: 1\nwavelengths_nm: [550]\naperture: {" + aperture + "}\n" + more + "surfaces:\n" + surfaces;
}

struct CompiledScene {
  scene::Scene scene;
  scene::FirstOrder first_order;
  const scene::Wavelength& wavelength() const { return scene.primary; }
};

inline CompiledScene checked(scene::CompileResult result) {
  for (const auto& finding : result.findings.all()) ADD_FAILURE() << format(finding);
  if (!result.scene) return {};
  return {std::move(*result.scene), result.first_order};
}
inline CompiledScene scene_of(const std::string& surfaces, const std::string& aperture = "entrance_pupil_diameter_mm: 4",
                              const std::string& more = {}) {
  return checked(compile_text(prescription_of(surfaces, aperture, more)));
}

inline prescription::Shape conic_shape(double radius, double conic_constant) {
  prescription::Shape shape;
  shape.kind = "conic";
  shape.parameters.numbers = {{"radius_mm", radius}, {"conic_constant", conic_constant}};
  return shape;
}
inline prescription::Shape zernike_shape(double radius, double conic_constant, double normalization_radius,
                                         std::vector<std::pair<int, double>> osa_coefficients_um) {
  prescription::Shape shape = conic_shape(radius, conic_constant);
  shape.kind = "zernike";
  shape.parameters.numbers["normalization_radius_mm"] = normalization_radius;
  shape.parameters.texts["indexing"] = "osa";
  shape.parameters.indexed["coefficients_um"] = std::move(osa_coefficients_um);
  return shape;
}

// Index 0 makes a mirror.
inline prescription::Surface surface_of(prescription::Shape shape, double thickness, double index) {
  prescription::Surface surface;
  surface.shape = std::move(shape);
  surface.thickness_mm = thickness;
  if (index != 0) surface.medium = medium::constant("test", index);
  return surface;
}

// A ray in the global frame.
struct GlobalRay {
  Vec3<double> p, d;
};

inline trace::RayBatch batch_of(const std::vector<GlobalRay>& rays) {
  trace::RayBatch batch(rays.size());
  for (std::size_t i = 0; i < rays.size(); ++i) batch.set(i, rays[i].p, rays[i].d, 0);
  return batch;
}

// The surface whose frame ray i is in after a whole trace.
inline int frame_of(const scene::Scene& scene, const trace::RayBatch& rays, std::size_t i) {
  return rays.ended[i] == 0 ? scene.surface_count() : rays.ended_at(i);
}
inline GlobalRay global_ray(const scene::Scene& scene, const trace::RayBatch& rays, std::size_t i) {
  const int frame = frame_of(scene, rays, i);
  return {global_position(scene, frame, rays, i), global_direction(scene, frame, rays, i)};
}

}  // namespace sagitta::test
