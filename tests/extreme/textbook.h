// SPDX-License-Identifier: Apache-2.0
// Rays by the textbook, in any number type: what naive arithmetic gives in double, and in 100 digits the exact answer, by formulas that
// share nothing with lib/surface.
//
// In double it goes as the usual program does:
//   conic     transfer to the vertex plane, t = (-b +- sqrt(b^2 - 4 a c))/(2 a) (a = 0: -c/b), the root nearer to that plane      (1)
//   others    textbook_sag.h; Newton's method from the vertex plane, 32 steps at most, and then what there is                     (2)
//   facets    Moeller and Trumbore's test, facet by facet, 0 <= u, v, u + v <= 1                                                   (3)
//   Snell     cos^2 i' = 1 - mu^2 (1 - cos^2 i), unit normals, directions and light paths added up as they come                     (4)
// (1) is that of optiland (geometries/standard.py), without the transfer; (2) returns like goptical's.
// In other number types two choices differ: of the roots of (1) the contract's is taken, and (2) follows the base's hit while the
// departure grows from 0 to its size, which is what "the hit continuous with the base's" means.
#pragma once

#include <cmath>
#include <variant>

#include "lib/prescription/model.h"
#include "lib/scene/scene.h"
#include "tests/extreme/textbook_sag.h"

namespace sagitta::test {

using numerics::Vec3, numerics::dot, numerics::cross, numerics::vec3_cast;
using surface::Status;

// NaN is a hit like any other here, for nobody looks.
template <class T>
struct TextbookHit {
  Status status = Status::ok;
  T path{};
  Vec3<T> point{}, normal{};  // |normal| = 1
};

template <class T>
struct TextbookRay {
  Vec3<T> position{}, direction{};  // in the frame of the last surface
  T opl{};
  Status status = Status::ok;
  int ended_at = 0;
};

template <class T>
inline constexpr bool is_naive = std::is_same_v<T, double>;

template <class T>
TextbookHit<T> hit_of(const T& path, const Vec3<T>& point, const Vec3<T>& normal) {
  return {Status::ok, path, point, numerics::normalized(normal)};
}

template <class T>
TextbookHit<T> textbook_plane(const Vec3<T>& p, const Vec3<T>& d) {
  if (d.z == T(0) && !is_naive<T>) return {Status::missed};
  const T t = -p.z / d.z;
  return hit_of<T>(t, p + t * d, {T(0), T(0), T(1)});
}

template <class T>
TextbookHit<T> textbook_meet(const TextbookQuadric<T>& quadric, const Vec3<T>& p, const Vec3<T>& d) {
  using std::sqrt;
  const auto& [c_x, c_y, m] = quadric;
  const T A = c_x * d.x * d.x + c_y * d.y * d.y + m * d.z * d.z;
  const T B = T(2) * (c_x * d.x * p.x + c_y * d.y * p.y + m * d.z * p.z - d.z);
  const T C = c_x * p.x * p.x + c_y * p.y * p.y + m * p.z * p.z - T(2) * p.z;
  const T radicand = B * B - T(4) * A * C;
  if (radicand < T(0)) return {Status::missed};
  const T root = sqrt(radicand), q = B < T(0) ? T((root - B) / T(2)) : T((-B - root) / T(2));
  for (const T& t : {T(q / A), T(C / q)}) {
    const Vec3<T> hit = p + t * d, normal{-c_x * hit.x, -c_y * hit.y, T(1) - m * hit.z};
    const T along = d.z < T(0) ? T(-dot(d, normal)) : dot(d, normal);
    if (normal.z > T(0) && along >= T(0)) return hit_of(t, hit, normal);  // the contract's: false for NaN and infinity
  }
  return {Status::missed};
}

template <class T>
TextbookHit<T> textbook_meet(const TextbookConic<T>& conic, const Vec3<T>& start, const Vec3<T>& d) {
  const T &c = conic.c, &k1 = conic.k1;
  if (c == T(0)) return textbook_plane(start, d);
  if constexpr (is_naive<T>) {
    const T R = 1 / c, to_plane = -start.z / d.z;
    const Vec3<T> p = start + to_plane * d;
    const T a = d.x * d.x + d.y * d.y + k1 * d.z * d.z;  // (1)
    const T b = 2 * (d.x * p.x + d.y * p.y + k1 * d.z * p.z - R * d.z);
    const T e = p.x * p.x + p.y * p.y + k1 * p.z * p.z - 2 * R * p.z;
    const T radicand = b * b - 4 * a * e;
    if (radicand < 0) return {Status::missed};
    const T root = std::sqrt(radicand), t1 = (-b + root) / (2 * a), t2 = (-b - root) / (2 * a);
    const T t = a == 0 ? -e / b : std::abs(p.z + t1 * d.z) <= std::abs(p.z + t2 * d.z) ? t1 : t2;
    const Vec3<T> hit = p + t * d;
    const T slope = c / std::sqrt(1 - k1 * c * c * (hit.x * hit.x + hit.y * hit.y));
    return hit_of<T>(to_plane + t, hit, {-slope * hit.x, -slope * hit.y, 1});
  } else {
    return textbook_meet(TextbookQuadric<T>{c, c, k1 * c}, start, d);
  }
}

// (2), by what the user wrote.
template <class T>
struct TextbookDeparture {
  TextbookSag<T> surface;

