// SPDX-License-Identifier: Apache-2.0
// Laws for one ray at one surface, in 50 digits from the tracer's doubles. The surface's equation, its normal and its sag are written down here once more,
// or come from textbook.h: the tracer's own formulas play no part but for surfaces of points.
//
// With K, K' the rays before and behind, N the unit normal, n and n' the indices; b.position, b.direction and b.normal of the ray's bound.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

#include "lib/study/rounding_bound_internal.h"
#include "lib/trace/kernel.h"
#include "tests/extreme/textbook.h"

namespace sagitta::test {

using study::Exact, study::ExactRay, study::ExactStep, study::RoundingBound, study::View, study::size_of;

inline constexpr double unit_roundoff = 0x1p-53;

struct Passage {
  const View& view;
  const prescription::Shape& given;
  int from, number;  // dummies between them are passed by
  ExactRay before;   // the tracer's, in the frame of surface `from`
  ExactStep exact;   // from there
  ExactRay behind;   // the tracer's
  RoundingBound bound;
  double scale;      // of the system, mm

  const scene::Surface& surface() const { return view.scene.surface(number); }
  bool is_in_gradient() const { return view.wavelength.gradient(number - 1) != nullptr; }
  double index_before() const { return static_cast<double>(exact.index_before); }
  double index_behind() const { return static_cast<double>(exact.index_behind); }
};

// How far beyond what is allowed: above 1 it is. Infinite for NaN.
inline double part(const Exact& error, double most) {
  const double size = size_of(error);
  return size == 0 ? 0 : size / most < std::numeric_limits<double>::infinity() ? size / most : std::numeric_limits<double>::infinity();
}
inline double part(const Vec3<Exact>& error, double most) { return part(norm(error), most); }

// Of radial patches, which jump from facet to facet: the sheet that a hit lies on, that of the facet there or, in the gap between two, of the neighbour whose
// sheet goes on beyond its edge (surface/radial.h).
struct Sheet {
  std::uint32_t facet = surface::no_facet;
  double into_gap = 0;  // how far from both sheets' heights the line passes the wall over the edge between them; 0: between them, or no gap

  template <class S>
  static Sheet of(const S& patches, const Vec3<Exact>& p, const Vec3<Exact>& d, double near) {
    const surface::Mesh& mesh = *patches.facets.mesh;
    const std::uint32_t own = patches.facets.facet_at(p.x, p.y);
    if (own == surface::no_facet) return {};
    const auto off = [&](std::uint32_t facet, const Vec3<Exact>& at) { return Exact(at.z - patches.height_of(facet, at.x, at.y).z); };
    Sheet best{own};
    const auto slopes = patches.height_of(own, p.x, p.y);
    Exact least = abs(off(own, p));
    if (part(least, 2 * size_of(Vec3<Exact>{slopes.dz_dx, slopes.dz_dy, Exact(1)}) * near) <= 1) return best;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t other = mesh.facets[own].neighbour[i];
      if (other == surface::no_facet || !(abs(off(other, p)) < least)) continue;
      const auto corner = [&](std::size_t k) { return vec3_cast<Exact>(mesh.vertices[mesh.corners[own][k % 3]]); };
      const Vec3<Exact> a = corner(i + 1), edge = corner(i + 2) - a;
      const Exact to_wall = (edge.x * (a.y - p.y) - edge.y * (a.x - p.x)) / (edge.x * d.y - edge.y * d.x);
      const Vec3<Exact> wall = p + to_wall * d;
      const Exact one = off(own, wall), two = off(other, wall), nearer = abs(one) < abs(two) ? abs(one) : abs(two);
      least = abs(off(other, p));
      best = {other, (one < Exact(0)) != (two < Exact(0)) ? 0 : static_cast<double>(nearer)};
    }
    return best;
  }
};

