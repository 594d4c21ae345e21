// SPDX-License-Identifier: Apache-2.0
// A second tracer, to compare the batch kernel with: one ray at a time, on a number type T, all in the global frame. It
// shares only the shapes' meet() with the program. Frames are built as the contract says it, by turning the axes one
// after the other, with no matrix; refraction is Snell's law by the textbook, with a normalised normal:
//   sin^2 t = (n/n')^2 (1 - cos^2 i),   d' = n/n' d + (cos t - n/n' cos i) N,   N along the ray.
#pragma once

#include <cmath>
#include <variant>
#include <vector>

#include "lib/prescription/model.h"
#include "lib/scene/scene.h"
#include "lib/surface/status.h"

namespace sagitta::test {

using numerics::Vec3;
using numerics::vec3_cast;
using surface::Status;

template <class T>
struct OracleRay {
  Vec3<T> p, d;  // global
  T opl{};
  Status status = Status::ok;
  int ended_at = 0;
};

template <class T>
struct OracleSurface {
  Vec3<T> vertex, ex{T(1), T(0), T(0)}, ey{T(0), T(1), T(0)}, ez{T(0), T(0), T(1)};  // global
  const surface::Shape* shape;
  T index_before, index_after;
  bool mirror, image;
  T semi_diameter, inner_semi_diameter;
  bool unlimited;
};

// One axis turned toward another by an angle, the other one with it.
template <class T>
void turn(Vec3<T>& from, Vec3<T>& toward, const T& angle) {
  using std::cos;
  using std::sin;
  const Vec3<T> first = from, second = toward;
  from = cos(angle) * first + sin(angle) * second;
  toward = cos(angle) * second - sin(angle) * first;
}

// `scene` lends the compiled shapes only.
template <class T>
std::vector<OracleSurface<T>> oracle_system(const prescription::Model& model, const scene::Scene& scene) {
  using std::acos;
  const T degree = acos(T(-1)) / T(180);
  std::vector<OracleSurface<T>> result;
  T z(0), index(model.object.medium.index(0.55));
  for (std::size_t i = 0; i < model.surfaces.size(); ++i) {
    const prescription::Surface& given = model.surfaces[i];
    if (i > 0) z += T(model.surfaces[i - 1].thickness_mm);
    OracleSurface<T> one{};
    one.vertex = Vec3<T>{T(given.decenter_mm.x), T(given.decenter_mm.y), z + T(given.decenter_mm.z)};
    turn(one.ey, one.ez, T(given.tilt_deg.x) * degree);
    turn(one.ez, one.ex, T(given.tilt_deg.y) * degree);
    turn(one.ex, one.ey, T(given.tilt_deg.z) * degree);
    one.shape = &scene.surfaces[i].shape;
    one.mirror = given.is_mirror();
    one.image = i + 1 == model.surfaces.size();
    one.index_before = index;
    if (!one.mirror) index = T(given.medium->index(0.55));
    one.index_after = index;
    one.unlimited = std::isinf(given.semi_diameter_mm);
    one.semi_diameter = one.unlimited ? T(0) : T(given.semi_diameter_mm);
    one.inner_semi_diameter = T(given.inner_semi_diameter_mm);
    result.push_back(one);
  }
  return result;
}

template <class T>
void oracle_step(const OracleSurface<T>& s, int number, OracleRay<T>& ray) {
  using std::sqrt;
  const auto local = [&](const Vec3<T>& v) { return Vec3<T>{dot(v, s.ex), dot(v, s.ey), dot(v, s.ez)}; };
  const Vec3<T> start = local(ray.p - s.vertex), direction = local(ray.d);
  const auto end = [&](Status status) { ray.status = status, ray.ended_at = number; };
  const surface::Crossing<T> crossing = std::visit([&](const auto& shape) { return shape.meet(start, direction); }, *s.shape);
  if (crossing.status != Status::ok) return end(crossing.status);
  ray.p = ray.p + crossing.path * ray.d;
  ray.opl += s.index_before * crossing.path;
  const Vec3<T> hit = local(ray.p - s.vertex);
  const T r = sqrt(hit.x * hit.x + hit.y * hit.y);
  if ((!s.unlimited && r > s.semi_diameter) || r < s.inner_semi_diameter) return end(Status::clipped);
  if (s.image || (!s.mirror && s.index_before == s.index_after)) return;
  Vec3<T> N = numerics::normalized(crossing.normal.x * s.ex + crossing.normal.y * s.ey + crossing.normal.z * s.ez);
  if (dot(N, ray.d) < T(0)) N = -N;
  const T cos_i = dot(N, ray.d);
  if (s.mirror) {
    ray.d = ray.d - T(2) * cos_i * N;
    return;
  }
  const T mu = s.index_before / s.index_after, sin2_t = mu * mu * (T(1) - cos_i * cos_i);
  if (sin2_t > T(1)) return end(Status::total_reflection);
  ray.d = mu * ray.d + (sqrt(T(1) - sin2_t) - mu * cos_i) * N;
}

// Through the surfaces from number `first` on.
template <class T>
OracleRay<T> oracle_trace(const std::vector<OracleSurface<T>>& system, OracleRay<T> ray, int first = 1) {
  for (int number = first; number <= static_cast<int>(system.size()) && ray.status == Status::ok; ++number)
    oracle_step(system[static_cast<std::size_t>(number - 1)], number, ray);
  return ray;
}

}  // namespace sagitta::test
