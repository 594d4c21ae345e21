// SPDX-License-Identifier: Apache-2.0
#include "lib/scene/compile.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lib/scene/cloud_fit.h"
#include "lib/scene/compile_cloud.h"
#include "lib/scene/compile_gradient.h"
#include "lib/scene/compile_grid.h"
#include "lib/scene/triangulate.h"

namespace sagitta::scene {
namespace {

using prescription::Findings;
using prescription::Model;

double radians(double degrees) { return degrees * (std::numbers::pi / 180); }

Wavelength compile_wavelength(const Model& model, double wavelength_nm, Findings& findings) {
  const double um = wavelength_nm / 1000;
  Wavelength result{um, {model.object.medium.index(um)}};
  for (const auto& surface : model.surfaces) {
    // Behind a mirror is what was before it; behind the image surface nothing is traced.
    const bool same = surface.is_mirror() || &surface == &model.surfaces.back();
    const bool is_gradient = same ? std::isnan(result.index.back()) : surface.gradient.has_value();
    const double index = is_gradient ? std::numeric_limits<double>::quiet_NaN() : same ? result.index.back() : surface.medium->index(um);
    if (!is_gradient && !(index > 0 && std::isfinite(index)))
      findings.error(surface.place, fmt::format("the medium has no index at {:g} nm", wavelength_nm));
    result.index.push_back(index);
  }
  return result;
}

// A shape from its checked parameters, by the closed list of kinds.
surface::Shape compile_shape(const prescription::Shape& given, numerics::Arena& arena) {
  surface::Shape result;
  surface::for_each_shape_kind([&]<class S>(S) {
    if constexpr (requires { S::from(given.parameters, arena); }) {
      if (S::kind == given.kind) result = S::from(given.parameters, arena);
    }
  });
  return result;
}

// How many gaps have a medium whose index depends on the wavelength.
int count_dispersive_gaps(const Model& model) {
  int count = !model.object.medium.dispersion->is_constant();
  for (const prescription::Surface& surface : model.surfaces)
    count += !surface.is_mirror() && &surface != &model.surfaces.back() && !surface.medium->dispersion->is_constant();
  return count;
}

// Frames: the axis is straight; a surface's vertex stands on it, is moved by decenter, then turned about its new axes.
void place_surfaces(const Model& model, Scene& scene) {
  double axis_z = 0;
  numerics::RigidTransform<double> before;  // global_from_local of the surface before, with z relative to its vertex
  for (std::size_t i = 0; i < model.surfaces.size(); ++i) {
    const prescription::Surface& given = model.surfaces[i];
    Surface& surface = scene.surfaces[i];
    const double gap = i == 0 ? 0 : model.surfaces[i - 1].thickness_mm;
    axis_z += gap;
    surface.axis_z = axis_z;
    const numerics::RigidTransform<double> axis_from_local{
        numerics::rotation_about_new_axes(radians(given.tilt_deg.x), radians(given.tilt_deg.y), radians(given.tilt_deg.z)),
        given.decenter_mm};
    // Through the axis points of both surfaces, so that a short gap keeps its digits far from the origin.
    const numerics::RigidTransform<double> shift{{}, {0, 0, -gap}};
    surface.local_from_previous = axis_from_local.inverse() * (shift * before);
    surface.centred = surface.local_from_previous.rotation == numerics::Rotation<double>{} &&
                      surface.local_from_previous.translation.x == 0 && surface.local_from_previous.translation.y == 0;
    surface.global_from_local = numerics::RigidTransform<double>{{}, {0, 0, axis_z}} * axis_from_local;
    before = axis_from_local;
  }
}

std::vector<Field> compile_fields(const prescription::Fields& given) {
  std::vector<Field> result;
  const bool heights = given.kind == prescription::FieldKind::object_heights_mm;
  for (const auto& point : given.points)
    result.push_back(heights ? Field{true, point.x, point.y}
                             : Field{false, std::tan(radians(point.x)), std::tan(radians(point.y))});
  return result;
}

// The beam from the aperture, whichever way it is given.
LaunchPupil compile_pupil(const Model& model, const Scene& scene, const FirstOrder& paraxial, Findings& findings) {
  using prescription::ApertureKind;
  const Pupil& entrance = paraxial.entrance_pupil;
  const double value = model.aperture.value;
  LaunchPupil result;
  result.telecentric = !(std::abs(entrance.z) <= 1e12);
  result.z = entrance.z;
  switch (model.aperture.kind) {
    case ApertureKind::entrance_pupil_diameter_mm: result.semi_diameter = value / 2; break;
    case ApertureKind::stop_diameter_mm: result.semi_diameter = value / 2 * std::abs(entrance.magnification); break;
    case ApertureKind::image_f_number:
      result.semi_diameter = std::abs(paraxial.effective_focal_length) / value / 2;
      if (!std::isfinite(result.semi_diameter))
        findings.error(model.aperture.place, "image_f_number: the system is afocal and has no focal length",
                       "give entrance_pupil_diameter_mm");
      break;
    case ApertureKind::object_na: {
      const double sine = value / scene.primary.index[0];
      result.edge_tangent = sine / std::sqrt((1 - sine) * (1 + sine));
      result.semi_diameter = std::abs(entrance.z - scene.object.z) * result.edge_tangent;
      break;
    }
  }
  result.is_of_stop = model.aperture.is_of_stop;
  if (model.aperture.kind == ApertureKind::stop_diameter_mm) result.stop_semi_diameter = value / 2;
  else if (result.telecentric) result.stop_semi_diameter = scene.object.at_infinity() ? 0 : height_from_object(scene, scene.primary, result.edge_tangent, scene.stop);
  else result.stop_semi_diameter = std::abs(result.semi_diameter / entrance.magnification);
  if (!findings.has_errors() && !result.telecentric && !std::isfinite(result.semi_diameter))
    findings.error(model.aperture.place, "the entrance pupil has no finite size");
  const bool by_na_and_height = model.aperture.kind == ApertureKind::object_na &&
                                model.fields.kind == prescription::FieldKind::object_heights_mm;
  if (result.telecentric && !by_na_and_height)
    findings.error(model.aperture.place, "the entrance pupil is at infinity: the stop is in the focal plane of the surfaces before it",
                   "a telecentric beam takes object_na and object_heights_mm");
  else if (!result.telecentric && !scene.object.at_infinity() && entrance.z == scene.object.z)
    findings.error(model.object.place, "the object lies in the entrance pupil", "move the object or the stop");
  else if (!findings.has_errors() && result.is_of_stop && !(result.stop_semi_diameter > 0 && std::isfinite(result.stop_semi_diameter)))
    findings.error(model.aperture.place, "the beam has no size at the stop to aim at", "give stop_diameter_mm, or leave out aim");
  return result;
}

// Vertex curvatures. Those of point clouds are fitted over the beam, and the beam may depend on them (stop_diameter_mm,
// image_f_number): a first round takes the least beam, the second the beam that follows from it.
using Clouds = std::vector<std::shared_ptr<const prescription::PointCloud>>;  // by surface; null for shapes without points
void set_vertex_curvatures(const Model& model, const Clouds& clouds, Scene& scene) {
  const auto set = [&](auto&& beam_radius) {
    for (int number = 1; number <= scene.surface_count(); ++number) {
      Surface& surface = scene.surfaces[static_cast<std::size_t>(number - 1)];
      const auto& cloud = clouds[static_cast<std::size_t>(number - 1)];
      if (cloud) {
        const VertexCurvatures fitted = vertex_curvatures(*cloud, beam_radius(number));
        facets_of(surface.shape)->curvature = surface.vertex_curvature = fitted.y;
        surface.vertex_curvature_x = fitted.x;
      } else {
        surface.vertex_curvature = std::visit([](const auto& shape) { return shape.vertex_curvature(); }, surface.shape);
        surface.vertex_curvature_x = vertex_curvature_x(surface.shape);
      }
    }
  };
  set([](int) { return 0.0; });
  if (std::none_of(clouds.begin(), clouds.end(), [](const auto& cloud) { return cloud; })) return;
  Findings told_later;
  FirstOrder paraxial = first_order(scene, scene.primary, 1);
  paraxial.entrance_pupil.semi_diameter = compile_pupil(model, scene, paraxial, told_later).semi_diameter;
  const Scene before = scene;
  set([&](int number) { return marginal_height(before, before.primary, paraxial.entrance_pupil, number); });
}

// Where a cloud or a grid says nothing of its vertex. (Of clouds that wait for the beam, what their points span.)
void tell_of_vertices_without_points(const Model& model, const std::vector<int>& waiting, Scene& scene, Findings& findings) {
  for (std::size_t i = 0; i < scene.surfaces.size(); ++i) {
    const prescription::Shape& given = model.surfaces[i].shape;
    if (!given.cloud && !given.grid) continue;
    const bool is_waiting = std::find(waiting.begin(), waiting.end(), static_cast<int>(i) + 1) != waiting.end();
    const bool is_known = given.grid ? std::get<surface::BicubicGrid>(scene.surfaces[i].shape).has_data(0.0, 0.0)
                          : is_waiting ? extent_of(*given.cloud).places.contains(0, 0) : facets_of(scene.surfaces[i].shape)->covers(0, 0);
    if (is_known) continue;
    findings.note(given.place, "(0, 0) is in a hole or beyond the points: focal lengths and pupils rest on a vertex extrapolated from them");
  }
}

// The surfaces whose points the beam may need in part only, made in the order of the light: each from the lines that come
// to it through those before.
void compile_what_is_needed(const Model& model, const Beam& beam, const std::vector<int>& numbers, CompileResult& result, Scene& scene) {
  for (const int number : numbers) {
    const prescription::Shape& given = model.surfaces[static_cast<std::size_t>(number - 1)].shape;
    Surface& surface = scene.surfaces[static_cast<std::size_t>(number - 1)];
    if (auto part = compile_part(given, beam(scene, number), scene.arena, result.findings)) {
      surface.shape = part->shape;
      result.parts.push_back({number, given.cloud->points.size(), part->used});
    } else {
      surface.shape = compile_cloud(given, scene.arena, result.findings).shape;
    }
    if (result.findings.has_errors()) return;
    facets_of(surface.shape)->curvature = surface.vertex_curvature;
  }
}

CompileResult compile_for(const Model& model, const Beam& beam) {
  CompileResult result;
  Findings& findings = result.findings;
  Scene scene;
  scene.surfaces.resize(model.surfaces.size());
  for (const double nm : model.wavelengths_nm) scene.wavelengths.push_back(compile_wavelength(model, nm, findings));
  scene.primary = compile_wavelength(model, model.primary_wavelength_nm(), findings);
  for (const prescription::Surface& given : model.surfaces)
    if (given.shape.cloud)
      if (const auto missing = missing_triangulation(given.shape.place)) findings.add(*missing);
  if (findings.has_errors()) return result;

  place_surfaces(model, scene);
  compile_gradients(model, scene, findings);
  result.dispersive_gaps = count_dispersive_gaps(model);
  scene.object.z = -model.object.distance_mm;
  if (!model.fields.are_solved()) findings.error(model.fields.place, "these fields are not solved for yet");
  scene.fields = compile_fields(model.fields);
  Clouds clouds(model.surfaces.size());
  std::vector<int> waiting;  // for the beam
  const auto is_stop = [](const prescription::Surface& one) { return one.stop; };
  const int stop = 1 + static_cast<int>(std::find_if(model.surfaces.begin(), model.surfaces.end(), is_stop) - model.surfaces.begin());
  if (stop > static_cast<int>(model.surfaces.size())) {  // of a reader's model, one is
    findings.error({}, "no surface is the stop");
    return result;
  }
  scene.stop = stop;
  for (std::size_t i = 0; i < model.surfaces.size(); ++i) {
    const prescription::Surface& given = model.surfaces[i];
    const int number = static_cast<int>(i) + 1;
    Surface& surface = scene.surfaces[i];
    // Lines are straight; and where rays are aimed through it, whole.
    if (given.shape.cloud && beam && may_be_a_part(given.shape) && !scene.primary.gradient(number - 1) && !(model.aperture.is_of_stop && number <= stop)) {
      surface.shape = surface::Facets{};
      clouds[i] = given.shape.cloud;
      waiting.push_back(number);
    } else if (given.shape.cloud) {
      CompiledCloud compiled = compile_cloud(given.shape, scene.arena, findings);
      surface.shape = compiled.shape;
      clouds[i] = compiled.cloud;
      if (compiled.smoothing) result.smoothing[number] = *compiled.smoothing;
    } else if (given.shape.grid) {
      surface.shape = compile_grid(given.shape, scene.arena);
    } else {
      const surface::Shape prescribed = compile_shape(given.shape, scene.arena);
      surface.shape = surface::least_form(prescribed);
      if (surface.shape.index() != prescribed.index()) result.given[number] = prescribed;
    }
    surface.mirror = given.is_mirror();
    surface.image = i + 1 == model.surfaces.size();
    surface.semi_diameter = given.semi_diameter_mm;
    surface.inner_semi_diameter = given.inner_semi_diameter_mm;
  }
  if (findings.has_errors()) return result;

  set_vertex_curvatures(model, clouds, scene);
  for (std::size_t i = 0; i < scene.surfaces.size(); ++i)
    if (!std::isfinite(scene.surfaces[i].vertex_curvature))
      findings.error(model.surfaces[i].shape.place, "the surface has no curvature at its vertex, so the system has no first order",
                     "the radius is too small for a number, or too few points lie around (0, 0)");
  if (findings.has_errors()) return result;
  tell_of_vertices_without_points(model, waiting, scene, findings);
  scene.pupil = compile_pupil(model, scene, first_order(scene, scene.primary, 1), findings);
  const double semi_diameter = scene.pupil.telecentric ? std::numeric_limits<double>::quiet_NaN() : scene.pupil.semi_diameter;
  result.first_order = first_order(scene, scene.primary, semi_diameter);
  if (scene.is_astigmatic()) {
    const double wider = first_order(scene, scene.primary, 1, Section::x).entrance_pupil.magnification / result.first_order.entrance_pupil.magnification;
    result.first_order_x = first_order(scene, scene.primary, semi_diameter * std::abs(wider), Section::x);  // of the same stop
  }
  if (!findings.has_errors()) compile_what_is_needed(model, beam, waiting, result, scene);
  if (!findings.has_errors()) result.scene = std::move(scene);
  return result;
}

}  // namespace

CompileResult compile(const Model& model, const Beam& beam) {
  CompileResult result = compile_for(model, beam);
  // with all points, everything that is wrong with them is told, and nothing that follows from it
  return result.scene || !beam ? std::move(result) : compile_for(model, {});
}

}  // namespace sagitta::scene