// z - S(x, y) = 0 by the user's numbers.
class Equation {
 public:
  explicit Equation(const Passage& at) : Equation(at.surface().shape, at.given) {
    std::visit([&]<class S>(const S& shape) {
      if constexpr (is_radial<S>) sheet_ = Sheet::of(shape, at.behind.position, at.exact.direction, at.bound.position);
    }, compiled_);
  }
  Equation(const surface::Shape& compiled, const prescription::Shape& given) : compiled_(compiled) {
    if (const auto* sphere = std::get_if<surface::Sphere>(&compiled_)) conic_ = TextbookConic<Exact>{Exact(sphere->curvature), Exact(1)};
    if (const auto* conic = std::get_if<surface::Conic>(&compiled_)) conic_ = TextbookConic<Exact>{Exact(conic->curvature), Exact(1) + Exact(conic->conic_constant)};
    if (std::visit([]<class S>(const S&) { return surface::is_analytic<S> && !surface::has_closed_form<S>; }, compiled)) sag_.emplace(given);
  }
  const std::optional<TextbookConic<Exact>>& conic() const { return conic_; }
  Exact sag(const Exact& x, const Exact& y) const {
    if (conic_) return conic_->height(x, y).z;
    if (sag_) return sag_->height(x, y).z;
    return std::visit([&]<class S>(const S& shape) {
      if constexpr (is_radial<S>)
        if (sheet_.facet != surface::no_facet) return shape.height_of(sheet_.facet, x, y).z;
      return shape.sag(x, y);
    }, compiled_);
  }
  // Up to the length of the gradient how far off the surface a place is. A conic's is z - c/2 (x^2 + y^2 + (1+K) z^2), without a root.
  Exact residual(const Vec3<Exact>& p) const {
    if (conic_) return p.z - conic_->c / Exact(2) * (p.x * p.x + p.y * p.y + conic_->k1 * p.z * p.z);
    return p.z - sag(p.x, p.y);
  }
  Vec3<Exact> gradient(const Vec3<Exact>& p) const {
    if (conic_) return {-conic_->c * p.x, -conic_->c * p.y, Exact(1) - conic_->c * conic_->k1 * p.z};
    if (sag_) {
      const auto h = sag_->height(p.x, p.y);
      return {-h.dz_dx, -h.dz_dy, Exact(1)};
    }
    return std::visit([&]<class S>(const S& shape) -> Vec3<Exact> {
      if constexpr (is_radial<S>)
        if (sheet_.facet != surface::no_facet) {
          const auto h = shape.height_of(sheet_.facet, p.x, p.y);
          return {-h.dz_dx, -h.dz_dy, Exact(1)};
        }
      const auto slope = shape.gradient(p.x, p.y);
      return {-slope.x, -slope.y, Exact(1)};
    }, compiled_);
  }
  const Sheet& sheet() const { return sheet_; }

 private:
  template <class S>
  static constexpr bool is_radial = requires(const S& shape) { shape.height_of(0u, 0.0, 0.0); };

  const surface::Shape& compiled_;
  std::optional<TextbookConic<Exact>> conic_;
  std::optional<TextbookSag<Exact>> sag_;
  Sheet sheet_;
};

// The tracer's answer is the exact one within the bound.
inline double own_error(const Passage& at) {
  return std::max({part(at.behind.position - at.exact.behind.position, at.bound.position), part(at.behind.direction - at.exact.behind.direction, at.bound.direction),
                   part(at.behind.opl - at.exact.behind.opl, at.bound.opl)});
}

// The hit lies on the surface and on the ray: within b.position of the exact hit, so the residual is below |gradient| b.position; twice for what the gradient
// changes on the way (a tenth at most, or there is no bound). The compiled curvature and coefficients are those that the user wrote to u of
// each term, which b.position holds twice.
// Of a conic's two crossings it is the one that the textbook takes; of two sheets with a gap between them the line passes the wall of the gap.
inline double off_surface(const Passage& at) {
  const Equation equation(at);
  const Vec3<Exact>&p = at.behind.position, n = equation.gradient(p);
  const double size = size_of(n);
  if (const auto& conic = equation.conic(); conic && !at.is_in_gradient())
    if (const double other = part(p - textbook_meet(*conic, at.exact.start, at.exact.direction).point, at.bound.position); other > 1) return other;
  const double off_line = at.is_in_gradient() ? 0 : part(cross(p - at.exact.start, at.exact.direction), at.bound.position);
  return std::max({part(equation.residual(p), 2 * size * at.bound.position), off_line, part(Exact(equation.sheet().into_gap), 2 * size * at.bound.position)});
}

