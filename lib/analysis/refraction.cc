// SPDX-License-Identifier: Apache-2.0
#include "lib/analysis/refraction.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "lib/trace/launch.h"
#include "lib/trace/launch_rays.h"
#include "lib/trace/trace.h"

namespace sagitta::analysis {
namespace {

using numerics::cross, numerics::dot, numerics::normalized;
using trace::RayBatch;

// Around the chief ray at the centre of the entrance pupil, in the tracer's frame: u near x, v near y.
struct LineOfSight {
  Vec3<double> centre, d, u, v;
  double vergence = 0;  // of the light that arrives, 1/mm
};

LineOfSight line_of_sight(const scene::Scene& scene, const scene::Field& field, const trace::PupilPoint& chief, double index) {
  LineOfSight line;
  line.centre = {chief.x * scene.pupil.semi_diameter, chief.y * scene.pupil.semi_diameter, scene.pupil.z};
  if (scene.object.at_infinity()) {
    line.d = normalized(Vec3<double>{field.x, field.y, 1});
  } else {
    const Vec3<double> from_object = line.centre - trace::object_point<double>(scene, field);
    const double sense = from_object.z < 0 ? -1 : 1;
    line.d = sense * normalized(from_object);
    line.vergence = -sense * index / norm(from_object);
  }
  line.u = normalized(Vec3<double>{1, 0, 0} - line.d.x * line.d);
  line.v = cross(line.d, line.u);
  return line;
}

// A symmetric matrix of the pupil's plane, (x, y), as one across the chief ray, (u, v).
Power across(const LineOfSight& line, const Power& of_pupil) {
  const auto in_plane = [&](const Vec3<double>& e) { return e - (e.z / line.d.z) * line.d; };
  const Vec3<double> a = in_plane(line.u), b = in_plane(line.v);
  const auto form = [&](const Vec3<double>& p, const Vec3<double>& q) { return of_pupil.uu * p.x * q.x + of_pupil.uv * (p.x * q.y + p.y * q.x) + of_pupil.vv * p.y * q.y; };
  return {form(a, a), form(a, b), form(b, b)};
}

// (1), with H in D, at the entrance pupil and in the tracer's frame.
Power wanted(const LineOfSight& line, const Power& H) {
  return {1e3 * line.vergence - H.uu, -H.uv, 1e3 * line.vergence - H.vv};
}

Power by_least_squares(const std::vector<double>& osa_um, double pupil_radius) {
  const double r_squared = pupil_radius * pupil_radius;  // um/mm^2 = D
  const double defocus = 4 * std::numbers::sqrt3 * osa_um[4] / r_squared, astigmatism = 2 * std::sqrt(6.0) / r_squared;
  return {defocus + astigmatism * osa_um[5], astigmatism * osa_um[3], defocus - astigmatism * osa_um[5]};
}

// The Hessian of a sum of Zernike polynomials at the centre.
Power by_terms_at_centre(const std::vector<double>& osa_um, double pupil_radius) {
  double of[3] = {0, 0, 0};  // rho^2 of m = -2, 0, 2
  for (std::size_t j = 0; j < osa_um.size(); ++j) {
    const auto [n, m] = numerics::zernike_term(numerics::ZernikeIndexing::osa, static_cast<int>(j));
    if (n == 0 || (m != 0 && std::abs(m) != 2)) continue;
    const int k = n / 2, sign = k % 2 == 0 ? -1 : 1;
    const double radial = sign * k * (k + 1) / (m == 0 ? 1.0 : 2.0), norm = std::sqrt((n + 1.0) * (m == 0 ? 1 : 2));
    of[m / 2 + 1] += osa_um[j] * norm * radial;
  }
  const double scale = 2 / (pupil_radius * pupil_radius);
  return {scale * (of[1] + of[2]), scale * of[0], scale * (of[1] - of[2])};
}

// Where rays are aimed, terms are over the stop, and the entrance pupil is that as it is seen: H over points p of the stop, in units of its semi-diameter, becomes
// that over points q of the entrance pupil in units of the paraxial one's, by q's differences over +-`width`. None where one of these rays is not found.
std::optional<Power> over_entrance_pupil(const trace::Launcher& launcher, double width, const Power& H) {
  if (!launcher.aim()) return H;
  const trace::AimedPupil at = launcher.at_entrance_pupil(std::vector<trace::PupilPoint>{{width, 0}, {-width, 0}, {0, width}, {0, -width}});
  if (std::find(at.found.begin(), at.found.end(), false) != at.found.end()) return std::nullopt;
  const auto slope = [&](std::size_t i) { return trace::PupilPoint{(at.points[i].x - at.points[i + 1].x) / (2 * width), (at.points[i].y - at.points[i + 1].y) / (2 * width)}; };
  const auto [a, b] = trace::PlaneSlopes{slope(0), slope(2)}.inverse();  // dp/dq, column by column
  const auto form = [&](const trace::PupilPoint& p, const trace::PupilPoint& q) { return H.uu * p.x * q.x + H.uv * (p.x * q.y + p.y * q.x) + H.vv * p.y * q.y; };
  return Power{form(a, a), form(a, b), form(b, b)};
}

constexpr double pupil_step = .05;  // h of (5) and of the differences of (6), of the pupil's radius
constexpr double most_rounding = 1e-3;  // D: of (5), beyond which there is none
constexpr int passes = 3;           // of (5): each leaves some H^2 of what there is between the pupils, 1e-2 of an H of 10 D at first

// (1) by (5), along 0, 45, 90 and 135 degrees, at the entrance pupil and in the tracer's frame.
std::optional<Power> by_curvature(const scene::Scene& scene, const scene::Wavelength& wavelength, const LineOfSight& line, const ReferenceSphere<double>& sphere) {
  const double index = wavelength.index.front(), step = pupil_step * scene.pupil.semi_diameter;
  Power arriving{1e3 * line.vergence, 0, 1e3 * line.vergence};
  for (int pass = 0; pass < passes; ++pass) {
    RayBatch rays(17);
    const auto set = [&](std::size_t i, double pu, double pv) {
      const double su = 1e-3 * (arriving.uu * pu + arriving.uv * pv), sv = 1e-3 * (arriving.uv * pu + arriving.vv * pv);  // V p
      rays.set(i, line.centre + pu * line.u + pv * line.v, normalized(line.d - su / index * line.u - sv / index * line.v), -(pu * su + pv * sv) / 2);
    };
    for (std::size_t i = 0; i < 16; ++i) {
      const double at = static_cast<double>(i / 2) * std::numbers::pi / 4, h = i % 2 == 0 ? step : 2 * step;
      set(i, h * std::cos(at), h * std::sin(at));
    }
    set(16, 0, 0);
    trace::trace(scene, wavelength, rays);
    std::array<double, 17> W;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      if (rays.ended[i] != 0) return std::nullopt;
      W[i] = optical_path_difference(sphere, rays.position(i), rays.direction(i), rays.opl[i]);
    }
    const auto along = [&](std::size_t eighth) {
      const auto even = [&](std::size_t k) { return (W[2 * eighth + k] + W[2 * (eighth + 4) + k]) / 2 - W[16]; };
      return 1e3 * (16 * even(0) - even(1)) / (6 * step * step);
    };
    arriving = {arriving.uu - along(0), arriving.uv - (along(1) - along(3)) / 2, arriving.vv - along(2)};
  }
  return arriving;
}

// (6), at the entrance pupil and in the tracer's frame. Central differences of first and third order in the step.
std::optional<Power> by_far_point(const scene::Scene& scene, const scene::Wavelength& wavelength, const LineOfSight& line) {
  const double place_step = pupil_step * scene.pupil.semi_diameter;
  const double depth = std::abs(scene.surfaces.back().axis_z - scene.pupil.z), slope_step = place_step / (depth > 0 ? depth : 1);  // as large on the retina
  struct Start {
    double pu, pv, su, sv;
  };
  constexpr std::array factors{1.0, -1.0, 2.0, -2.0};
  std::vector<Start> starts;
  for (int which = 0; which < 4; ++which)
    for (const double factor : factors)
      starts.push_back({which == 0 ? factor * place_step : 0, which == 1 ? factor * place_step : 0, which == 2 ? factor * slope_step : 0, which == 3 ? factor * slope_step : 0});
  RayBatch rays(starts.size());
  const double index = wavelength.index.front(), vergence = line.vergence / index;
  for (std::size_t i = 0; i < starts.size(); ++i) {
    const Start& s = starts[i];
    const auto slope = [&](double own, double place) { return own - vergence * place; };  // about the light that arrives
    rays.set(i, line.centre + s.pu * line.u + s.pv * line.v, normalized(line.d + slope(s.su, s.pu) * line.u + slope(s.sv, s.pv) * line.v), 0);
  }
  trace::trace(scene, wavelength, rays);
  double columns[4][2];
  for (std::size_t which = 0; which < 4; ++which) {
    const std::size_t at = 4 * which;
    for (std::size_t i = at; i < at + 4; ++i)
      if (rays.ended[i] != 0) return std::nullopt;
    const double step = which < 2 ? place_step : slope_step;
    const auto derivative = [&](const std::vector<double>& of) { return (8 * (of[at] - of[at + 1]) - (of[at + 2] - of[at + 3])) / (12 * step); };
    columns[which][0] = derivative(rays.x), columns[which][1] = derivative(rays.y);
  }
  const auto& [b_u, b_v, c_u, c_v] = columns;
  const double determinant = c_u[0] * c_v[1] - c_v[0] * c_u[1];
  const auto solved = [&](const double (&b)[2]) { return std::array{(c_v[1] * b[0] - c_v[0] * b[1]) / determinant, (c_u[0] * b[1] - c_u[1] * b[0]) / determinant}; };
  const auto for_u = solved(b_u), for_v = solved(b_v);  // columns of C^-1 B
  const double D = 1e3 * index, arriving = 1e3 * line.vergence;
  return Power{D * for_u[0] + arriving, D * (for_u[1] + for_v[0]) / 2, D * for_v[1] + arriving};
}

}  // namespace

