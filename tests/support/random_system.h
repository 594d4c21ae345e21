// SPDX-License-Identifier: Apache-2.0
// Random prescriptions and rays for laws that hold for all of them: shapes of every formula, lenses and
// mirrors, virtual gaps, decentered and tilted, with apertures. Tame enough that most rays arrive.
#pragma once

#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/point_sets.h"
#include "tests/support/prescriptions.h"
#include "tests/support/sag_grids.h"

namespace sagitta::test {

using tests::Uniform;

struct RandomKinds {
  bool departures = true, mirrors = true, moved = true, apertures = true;
};

inline prescription::Shape shape_of(const char* kind, std::map<std::string, double, std::less<>> numbers, std::vector<std::pair<int, double>> coefficients = {}) {
  prescription::Shape shape;
  shape.kind = kind;
  shape.parameters.numbers = std::move(numbers);
  shape.parameters.indexed["coefficients"] = std::move(coefficients);
  return shape;
}

inline prescription::Shape random_shape(Uniform& u, const RandomKinds& kinds) {
  const double kind = u(), radius = (u() < 0.5 ? -1 : 1) * 8 * std::pow(10, u()), conic_constant = u(-3, 1.2);
  if (kind < 0.15) return {};
  if (kind < 0.55 || !kinds.departures) return conic_shape(radius, conic_constant);
  std::vector<std::pair<int, double>> coefficients;
  if (kind < 0.75) {
    for (int j = 3; j <= 20; ++j)
      if (u() < 0.5) coefficients.push_back({j, u(-3, 3)});
    return zernike_shape(radius, conic_constant, u(6, 12), std::move(coefficients));
  }
  if (kind < 0.78) {
    prescription::Shape shape = shape_of("grid", {{"radius_mm", radius}, {"conic_constant", conic_constant}});
    const double size = u(-0.05, 0.05), turn = u(0, 6.3);
    tests::SagGrid grid = tests::sag_grid({41, 35, 0.8, 0.9, u(-1, 1), u(-1, 1)}, [&](double x, double y) {  // of an extent of 16 mm, waves 6 mm long
      return tests::SagGrid::Node{size * std::sin(x + turn) * std::cos(y), size * std::cos(x + turn) * std::cos(y), -size * std::sin(x + turn) * std::sin(y), -size * std::cos(x + turn) * std::sin(y)};
    });
    shape.grid = std::make_shared<tests::SagGrid>(u() < 0.5 ? std::move(grid) : tests::without_slopes(std::move(grid)));
    return shape;
  }
  const double other_radius = u() < 0.15 ? INFINITY : radius * u(0.7, 1.4), other_constant = u(-3, 1.2);
  if (kind < 0.82) return shape_of("biconic", {{"radius_x_mm", other_radius}, {"radius_y_mm", radius}, {"conic_constant_x", other_constant}, {"conic_constant_y", conic_constant}});
  const bool is_polynomial = kind >= 0.94;
  for (int j = is_polynomial ? 1 : 2; j <= (is_polynomial ? 20 : 8); ++j)  // of 50 um at most, 6 mm from the vertex
    if (u() < 0.5) coefficients.push_back({j, u(-0.05, 0.05) / std::pow(6, is_polynomial ? 0 : j)});
  if (is_polynomial) return shape_of("xy_polynomial", {{"radius_mm", radius}, {"conic_constant", conic_constant}, {"normalization_radius_mm", 6}}, std::move(coefficients));
  if (kind < 0.87) return shape_of("toroid", {{"radius_rotation_mm", other_radius}, {"radius_mm", radius}, {"conic_constant", conic_constant}}, std::move(coefficients));
  return shape_of("asphere", {{"radius_mm", radius}, {"conic_constant", conic_constant}}, std::move(coefficients));
}

inline prescription::Model random_model(Uniform& u, const RandomKinds& kinds = {}) {
  prescription::Model model;
  model.wavelengths_nm = {550};
  model.aperture.value = 4;
  const int surface_count = 2 + static_cast<int>(u() * 6);
  double sense = 1, index = 1;
  for (int i = 0; i <= surface_count; ++i) {
    const bool image = i == surface_count, mirror = kinds.mirrors && !image && u() < 0.15;
    const bool dummy = !mirror && u() < 0.1;
    if (mirror) sense = -sense;
    const double medium = u() < 0.3 ? 1 : u(1, 1.9), gap = u() < 0.1 ? u(-2, 0) : u(0.5, 8);
    if (!mirror && !dummy) index = medium;
    prescription::Surface surface = surface_of(random_shape(u, kinds), image ? 0 : sense * gap, mirror ? 0 : index);
    surface.stop = i == 0;
    if (kinds.moved && u() < 0.3) surface.decenter_mm = {u(-0.5, 0.5), u(-0.5, 0.5), u(-0.2, 0.2)};
    if (kinds.moved && u() < 0.3) {
      const double most = u() < 0.2 ? 30 : 6;
      surface.tilt_deg = {u(-most, most), u(-most, most), u(-180, 180)};
    }
    if (kinds.apertures && u() < 0.15) surface.semi_diameter_mm = u(1.5, 5);
    if (kinds.apertures && u() < 0.05) surface.inner_semi_diameter_mm = u(0.1, 0.6);
    model.surfaces.push_back(std::move(surface));
  }
  return model;
}

// All its lengths times `scale`.
inline void scale_shape(prescription::Shape& shape, double scale) {
  for (auto& [name, value] : shape.parameters.numbers)
    if (!name.starts_with("conic_constant")) value *= scale;
  const bool is_of_powers = shape.kind == "asphere" || shape.kind == "toroid";  // in mm^(1 - power)
  for (auto& [name, list] : shape.parameters.indexed)
    for (auto& [index, value] : list) value *= is_of_powers ? std::pow(scale, 1 - index) : scale;
  if (!shape.grid) return;
  prescription::SagGrid grid = *shape.grid;
  for (double* length : {&grid.first_x, &grid.first_y, &grid.spacing_x, &grid.spacing_y}) *length *= scale;
  for (auto& node : grid.nodes) node.z *= scale, node.d2z_dxdy /= scale;
  shape.grid = std::make_shared<prescription::SagGrid>(std::move(grid));
}

inline std::vector<GlobalRay> random_rays(Uniform& u, int count) {
  std::vector<GlobalRay> rays;
  for (int i = 0; i < count; ++i) {
    const Vec3<double> p{u(-2.5, 2.5), u(-2.5, 2.5), u(-10, -2)}, d{u(-0.15, 0.15), u(-0.15, 0.15), 1};
    rays.push_back({p, numerics::normalized(d)});
  }
  return rays;
}

}  // namespace sagitta::test
