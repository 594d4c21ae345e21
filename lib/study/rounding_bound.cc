// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <concepts>
#include <limits>

#include "lib/study/gradient_bound_internal.h"

namespace sagitta::study {
namespace {

using numerics::vec3_cast;

constexpr double u = 0x1p-53, infinite = std::numeric_limits<double>::infinity();
constexpr double length_error = 8 * u;  // of a direction

// The exact step in doubles: good to many more digits than a bound needs.
struct Place {
  Vec3<double> start, d, hit, normal;
  double path, s, normal_length;
  double line, turn;  // (1)
  double sigma() const { return normal_length / s; }
};

struct Met {
  double hit, normal, along, along_squared;  // (2), (3), (4); of n, not normalised
};
// (4) by d.n
Met by_normal(double hit, double normal, double along, double s) { return {hit, normal, along, along * (2 * s + along)}; }

Met met(const surface::Plane&, const Place& at) {
  const double turn = at.turn + length_error;
  return by_normal(2 * at.sigma() * at.line + 2 * u * std::abs(at.path) + 2 * u * norm(at.hit), 0, turn, at.s);
}

// z = (x^2 + y^2 + (1+K) z^2) c/2 by surface/conic.h, (3) to (5); a sphere with K = 0.
Met met_conic(double c, double one_plus_K, const Place& at) {
  const Vec3<double> p = surface::nearest_to_vertex(at.start, at.d).point, &d = at.d, &P = at.hit;
  const double t = dot(P - p, d), m = std::abs(one_plus_K), k = std::abs(c), m_1 = std::max(m, 1.0);
  const auto of = [&](const Vec3<double>& a, const Vec3<double>& b) { return k * (std::abs(a.x * b.x) + std::abs(a.y * b.y) + m * std::abs(a.z * b.z)); };
  const double A = of(d, d), B = std::abs(d.z) + of(d, p), C = of(p, p) + 2 * std::abs(p.z);  // the terms' sizes
  const double sum_A = std::abs(c * (d.x * d.x + d.y * d.y + one_plus_K * d.z * d.z)), sum_B = std::abs(d.z - c * (d.x * p.x + d.y * p.y + one_plus_K * d.z * p.z)),
               sum_C = std::abs(c * (p.x * p.x + p.y * p.y + one_plus_K * p.z * p.z) - 2 * p.z);
  const double turn = at.turn + length_error;
  const double e = 12 * u * (A * t * t + 2 * B * std::abs(t) + C) + 2 * length_error * k * m_1 * t * t;
  const double hit = 2 * at.sigma() * at.line + e / at.s + 2 * u * (norm(P) + std::abs(t));
  const double normal = k * m_1 * hit + u * (2 * k * std::hypot(P.x, P.y) + 4 * k * m * std::abs(P.z) + std::abs(at.normal.z));
  const double of_line = 2 * (sum_B * k * m_1 + sum_A * (1 + k * m_1 * norm(p))) * at.line, of_turn = 2 * (sum_B * (1 + k * m_1 * norm(p)) + sum_C * k * m_1) * turn;
  const double along_squared = u * (14 * sum_B * B + 7 * (sum_C * A + sum_A * C) + 2 * (sum_B * sum_B + sum_A * sum_C)) + of_line + of_turn;
  return {hit, normal, along_squared / at.s, along_squared};
}
Met met(const surface::Sphere& sphere, const Place& at) { return met_conic(sphere.curvature, 1, at); }
Met met(const surface::Conic& conic, const Place& at) { return met_conic(conic.curvature, 1 + conic.conic_constant, at); }

// By how much a surface z = S(x, y) is off in the tracer: its height, its slopes, and the (x, y) that the slopes are taken at.
struct HeightRounding {
  double z, slope, stale;
};

// What the slopes change by within a distance, at most; what the height does beyond its tangent plane.
// Twice the distance away, in steps of 45 degrees: of a smooth surface at least what the worst direction changes, and on either side of any edge that
// comes within the distance.
struct Change {
  double slope = 0, jump = 0;
};
template <class Shape>
Change change_within(const Shape& shape, const Vec3<Exact>& hit, double distance, int directions) {
  constexpr double compass[][2]{{1, 0}, {0, 1}, {.7, .7}, {.7, -.7}, {-1, 0}, {0, -1}, {-.7, -.7}, {-.7, .7}};
  const auto here = shape.gradient(hit.x, hit.y);
  const Exact z = shape.sag(hit.x, hit.y);
  Change change;
  for (int k = 0; k < directions; ++k) {
    const Exact dx(2 * distance * compass[k][0]), dy(2 * distance * compass[k][1]);
    const auto there = shape.gradient(Exact(hit.x + dx), Exact(hit.y + dy));
    const double slope = std::hypot(size_of(Exact(there.x - here.x)), size_of(Exact(there.y - here.y)));
    const double jump = size_of(Exact(shape.sag(Exact(hit.x + dx), Exact(hit.y + dy)) - z - here.x * dx - here.y * dy));
    if (!(slope < infinite) || !(jump < infinite)) return {infinite, infinite};
    change.slope = std::max(change.slope, slope), change.jump = std::max(change.jump, jump);
  }
  return change;
}

template <class Shape>
Met met_height(const Shape& shape, const HeightRounding& off, int directions, const Vec3<Exact>& exact_hit, const Place& at) {
  const double e = off.z + 4 * u * std::abs(at.hit.z);
  double hit = 2 * at.sigma() * at.line + 2 * e / at.s + 2 * u * norm(at.hit) + off.stale;
  if (!(hit < infinite)) return {infinite, infinite, infinite, infinite};
  const Change change = change_within(shape, exact_hit, hit, directions);
  hit += 2 * change.jump / at.s;
  const double normal = change.slope + off.slope;
  const Vec3<double>&d = at.d, &n = at.normal;
  return by_normal(hit, normal, (at.turn + length_error) * at.normal_length + normal + 4 * u * (std::abs(d.x * n.x) + std::abs(d.y * n.y) + std::abs(d.z)), at.s);
}

surface::SumRounding sum_rounding(const surface::Zernike& zernike, double x, double y) {
  const double X = std::abs(x * zernike.per_radius), Y = std::abs(y * zernike.per_radius), rho = std::max(1.0, std::hypot(X, Y));
  const int order = zernike.order;
  double V = 0, chebyshev = 1, before = rho;
  for (int i = 0; i <= order; ++i) {
    V += zernike.sizes[i] * chebyshev;
    const double next = 2 * rho * chebyshev - before;
    before = chebyshev, chebyshev = next;
  }
  double sum = 8 * (order + 1) * u * V, slope = 8 * (order + 1) * (order + 1) * u * zernike.bound_within(std::hypot(x, y), 1);
  if (zernike.is_polynomial) {
    sum = slope = 0;
    for (int i = 0; i <= order; ++i)
      for (int j = 0; i + j <= order; ++j) {
        const double c = std::abs(zernike.polynomial.coefficients[numerics::Polynomial::place(order, i, j)]);
        sum += c * std::pow(X, i) * std::pow(Y, j);
        if (i > 0) slope += i * c * std::pow(X, i - 1) * std::pow(Y, j);
        if (j > 0) slope += j * c * std::pow(X, i) * std::pow(Y, j - 1);
      }
    sum *= 2 * (order + 3) * u, slope *= 2 * (order + 3) * u * zernike.per_radius;
  }
  return {sum, slope, zernike.size_at_any_place + V};
}

template <class Shape>
concept DepartsFromConic = std::derived_from<Shape, surface::ConicDeparture<Shape>>;
template <class Shape>
concept DepartsFromQuadric = std::derived_from<Shape, surface::QuadricDeparture<Shape>>;

template <DepartsFromConic Shape>
HeightRounding height_rounding(const Shape& shape, const Place& at) {
  const double x = at.hit.x, y = at.hit.y;
  surface::SumRounding of_sum;
  if constexpr (requires { shape.sum_rounding(x, y); }) of_sum = shape.sum_rounding(x, y);
  else of_sum = sum_rounding(shape, x, y);
  // The conic under it, of which the slope is c r/G.
  const double c = std::abs(shape.base.curvature), m = std::abs(1 + shape.base.conic_constant), r = std::hypot(x, y);
  const double base_z = shape.base.sag(x, y), p = std::abs(at.hit.z - base_z), w = std::abs(base_z);
  const double G = 1 - (1 + shape.base.conic_constant) * shape.base.curvature * base_z, G_1 = std::min(1.0, G * G);
  const auto start = shape.base.meet(at.start, at.d);
  const double scale = 2 * (norm(at.hit) + norm(at.hit - start.point));
  const double e = 4 * u * (std::abs(at.hit.z) + p + w + of_sum.terms) + of_sum.value + (6 * u * (.5 * c * (r * r + m * w * w) + w + p) + 4 * u * w) / G_1 + 2 * u * scale;
  const double base_slope = c * r * (4 * u + (4 * u * (1 + m * c * c * r * r + m * c * w) + m * c * e) / G_1) / std::sqrt(G_1);
  return {e, of_sum.slope + base_slope, 8 * u * scale};
}
// What the iteration ends with, and the stale place, as there.
template <DepartsFromQuadric Shape>
HeightRounding height_rounding(const Shape& shape, const Place& at) {
  const surface::SagRounding of_sag = shape.rounding(at.hit.x, at.hit.y);
  const auto start = shape.base.meet(at.start, at.d);
  const double scale = 2 * (norm(at.hit) + norm(at.hit - start.point));
  return {of_sag.height + 4 * u * (std::abs(at.hit.z) + shape.height(at.hit.x, at.hit.y).magnitude) + 2 * u * scale, of_sag.slope, 8 * u * scale};
}
template <class Shape>
  requires DepartsFromConic<Shape> || DepartsFromQuadric<Shape>
Met met(const Shape& shape, const Place& at, const Vec3<Exact>& hit) {
  constexpr int directions = std::is_same_v<Shape, surface::BicubicGrid> ? 8 : 4;  // its second derivatives jump
  return met_height(shape, height_rounding(shape, at), directions, hit, at);
}

HeightRounding facet_rounding(const surface::Facets& facets, const Place& at) {
  const surface::Mesh& mesh = *facets.mesh;
  const double size = norm(at.hit) + norm(mesh.centre) + 2 * mesh.extent;
  return {8 * u * size * at.normal_length, 0, 8 * u * size};
}
Met met(const surface::Facets& facets, const Place& at, const Vec3<Exact>& hit) { return met_height(facets, facet_rounding(facets, at), 8, hit, at); }

Met met(const surface::Patches& patches, const Place& at, const Vec3<Exact>& hit) {
  HeightRounding off = facet_rounding(patches.facets, at);
  const std::uint32_t facet = patches.facets.facet_at(hit.x, hit.y);
  if (facet == surface::no_facet) return {infinite, infinite, infinite, infinite};
  const surface::CloughTocherPatch& patch = patches.patches[facet];
  double largest = 0;
  for (const double b : {patch.e01, patch.e12, patch.e20, patch.e10, patch.e21, patch.e02, patch.q0, patch.q1, patch.q2}) largest = std::max(largest, std::abs(b));
  off.z += 64 * u * largest;
  off.slope += 8 * u * at.normal_length + 3 * 64 * u * largest * (std::hypot(patch.m1_x, patch.m1_y) + std::hypot(patch.m2_x, patch.m2_y));
  return met_height(patches, off, 8, hit, at);
}

template <surface::RadialFunction function>
Met met(const surface::RadialPatches<function>& radial, const Place& at, const Vec3<Exact>& hit) {
  HeightRounding off = facet_rounding(radial.facets, at);
  const std::uint32_t facet = radial.facets.facet_at(hit.x, hit.y);
  if (facet == surface::no_facet) return {infinite, infinite, infinite, infinite};
  const auto& patch = radial.patches[facet];
  double terms = 0, slopes = std::abs(patch.b) + std::abs(patch.c);
  for (std::uint32_t k = patch.first; k < patch.first + patch.node_count; ++k) {
    const auto& node = radial.facets.mesh->vertices[radial.nodes[k]];
    const double dx = at.hit.x - node.x, dy = at.hit.y - node.y, r_squared = dx * dx + dy * dy, w = std::abs(radial.weights[k]);
    const auto value = radial.radial(r_squared, radial.shape_squared);  // ln r^2 is known to 2 u absolutely
    terms += w * (std::abs(value.phi) + r_squared), slopes += w * (std::abs(value.slope_over_r) + 1) * std::sqrt(r_squared);
  }
  const double count = patch.node_count + 16.0;
  off.z += count * u * (terms + std::abs(patch.a) + norm(at.hit) * (std::abs(patch.b) + std::abs(patch.c))) + 2 * u * terms;
  off.slope += count * u * slopes;
  return met_height(radial, off, 8, hit, at);
}

}  // namespace

RoundingBound rounding_bound(const View& view, int from, int number, const ExactRay& before, const ExactStep& step, const Uncertainty& given) {
  constexpr RoundingBound unknown{infinite, infinite, infinite, infinite, infinite};
  if (step.crossing.status != Status::ok) return unknown;
  double turning_frames = 0, carried = size_of(before.position);
  for (int passed = from + 1; passed <= number; ++passed) {
    turning_frames += view.scene.surface(passed).centred ? 0 : 1;
    carried += norm(view.scene.surface(passed).local_from_previous.translation);
  }
  const double entered = (16 * turning_frames + (number - from)) * u * carried;
  const Vec3<double> start = vec3_cast<double>(step.start), hit = vec3_cast<double>(step.crossing.point);
  AtGradient known{vec3_cast<double>(step.direction), entered + given.line, 16 * u * turning_frames + given.turn, 0, 0, view.index_before(number), view.index_behind(number), 0, 0, 0};
  const bool is_in_gradient = view.wavelength.gradient(number - 1) != nullptr, is_at_gradient = view.wavelength.has_gradient_at(number);
  if (is_at_gradient) {
    const std::optional<AtGradient> there = at_gradient(view, number, step, {known.line + 2 * u * norm(start), known.turn});
    if (!there) return unknown;
    known = *there;
  }
  // In a gradient the surface is met from beside the hit.
  const double path = is_in_gradient ? 0 : size_of(step.crossing.path);
  Place at{is_in_gradient ? hit : start, known.arriving, hit, vec3_cast<double>(step.crossing.normal), is_in_gradient ? 0 : static_cast<double>(step.crossing.path),
           size_of(step.crossing.along), size_of(step.crossing.normal), 0, known.turn};
  at.line = known.line + 2 * u * norm(at.start) + 16 * u * turning_frames * path;  // (1)

  const scene::Surface& surface = view.scene.surface(number);
  const Met met_at = std::visit([&]<class S>(const S& shape) {
    if constexpr (surface::has_closed_form<S>) return met(shape, at);
    else return met(shape, at, step.crossing.point);
  }, surface.shape);
  const double turned = met_at.normal / at.normal_length;
  if (!(turned < 0.1)) return unknown;

  const double index_before = known.index_before, index_behind = known.index_behind, in_path = met_at.hit + entered + given.line + (6 * u + length_error) * path;
  const double opl = known.opl + index_before * in_path + u * (size_of(step.behind.opl) + 2 * std::abs(known.path) + 2 * index_before * path);  // (7)
  const double n = at.normal_length;
  const auto with = [&](double direction) { return RoundingBound{met_at.hit, direction, opl, 2 * turned, at.turn}; };
  const trace::Deflection deflection = is_at_gradient && !surface.image && !surface.mirror ? trace::Deflection::refract : trace::deflection_at(surface, index_before, index_behind);
  switch (deflection) {
    case trace::Deflection::none: return with(at.turn + 2 * u);
    case trace::Deflection::reflect: return with(at.turn + 2 * met_at.along / n + 6 * at.s * met_at.normal / (n * n) + 20 * u * at.s / n + 8 * u);
    case trace::Deflection::refract: break;
  }
  const double mu = index_before / index_behind, q = std::abs((index_behind - index_before) * (index_behind + index_before) / (index_behind * index_behind));
  const double w = size_of(dot(step.behind.direction, step.crossing.normal)), v = mu * at.s;
  if (step.behind.ended != 0 || !(w > 0)) return unknown;
  // Of mu, relative: the indices at the hit; 16 u, within which those at both sides of it are the same (gradient_step.h).
  const double of_mu = is_at_gradient ? known.index_rounding + (known.slope_before / index_before + known.slope_behind / index_behind) * met_at.hit + 16 * u : 0;
  const double dq = 2 * mu * mu * of_mu, q_most = q + dq;
  const double w_squared = 2 * q_most * n * met_at.normal + mu * mu * met_at.along_squared + 10 * u * (q * n * n + v * v) + dq * n * n, dw = w_squared / w;  // (5)
  const bool has_unit_normals = !is_at_gradient && std::visit([]<class S>(const S&) { return surface::has_unit_normals<S>; }, surface.shape);
  const double gamma = q_most / (w + v), dv = mu * met_at.along + v * of_mu;
  const double dgamma = has_unit_normals ? dw + dv + 3 * u * (w + v) : gamma * ((dw + dv) / (w + v) + 12 * u) + dq / (w + v);
  return with(mu * (at.turn + length_error + of_mu) + gamma * met_at.normal + n * dgamma + 4 * u * (mu + gamma * n) + 8 * u);  // (6)
}

}  // namespace sagitta::study
