// SPDX-License-Identifier: Apache-2.0
// One surface of a system made from one point cloud in several ways: what `sagitta compare --surface` compares.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lib/output/comparison.h"
#include "lib/prescription/model.h"
#include "lib/scene/scene.h"
#include "lib/trace/pattern.h"

namespace sagitta::tools {

// "delaunay" (interpolation c1), "delaunay:INTERPOLATION" or "zernike:TERMS".
struct VariantKind {
  std::string text;           // as given
  std::string interpolation;  // of points; "": a Zernike surface is fitted
  int terms = 0;
};
struct ParsedVariant {
  std::optional<VariantKind> kind;
  std::string fault;  // why there is none
};
ParsedVariant parse_variant(std::string text);

struct VariantRequest {
  std::string surface;               // its name in the system
  std::string points, format, axes;  // as in the prescription
  std::vector<VariantKind> kinds;
  std::optional<double> radius_mm;   // of the Zernike fits
  std::optional<double> smoothing_um, max_edge_mm;  // of the points as they are traced
};

// A system to compare, under a name of its own.
struct ComparedModel {
  std::string name;
  prescription::Model model;
  std::optional<output::FitQuality> fit;
};

// Where the beam of the system meets its surface `number` (traced, all fields and wavelengths): the greatest distance from
// the surface's axis, mm. None where no ray gets there.
std::optional<double> footprint_radius(const prescription::Model& model, int number);

// Of the rays of a field and wavelength that reach the surface `number`, the share that meets it within `radius_mm` of its
// axis; NaN where none reaches it.
double share_within(const scene::Scene& scene, const scene::Field& field, const scene::Wavelength& wavelength,
                    std::span<const trace::PupilPoint> pupil, int number, double radius_mm);

// What is not asked for of the tracing of the points (smoothing, longest edge, radial functions) is as in the points that they
// stand for, where the surface is made of points already. The Zernike fits are to the points as measured, over the circle of `radius_mm`, or else over the beam's footprint on the system's own surface and
// 5 % more, as far as the data reach. Empty, after printing what is wrong, where one cannot be made.
std::vector<ComparedModel> make_variants(const prescription::Model& system, const VariantRequest& request);

}  // namespace sagitta::tools