// n K x N = n' K' x N, which is Snell's law, and K' lies in the plane of K and N. N at the tracer's hit is turned against that of the exact
// one by b.normal, and once more by its own change there.
inline double snell(const Passage& at) {
  const Vec3<Exact> N = normalized(Equation(at).gradient(at.behind.position));
  const Vec3<Exact>&K = at.exact.arriving, K_behind = at.behind.direction;
  const Exact &n = at.exact.index_before, &n_behind = at.exact.index_behind;
  if (at.surface().image) return part(K_behind - K, at.bound.direction);
  const double most = (at.index_before() + at.index_behind()) * at.bound.normal + at.index_behind() * at.bound.direction;
  const double refracted = part(cross(n * K - n_behind * K_behind, N), most);
  const double coplanar = part(dot(K_behind, cross(K, N)), most / std::min(at.index_before(), at.index_behind()));
  const bool goes_on = (dot(K, N) > Exact(0)) == (dot(K_behind, N) > Exact(0));
  const double cosine = std::min(size_of(dot(K, N)), size_of(dot(K_behind, N)));
  const bool is_sure = cosine > at.bound.direction + at.bound.normal;
  return is_sure && goes_on == at.surface().mirror ? std::numeric_limits<double>::infinity() : std::max(refracted, coplanar);
}

// Fermat: the path from A before to B behind over Q on the surface is stationary at the hit, to second order: its slope from a difference over 2h, of an error
// of h^2, along two tangents. By Snell's law at the exact hit it is what snell() allows, times the tangent's length. None: on the image, beyond the equator by
// rounding, or on an edge between facets.
inline std::optional<double> fermat(const Passage& at) {
  if (at.surface().image) return std::nullopt;
  const Equation equation(at);
  const Vec3<Exact>&p = at.behind.position, gradient = equation.gradient(p);
  const Exact length = norm(p) + Exact(at.scale), h = length * Exact(1e-18) / norm(gradient);
  const Vec3<Exact> A = p - length * at.exact.arriving, B = p + length * at.behind.direction;
  const Exact z = equation.sag(p.x, p.y);
  double worst = 0;
  for (const bool is_x : {true, false}) {
    const auto beside = [&](const Exact& step) {
      const Exact x = is_x ? p.x + step : p.x, y = is_x ? p.y : p.y + step;
      return Vec3<Exact>{x, y, p.z + (equation.sag(x, y) - z)};
    };
    const auto opl = [&](const Vec3<Exact>& q) { return at.exact.index_before * norm(q - A) + at.exact.index_behind * norm(B - q); };
    const Vec3<Exact> forth = beside(h), back = beside(-h);
    if (!(forth.z - z - back.z == forth.z - z - back.z)) return std::nullopt;
    const Exact rises = (is_x ? Exact(-gradient.x) : Exact(-gradient.y)) / gradient.z * h;
    if (size_of(Exact(forth.z - p.z - rises)) + size_of(Exact(back.z - p.z + rises)) > 1e-12 * size_of(Exact(h * norm(gradient)))) return std::nullopt;
    const double tangent = size_of(forth - back) / size_of(Exact(2 * h));
    const double of_paths = (at.index_before() + at.index_behind()) * size_of(Exact(length / h)) * 4e-50;  // their own rounding, of 50 digits
    const double most = tangent * ((at.index_before() + at.index_behind()) * at.bound.normal + at.index_behind() * at.bound.direction) + of_paths;
    worst = std::max(worst, part((opl(forth) - opl(back)) / (Exact(2) * h), most));
  }
  return worst;
}

// One surface alone, entered in its own frame.
struct Alone {
  scene::Scene scene;
  scene::Wavelength wavelength;
  explicit Alone(const scene::Surface& surface, double index_before, double index_behind) {
    scene.surfaces = {surface};
    wavelength.index = {index_before, index_behind};
  }
};

