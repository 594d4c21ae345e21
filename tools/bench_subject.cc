// SPDX-License-Identifier: Apache-2.0
#include "tools/bench_subject.h"

#include <fmt/core.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <memory>
#include <numbers>
#include <random>
#include <vector>

#include "lib/prescription/reader.h"
#include "lib/prescription/search_path.h"
#include "lib/scene/compile.h"
#include "lib/trace/launch.h"
#include "lib/trace/pattern.h"

namespace sagitta::bench {
namespace {

constexpr double radius = 7.72, conic_constant = -0.26, gap = 0.5, beam_radius = 2;

class Random {
 public:
  // Uniform over a disc.
  numerics::Vec3<double> in_disc(double disc_radius) {
    const double r = disc_radius * std::sqrt(next()), angle = 2 * std::numbers::pi * next();
    return {r * std::cos(angle), r * std::sin(angle), 0};
  }

 private:
  double next() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }
  std::mt19937_64 engine_{20240607};
};

// Waves of 5 um, on `count` x `count` nodes over twice the radius, without slopes.
std::shared_ptr<const prescription::SagGrid> cornea_on_a_grid(int count, double data_radius) {
  auto grid = std::make_shared<prescription::SagGrid>();
  grid->count_x = grid->count_y = count;
  grid->first_x = grid->first_y = -data_radius;
  grid->spacing_x = grid->spacing_y = 2 * data_radius / (count - 1);
  grid->has_given_slopes = false;
  for (int j = 0; j < count; ++j)
    for (int i = 0; i < count; ++i) {
      const double x = grid->first_x + i * grid->spacing_x, y = grid->first_y + j * grid->spacing_y;
      grid->nodes.push_back({0.005 * std::sin(x) * std::cos(0.8 * y), 0, 0, 0});
    }
  return grid;
}

prescription::Shape shape_of(const std::string& kind, int point_count, double data_radius) {
  prescription::Shape shape;
  shape.kind = point_count > 0 ? "delaunay" : kind;
  auto& given = shape.parameters;
  given.numbers = {{"radius_mm", radius}, {"conic_constant", conic_constant}, {"normalization_radius_mm", 3},
                   {"radius_x_mm", radius}, {"radius_y_mm", 1.02 * radius}, {"conic_constant_x", conic_constant}, {"conic_constant_y", 1.1 * conic_constant},
                   {"radius_rotation_mm", radius}, {"smoothing_um", 0}, {"max_edge_mm", std::numeric_limits<double>::infinity()}};
  if (kind == "xy_polynomial") {
    for (int term = 3; term <= 27; ++term) given.indexed["coefficients"].push_back({term, (term % 2 == 0 ? 1e-3 : -1e-3) / term});
  } else {
    given.indexed["coefficients"] = {{4, 1e-4}, {6, -1e-5}, {8, 1e-6}, {10, -1e-7}, {12, 1e-8}};
  }
  given.texts = {{"indexing", "osa"}, {"interpolation", kind}};
  // 36 terms of OSA, of the size of a cornea's: falling with the order, signs in turn.
  for (int index = 0; index < 36; ++index) {
    const int order = numerics::osa_term(index).n;
    given.indexed["coefficients_um"].push_back({index, order < 2 ? 0 : (index % 2 == 0 ? 1 : -1) * 2.0 / std::pow(order, 3)});
  }
  if (kind == "grid") shape.grid = cornea_on_a_grid(201, data_radius);
  if (point_count == 0) return shape;
  auto cloud = std::make_shared<prescription::PointCloud>();
  Random random;
  const surface::Conic cornea{1 / radius, conic_constant};
  for (int i = 0; i < point_count; ++i) {
    auto point = random.in_disc(data_radius);
    point.z = cornea.sag(point.x, point.y);
    cloud->points.push_back(point);
  }
  cloud->lines.resize(cloud->points.size());
  shape.cloud = std::move(cloud);
  return shape;
}

void end_unless_right(bool is_right, const prescription::Findings& findings) {
  if (is_right) return;
  for (const auto& finding : findings.all()) fmt::print(stderr, "{}\n", prescription::format(finding));
  std::exit(1);
}

}  // namespace

prescription::Model read_system(const std::string& file) {
  const auto path = prescription::find_file("systems/" + file, ".");
  auto read = prescription::read_prescription(path.value_or("systems/" + file));
  end_unless_right(read.model.has_value(), read.findings);
  return *std::move(read.model);
}

scene::Scene compiled(const prescription::Model& model) {
  auto result = scene::compile(model);
  end_unless_right(result.scene.has_value(), result.findings);
  return *std::move(result.scene);
}

scene::Scene corneas(const std::string& kind, int point_count, std::size_t copies, double data_radius) {
  prescription::Model model;
  model.wavelengths_nm = {550};
  model.aperture.value = 2 * beam_radius;
  prescription::Surface first;
  first.shape = shape_of(kind, point_count, data_radius);
  first.stop = true;
  first.medium = medium::constant("", 1.376);
  model.surfaces = {first, {}};
  model.surfaces.back().medium = medium::air();
  scene::Scene scene = compiled(model);
  const scene::Surface surface = scene.surface(1);
  scene.surfaces.assign(copies, surface);
  for (std::size_t i = 1; i < copies; ++i) scene.surfaces[i].local_from_previous.translation.z = -gap;
  scene.primary.index.clear();
  for (std::size_t i = 0; i <= copies; ++i) scene.primary.index.push_back(i % 2 == 0 ? 1 : 1.376);
  scene.wavelengths.front().index = scene.primary.index;
  return scene;
}

trace::RayBatch beam(const scene::Scene& scene, std::size_t ray_count, bool is_random) {
  auto pupil = trace::pupil_points({}, static_cast<std::int64_t>(ray_count));
  pupil.resize(ray_count);
  trace::RayBatch rays = trace::launch(scene, scene.fields.front(), 1, pupil);
  Random random;
  for (std::size_t i = 0; is_random && i < ray_count; ++i) {
    const auto position = random.in_disc(beam_radius);
    auto direction = random.in_disc(std::sin(3 * std::numbers::pi / 180));
    direction.z = std::sqrt(1 - dot(direction, direction));
    rays.set(i, position, direction, 0);
  }
  return rays;
}

}  // namespace sagitta::bench