  HeightAndSlopes<T> height(const T& x, const T& y, const T& share) const {
    const HeightAndSlopes<T> whole = surface.height(x, y);
    if (share == T(1)) return whole;
    const HeightAndSlopes<T> base = surface.base().height(x, y);
    return base + share * (whole - base);
  }
  // (2), for a share of the departure; false where it does not settle.
  bool newton(const Vec3<T>& p, const Vec3<T>& d, const T& share, const T& tolerance, T& t, Vec3<T>& normal) const {
    using std::abs;
    for (int step = 0; step < 32; ++step) {
      const Vec3<T> at = p + t * d;
      const HeightAndSlopes<T> h = height(at.x, at.y, share);
      const T f = at.z - h.z;
      normal = {-h.dz_dx, -h.dz_dy, T(1)};
      if (abs(f) <= tolerance) return true;
      t -= f / dot(d, normal);
    }
    return false;
  }
  TextbookHit<T> meet(const Vec3<T>& p, const Vec3<T>& d) const {
    Vec3<T> normal;
    if constexpr (is_naive<T>) {
      T t = -p.z / d.z;
      newton(p, d, 1, 1e-14, t, normal);
      return hit_of<T>(t, p + t * d, normal);
    } else {
      const TextbookHit<T> start = textbook_meet(surface.base(), p, d);
      if (start.status != Status::ok) return start;
      using std::pow;
      const bool is_forward = dot(d, start.normal) > T(0);
      T t = start.path, share(0), step = T(1) / T(16);
      const T shortest = step / T(1 << 20), settled = pow(std::numeric_limits<T>::epsilon(), T(0.8)), near = pow(std::numeric_limits<T>::epsilon(), T(0.4));
      while (share < T(1)) {
        const T next = share + step < T(1) ? T(share + step) : T(1);
        T moved = t;
        // sound if the line still comes from the same side and the hit has not jumped: two steps of half the size agree
        const bool is_settled = newton(p, d, next, settled, moved, normal) && (dot(d, normal) > T(0)) == is_forward;
        T half = t;
        Vec3<T> half_normal;
        const bool agrees = is_settled && newton(p, d, (share + next) / T(2), settled, half, half_normal) && newton(p, d, next, settled, half, half_normal) &&
                            abs(half - moved) < near;
        if (agrees) {
          t = moved, share = next;
          continue;
        }
        step /= T(2);
        if (step < shortest) return {Status::not_converged};  // the hit ends at a fold
      }
      newton(p, d, T(1), settled, t, normal);
      // a fold that the steps have jumped over: lambda = (z - base)/departure must rise from the base's hit to this one
      constexpr int samples = 256;
      T before(0);
      for (int i = 1; i < samples && abs(t - start.path) > near; ++i) {
        const Vec3<T> at = p + (start.path + (t - start.path) * T(i) / T(samples)) * d;
        const T base = surface.base().height(at.x, at.y).z, lambda = (at.z - base) / (surface.height(at.x, at.y).z - base);
        if (!(lambda > before)) return {Status::not_converged};
        before = lambda;
      }
      return hit_of<T>(t, p + t * d, normal);
    }
  }
};

template <class T>
TextbookHit<T> textbook_facets(const surface::Mesh& mesh, const Vec3<T>& p, const Vec3<T>& d) {
  const T slack(is_naive<T> ? 0 : 1e-60);
  for (std::uint32_t f = 0; f < mesh.facet_count; ++f) {
    const auto corner = [&](std::size_t i) { return vec3_cast<T>(mesh.vertices[mesh.corners[f][i]]); };
    const Vec3<T> a = corner(0), ab = corner(1) - a, ac = corner(2) - a, from_a = p - a;
    const Vec3<T> across = cross(d, ac), turned = cross(from_a, ab);
    const T determinant = dot(ab, across);
    if (determinant == T(0)) continue;
    const T u = dot(from_a, across) / determinant, v = dot(d, turned) / determinant;  // (3)
    if (!(u >= -slack && v >= -slack && u + v <= T(1) + slack)) continue;
    const T t = dot(ac, turned) / determinant;
    return hit_of<T>(t, p + t * d, cross(ab, ac));
  }
  return {Status::outside_data};
}

// Shapes that the textbook knows: those of a formula, and flat facets.
inline bool is_in_textbook(const surface::Shape& shape) {
  return std::visit([]<class S>(const S&) { return std::is_same_v<S, surface::Facets> || surface::is_analytic<S>; }, shape);
}

template <class T>
TextbookHit<T> textbook_meet(const surface::Shape& shape, const prescription::Shape& given, const Vec3<T>& p, const Vec3<T>& d) {
  return std::visit([&]<class S>(const S& of) -> TextbookHit<T> {
    if constexpr (std::is_same_v<S, surface::Plane>) return textbook_plane(p, d);
    else if constexpr (std::is_same_v<S, surface::Sphere>) return textbook_meet(TextbookConic<T>{T(of.curvature), T(1)}, p, d);
    else if constexpr (std::is_same_v<S, surface::Conic>) return textbook_meet(TextbookConic<T>{T(of.curvature), T(1) + T(of.conic_constant)}, p, d);
    else if constexpr (std::is_same_v<S, surface::Facets>) return textbook_facets(*of.mesh, p, d);
    else if constexpr (surface::is_analytic<S>) {
      const TextbookDeparture<T> departure{{given}};
      const TextbookHit<T> hit = departure.meet(p, d);
      if (!given.grid || hit.status == Status::missed) return hit;
      const Vec3<T> decides = hit.status == Status::ok ? hit.point : textbook_meet(departure.surface.base(), p, d).point;  // a ray that has none by where the base has its
      return departure.surface.has_data(decides.x, decides.y) ? hit : TextbookHit<T>{Status::outside_data};
    }
    else return {Status::not_converged};
  }, shape);
}

template <class T>
void textbook_step(const scene::Surface& surface, const prescription::Shape& given, int number, double index_before, double index_behind, TextbookRay<T>& ray) {
  using std::sqrt;
  if (ray.ended_at != 0) return;
  const auto& to_local = surface.local_from_previous;
  const numerics::Rotation<T> turn{vec3_cast<T>(to_local.rotation.row_x), vec3_cast<T>(to_local.rotation.row_y), vec3_cast<T>(to_local.rotation.row_z)};
  ray.position = turn * ray.position + vec3_cast<T>(to_local.translation);
  ray.direction = turn * ray.direction;
  const auto end = [&](Status status) { ray.status = status, ray.ended_at = number; };
  const TextbookHit<T> hit = textbook_meet(surface.shape, given, ray.position, ray.direction);
  if (hit.status != Status::ok) return end(hit.status);
  ray.position = hit.point;
  ray.opl += T(index_before) * hit.path;
  const T r = sqrt(hit.point.x * hit.point.x + hit.point.y * hit.point.y);
  if (r > T(surface.semi_diameter) || r < T(surface.inner_semi_diameter)) return end(Status::clipped);
  if (surface.image || (!surface.mirror && index_before == index_behind)) return;
  const Vec3<T>& d = ray.direction;
  const T cosine = dot(d, hit.normal);
  if (surface.mirror) {
    ray.direction = d - T(2) * cosine * hit.normal;
    return;
  }
  const T mu = T(index_before) / T(index_behind), radicand = T(1) - mu * mu * (T(1) - cosine * cosine);  // (4)
  if (radicand < T(0)) return end(Status::total_reflection);
  const T behind = cosine < T(0) ? T(-sqrt(radicand)) : T(sqrt(radicand));
  ray.direction = mu * d + (behind - mu * cosine) * hit.normal;
}

}  // namespace sagitta::test