inline trace::RayBatch advanced(const Alone& alone, const Vec3<double>& position, const Vec3<double>& direction) {
  trace::RayBatch batch(1);
  batch.set(0, position, direction, 0);
  const scene::Surface& surface = alone.scene.surfaces.front();
  advance(surface, 1, surface.local_from_previous, surface.centred, alone.wavelength.index[0], alone.wavelength.index[1], batch.columns(0), 1);
  return batch;
}

inline Vec3<double> in_doubles(const Vec3<Exact>& v) { return numerics::vec3_cast<double>(v); }

// Sent back from behind, the ray comes to the same hit and leaves the way it came. The line starts from B, rounded, and passes within 2 u (|B| + its way) of the tracer's
// hit; the exact ray that would come back exactly starts b.position and b.direction from it. None: the hit that the contract defines is another one
// for that line, or an aperture's rim is between the two.
inline std::optional<double> reversed(const Passage& at) {
  Alone alone(at.surface(), at.index_behind(), at.index_before());
  scene::Surface& surface = alone.scene.surfaces.front();
  surface.local_from_previous = {}, surface.centred = true;
  const Vec3<double> p = in_doubles(at.behind.position), d = in_doubles(at.behind.direction);
  const double way = norm(p) + at.scale;
  const Vec3<double> B = p + way * d;
  const trace::RayBatch back = advanced(alone, B, -d);
  const View view{alone.scene, alone.wavelength};
  const ExactRay start{vec3_cast<Exact>(B), normalized(vec3_cast<Exact>(-d)), 0, Exact(0)};
  const ExactStep exact = view.look(1, start);
  const RoundingBound bound = rounding_bound(view, 0, 1, start, exact, {2 * unit_roundoff * (norm(B) + way) + at.bound.position, at.bound.direction});
  if (back.ended[0] != 0 || exact.behind.ended != 0 || !(bound.position + bound.direction < std::numeric_limits<double>::infinity())) return std::nullopt;
  if (size_of(exact.crossing.point - at.behind.position) > bound.position + at.bound.position) return std::nullopt;
  return std::max(part(vec3_cast<Exact>(back.position(0)) - at.behind.position, bound.position + at.bound.position),
                  part(normalized(vec3_cast<Exact>(back.direction(0))) + at.exact.direction, bound.direction));
}

// Turned about the axis of a surface of revolution by any angle, the ray behind is turned with it. Cosine and sine are off by u, the products by 3 u more:
// 4 u of the place at its start, and of the direction. None: another kind of surface, or an aperture's rim is between the two.
inline std::optional<double> turned(const Passage& at, const trace::RayBatch& start, std::size_t i, double angle) {
  const scene::Surface& surface = at.surface();
  const bool is_of_revolution = std::visit([]<class S>(const S&) { return surface::has_closed_form<S> || std::is_same_v<S, surface::Asphere>; }, surface.shape);
  if (!is_of_revolution || !surface.centred || at.from != at.number - 1) return std::nullopt;
  const Alone alone(surface, at.index_before(), at.index_behind());
  const double c = std::cos(angle), s = std::sin(angle);
  const auto turn = [&]<class T>(const Vec3<T>& v) { return Vec3<T>{T(c) * v.x - T(s) * v.y, T(s) * v.x + T(c) * v.y, v.z}; };
  const trace::RayBatch other = advanced(alone, turn(start.position(i)), turn(start.direction(i)));
  const double off = 4 * unit_roundoff, path = size_of(at.exact.crossing.path);
  const RoundingBound bound = rounding_bound(at.view, at.from, at.number, at.before, at.exact, {off * (size_of(at.before.position) + path), off});
  if (other.ended[0] != 0 || !(bound.position + bound.direction < std::numeric_limits<double>::infinity())) return std::nullopt;
  const auto more = [&](double of_one, double size) { return of_one + off * size; };
  return std::max(part(vec3_cast<Exact>(other.position(0)) - turn(at.behind.position), more(bound.position + at.bound.position, size_of(at.behind.position))),
                  part(normalized(vec3_cast<Exact>(other.direction(0))) - normalized(turn(at.behind.direction)), more(bound.direction + at.bound.direction, 1)));
}

}  // namespace sagitta::test