Spectacles spectacles(const Power& power) {
  const double cylinder = -2 * std::hypot(power.J0(), power.J45());
  const double axis = std::atan2(power.J45(), power.J0()) / 2 * (180 / std::numbers::pi);
  return {power.M() - cylinder / 2, cylinder, axis > 0 ? axis : axis + 180};
}

Power moved(const Power& power, double a, double index) {
  const double k = a / index;
  const Power one{1 + k * power.uu, k * power.uv, 1 + k * power.vv};
  const double determinant = one.uu * one.vv - one.uv * one.uv;  // P and 1 + k P commute: the product is symmetric
  return {(power.uu * one.vv - power.uv * one.uv) / determinant, (power.uv * one.uu - power.uu * one.uv) / determinant, (power.vv * one.uu - power.uv * one.uv) / determinant};
}

RefractionResult refraction(const scene::Scene& scene, const scene::Wavelength& wavelength, const scene::Field& field, const RefractionRequest& request) {
  if (scene.pupil.telecentric) return {{}, "the entrance pupil is at infinity"};
  const ReferenceResult reference = reference_sphere(scene, wavelength, field);
  if (!reference.reason.empty()) return {{}, reference.reason};
  // (5) divides paths, each rounded to some 8 epsilons, by the square of the step
  const double index = wavelength.index.front(), step = pupil_step * scene.pupil.semi_diameter;
  const double rounding = 1e3 * 8 * std::numeric_limits<double>::epsilon() * std::abs(reference.sphere.opl_chief) / (step * step);
  if (!(rounding <= most_rounding)) return {{}, "the pupil is too small: rounding alone would make a thousandth of a dioptre"};
  const trace::Launcher launcher(scene, field, wavelength);
  const trace::PupilPoint chief = launcher.at_entrance_pupil(std::vector<trace::PupilPoint>{{0, 0}}).points.front();
  const LineOfSight line = line_of_sight(scene, field, chief, index);
  const auto curvature = by_curvature(scene, wavelength, line, reference.sphere);
  const auto far_point = by_far_point(scene, wavelength, line);
  if (!curvature || !far_point) return {{}, "a ray near the chief ray is lost"};

  const double a = 1e-3 * (scene.pupil.z + request.vertex_distance) / line.d.z;
  const auto reported = [&](const Power& at_pupil) {
    const Power there = moved(at_pupil, a, index);
    return Power{there.uu, -there.uv, there.vv};  // OSA's frame
  };
  Refraction result{{}, {}, reported(*curvature), reported(*far_point)};
  WavefrontRequest for_fit = request.wavefront;
  for_fit.indexing = numerics::ZernikeIndexing::osa;
  const WavefrontResult measured = wavefront(scene, wavelength, field, for_fit);
  if (measured.wavefront && measured.wavefront->zernike) {
    const std::vector<double>& terms = measured.wavefront->zernike->coefficients;
    const auto reported_of = [&](const Power& H, double width) -> std::optional<Power> {
      const auto of_pupil = over_entrance_pupil(launcher, width, H);
      return of_pupil ? std::optional(reported(wanted(line, across(line, *of_pupil)))) : std::nullopt;
    };
    result.least_squares = reported_of(by_least_squares(terms, scene.pupil.semi_diameter), 1);
    result.at_centre = reported_of(by_terms_at_centre(terms, scene.pupil.semi_diameter), 1e-3);
  }
  return {result, {}};
}

}  // namespace sagitta::analysis
