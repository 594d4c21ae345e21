// SPDX-License-Identifier: Apache-2.0
// Laws of geometrical optics on random rays through random systems. They are written with the rays before and behind each
// surface and the surface's slope; the tracer's own formulas play no part.
#include <cmath>
#include <limits>
#include <variant>

#include "tests/support/random_system.h"

namespace sagitta::test {
namespace {

using numerics::cross;
using numerics::dot;
using numerics::norm;
using numerics::normalized;
using numerics::RigidTransform;
using surface::Status;

// A ray at one surface, all in the surface's local frame.
struct Passage {
  Vec3<double> hit, before, after, normal;  // the normal is a unit vector with positive z
  double curvature;                          // of the slope, 1/mm
  bool acts, mirror;
  double index_before, index_after, path;    // path: from the hit before
};

Vec3<double> unit_normal(const surface::Shape& shape, double x, double y) {
  const auto g = std::visit([&](const auto& one) { return one.gradient(x, y); }, shape);
  return normalized(Vec3<double>{-g.x, -g.y, 1});
}

// All surfaces that a ray passes, until it ends or arrives.
std::vector<Passage> passages(const scene::Scene& scene, const scene::Wavelength& wavelength, const GlobalRay& ray) {
  std::vector<Passage> result;
  trace::RayBatch batch = batch_of({ray});
  for (int number = 1; number <= scene.surface_count(); ++number) {
    const scene::Surface& surface = scene.surface(number);
    const Vec3<double> before = surface.local_from_previous.rotation * batch.direction(0);
    const double opl = batch.opl[0];
    trace_surface(scene, wavelength, number, batch);
    if (batch.ended[0] != 0) break;
    const Vec3<double> hit = batch.position(0), normal = unit_normal(surface.shape, hit.x, hit.y);
    const double h = 1e-5, curvature = norm(unit_normal(surface.shape, hit.x + h, hit.y) - normal) / h +
                                       norm(unit_normal(surface.shape, hit.x, hit.y + h) - normal) / h;
    const auto gap = static_cast<std::size_t>(number);
    result.push_back({hit, before, batch.direction(0), normal, curvature, !surface.image, surface.mirror,
                      wavelength.index[gap - 1], wavelength.index[gap], (batch.opl[0] - opl) / wavelength.index[gap - 1]});
  }
  return result;
}

// Nothing on the ray's way magnifies errors much: no steep incidence, no strong curvature, all within 50 mm, where polynomials
// of the Zernike surfaces are within their radius.
bool tame(const Passage& at) {
  return std::abs(dot(at.normal, at.before)) > 0.3 && std::abs(dot(at.normal, at.after)) > 0.3 && at.normal.z > 0.5 &&
         at.curvature < 0.5 && norm(at.hit) < 10 && std::abs(at.path) < 50;
}
bool tame(const std::vector<Passage>& all) {
  return std::all_of(all.begin(), all.end(), [](const Passage& at) { return tame(at); });
}

// n (N x d) = n' (N x d') is Snell's law and the coplanarity of both rays with the normal in one; and refraction keeps
// the side, reflection changes it. The normal is taken at the traced hit, whose error of some 100 eps of up to 50 mm,
// larger at grazing incidence, turns it by that times the curvature: 1e-11 (1 + 50 curvature) is a thousand times
// the worst, and 1e-6 of what a wrong index makes.
TEST(Laws, snell_and_coplanarity_hold_at_every_surface) {
  Uniform u(1);
  int refracted = 0, reflected = 0, straight = 0, at_rim = 0;
  for (int i = 0; i < 20000; ++i) {
    const CompiledScene compiled = checked(scene::compile(random_model(u)));
    for (const GlobalRay& ray : random_rays(u, 10))
      for (const Passage& at : passages(compiled.scene, compiled.wavelength(), ray)) {
        EXPECT_NEAR(norm(at.after), 1, 1e-14);
        if (!(at.curvature < 10)) {  // at the rim of an ellipsoid
          ++at_rim;
          continue;
        }
        const double bound = 1e-11 * (1 + 50 * at.curvature);
        const Vec3<double> before = cross(at.normal, at.before), after = cross(at.normal, at.after);
        if (!at.acts) {
          EXPECT_EQ(at.before, at.after);
          continue;
        }
        EXPECT_LE(norm(at.index_before * before - at.index_after * after), bound);
        const bool same_side = dot(at.normal, at.before) * dot(at.normal, at.after) > 0;
        EXPECT_EQ(same_side, !at.mirror);
        ++(at.mirror ? reflected : at.index_before == at.index_after ? straight : refracted);
      }
  }
  EXPECT_GE(refracted, 30000);
  EXPECT_GE(reflected, 6000);
  EXPECT_GE(straight, 5000);
  EXPECT_LE(at_rim, 10);
}

// OPL is the sum of index times distance, negative where the light goes back along its line to a virtual hit.
TEST(Laws, optical_path_is_index_times_distance) {
  Uniform u(2);
  int count = 0, negative = 0;
  for (int i = 0; i < 2000; ++i) {
    const CompiledScene compiled = checked(scene::compile(random_model(u)));
    const scene::Scene& scene = compiled.scene;
    for (const GlobalRay& ray : random_rays(u, 5)) {
      const auto all = passages(scene, compiled.wavelength(), ray);
      Vec3<double> from = ray.p;
      for (std::size_t k = 0; k < all.size(); ++k) {
        const scene::Surface& surface = scene.surfaces[k];
        const Vec3<double> to = surface.global_from_local * all[k].hit;
        const double along = dot(to - from, surface.global_from_local.rotation * all[k].before);
        EXPECT_NEAR(all[k].path, along, 1e-12);
        EXPECT_NEAR(std::abs(along), norm(to - from), 1e-12);  // the hit lies on the ray
        const auto sag = std::visit([&](const auto& one) { return one.sag(all[k].hit.x, all[k].hit.y); }, surface.shape);
        EXPECT_NEAR(all[k].hit.z, sag, 1e-11 * (1 + 50 * all[k].curvature));  // and on the surface
        negative += along < 0;
        ++count;
        from = to;
      }
    }
  }
  EXPECT_GE(count, 25000);
  EXPECT_GE(negative, 1000);
}

// Fermat: the path from the hit before to the hit behind is stationary where the ray meets the surface. The hit is moved
// by h along the surface, in x and in y; the central difference has an error in h^2, which the extrapolation from h and
// h/2 takes away to h^4. With h = 1e-3 rounding leaves some 1e-16 * 50/1e-3 = 5e-12, and h^4 times the fifth derivative
// stays below 1e-9 where the neighbours are 0.5 mm away or more and the passage is tame. Left out: hits within h of an edge of a grid's
// cell, where second derivatives jump: the difference would be off by h/4 times the jump.
bool is_smooth_within(const surface::Shape& shape, const Vec3<double>& hit, double h) {
  const auto* grid = std::get_if<surface::BicubicGrid>(&shape);
  if (!grid) return true;
  const auto cell_of = [](double at, double first, double spacing) { return std::floor((at - first) / spacing); };
  return cell_of(hit.x - h, grid->first_x, grid->spacing_x) == cell_of(hit.x + h, grid->first_x, grid->spacing_x) &&
         cell_of(hit.y - h, grid->first_y, grid->spacing_y) == cell_of(hit.y + h, grid->first_y, grid->spacing_y);
}

TEST(Laws, fermat_optical_path_is_stationary) {
  Uniform u(3);
  int count = 0, on_grids = 0, on_edges = 0;
  for (int i = 0; i < 20000; ++i) {
    const CompiledScene compiled = checked(scene::compile(random_model(u)));
    const scene::Scene& scene = compiled.scene;
    for (const GlobalRay& ray : random_rays(u, 5)) {
      const auto all = passages(scene, compiled.wavelength(), ray);
      Vec3<double> start = ray.p;  // of the ray to surface k + 1, global
      for (std::size_t k = 0; k + 1 < all.size(); ++k) {
        const Passage& at = all[k];
        const auto& frame = scene.surfaces[k].global_from_local;
        const Vec3<double> from = frame.inverse() * start;
        const Vec3<double> to = frame.inverse() * (scene.surfaces[k + 1].global_from_local * all[k + 1].hit);
        start = frame * at.hit;
        if (!tame(at) || std::abs(at.path) < 0.5 || std::abs(all[k + 1].path) < 0.5) continue;
        if (!is_smooth_within(scene.surfaces[k].shape, at.hit, 1e-3)) {
          ++on_edges;
          continue;
        }
        const auto path = [&](double dx, double dy) {
          const double x = at.hit.x + dx, y = at.hit.y + dy;
          const Vec3<double> q{x, y, std::visit([&](const auto& one) { return one.sag(x, y); }, scene.surfaces[k].shape)};
          return std::copysign(at.index_before * norm(q - from), at.path) + std::copysign(at.index_after * norm(to - q), all[k + 1].path);
        };
        const auto slope = [&](double dx, double dy) {
          const auto difference = [&](double h) { return (path(h * dx, h * dy) - path(-h * dx, -h * dy)) / (2 * h); };
          return (4 * difference(5e-4) - difference(1e-3)) / 3;
        };
        EXPECT_LE(std::abs(slope(1, 0)), 1e-9);
        EXPECT_LE(std::abs(slope(0, 1)), 1e-9);
        on_grids += std::holds_alternative<surface::BicubicGrid>(scene.surfaces[k].shape);
        ++count;
      }
    }
  }
  EXPECT_GE(count, 3000);
  EXPECT_GE(on_grids, 100);
  EXPECT_LE(on_edges, on_grids / 50);  // 4 h over the spacing of 0.8 mm
}

// The same surfaces in the opposite order, behind them the plane of the start.
scene::Scene reversed(const scene::Scene& scene, scene::Wavelength& wavelength, const GlobalRay& start) {
  scene::Scene result = scene;
  result.surfaces.assign(scene.surfaces.rbegin() + 1, scene.surfaces.rend());
  scene::Surface last;
  last.shape = surface::Plane{};
  last.global_from_local.translation = start.p;
  result.surfaces.push_back(last);
  RigidTransform<double> before;
  for (scene::Surface& surface : result.surfaces) {
    surface.local_from_previous = surface.global_from_local.inverse() * before;
    surface.centred = false;
    surface.image = false;
    before = surface.global_from_local;
  }
  result.surfaces.back().image = true;
  wavelength.index.pop_back();  // behind the image surface
  std::reverse(wavelength.index.begin(), wavelength.index.end());
  wavelength.index.push_back(wavelength.index.back());
  return result;
}

// Sent back from where it arrived, a ray takes the same way to its start; OPL is the same. 1e-12 of the system's size of
// about 50 mm. Left out: where the ray leaves a surface so that the hit the contract defines is another one for
// it than for the ray that came (it turns back in z at a refraction), and what is not tame.
TEST(Laws, a_ray_sent_back_returns_to_its_start) {
  Uniform u(4);
  int count = 0, past_base = 0;
  for (int i = 0; i < 20000; ++i) {
    const CompiledScene compiled = checked(scene::compile(random_model(u)));
    for (const GlobalRay& ray : random_rays(u, 5)) {
      const auto all = passages(compiled.scene, compiled.wavelength(), ray);
      if (all.size() != compiled.scene.surfaces.size()) continue;
      const bool turns_back = std::any_of(all.begin(), all.end(), [](const Passage& at) {
        return (dot(at.normal, at.before) > 0) != (at.before.z > 0) || (dot(at.normal, at.after) > 0) != (at.after.z > 0);
      });
      if (turns_back || !tame(all)) continue;
      trace::RayBatch forth = batch_of({ray});
      trace::trace(compiled.scene, compiled.wavelength(), forth);
      const GlobalRay end = global_ray(compiled.scene, forth, 0);
      scene::Wavelength wavelength = compiled.wavelength();
      const scene::Scene back_scene = reversed(compiled.scene, wavelength, ray);
      trace::RayBatch back = batch_of({{end.p, -end.d}});
      trace::trace(back_scene, wavelength, back);
      if (back.status(0) == Status::missed) {  // the line behind a surface that departs from a base may pass by the base
        EXPECT_FALSE(std::visit([]<class S>(const S&) { return surface::has_closed_form<S>; }, back_scene.surface(back.ended_at(0)).shape));
        ++past_base;
        continue;
      }
      ASSERT_EQ(back.ended[0], 0);
      const GlobalRay home = global_ray(back_scene, back, 0);
      EXPECT_LE(norm(home.p - ray.p), 50e-12);
      EXPECT_LE(norm(home.d + ray.d), 5e-12);
      EXPECT_NEAR(back.opl[0], forth.opl[0], 50e-12);
      ++count;
    }
  }
  EXPECT_GE(count, 1500);
  EXPECT_LE(past_base, 3);
}

// The angles of R = Rx Ry Rz, in degrees.
Vec3<double> tilt_of(const numerics::Rotation<double>& r) {
  const double degrees = 180 / std::acos(-1.0);
  return {degrees * std::atan2(-r.row_y.z, r.row_z.z), degrees * std::asin(r.row_x.z), degrees * std::atan2(-r.row_x.y, r.row_x.x)};
}

// System and rays moved by 1e3 mm and turned by 37 degrees, the system by the decenter and tilt of each surface: the
// results move with them, to 1e-12 of the scale of 1e3 mm.
TEST(Laws, moving_system_and_rays_together_changes_nothing) {
  Uniform u(5);
  int count = 0;
  const double angle = 37 * std::acos(-1.0) / 180;
  for (int i = 0; i < 2000; ++i) {
    const prescription::Model model = random_model(u);
    const CompiledScene compiled = checked(scene::compile(model));
    const RigidTransform<double> move{numerics::rotation_about_new_axes(u(-1, 1) * angle, angle, u(-1, 1) * angle), {600, -500, 620}};
    prescription::Model moved = model;
    for (std::size_t k = 0; k < moved.surfaces.size(); ++k) {
      const RigidTransform<double> frame = move * compiled.scene.surfaces[k].global_from_local;
      moved.surfaces[k].decenter_mm = frame.translation - Vec3<double>{0, 0, compiled.scene.surfaces[k].axis_z};
      moved.surfaces[k].tilt_deg = tilt_of(frame.rotation);
    }
    const CompiledScene other = checked(scene::compile(moved));
    std::vector<GlobalRay> rays = random_rays(u, 5), moved_rays = rays;
    for (GlobalRay& ray : moved_rays) ray = {move * ray.p, move.rotation * ray.d};
    trace::RayBatch a = batch_of(rays), b = batch_of(moved_rays);
    trace::trace(compiled.scene, compiled.wavelength(), a);
    trace::trace(other.scene, other.wavelength(), b);
    for (std::size_t k = 0; k < rays.size(); ++k) {
      if (!tame(passages(compiled.scene, compiled.wavelength(), rays[k]))) continue;
      ASSERT_EQ(a.ended[k], b.ended[k]);
      const GlobalRay here = global_ray(compiled.scene, a, k), there = global_ray(other.scene, b, k);
      EXPECT_LE(norm(move * here.p - there.p), 1e-9);
      EXPECT_LE(norm(move.rotation * here.d - there.d), 1e-11);
      EXPECT_NEAR(a.opl[k], b.opl[k], 1e-9);
      count += a.ended[k] == 0;
    }
  }
  EXPECT_GE(count, 1000);
}

// x -> -x turns only signs, in every operation: the same bits.
TEST(Laws, mirror_symmetry_in_x_is_exact) {
  Uniform u(6);
  int count = 0;
  for (int i = 0; i < 2000; ++i) {
    prescription::Model model = random_model(u, {.departures = false});
    for (auto& surface : model.surfaces) surface.tilt_deg.z = 0;  // its sine and cosine mix x and y: not bit by bit
    const CompiledScene compiled = checked(scene::compile(model));
    prescription::Model flipped = model;
    for (auto& surface : flipped.surfaces) surface.decenter_mm.x *= -1, surface.tilt_deg.y *= -1;
    const CompiledScene other = checked(scene::compile(flipped));
    std::vector<GlobalRay> rays = random_rays(u, 5), flipped_rays = rays;
    for (GlobalRay& ray : flipped_rays) ray.p.x *= -1, ray.d.x *= -1;
    trace::RayBatch a = batch_of(rays), b = batch_of(flipped_rays);
    trace::trace(compiled.scene, compiled.wavelength(), a);
    trace::trace(other.scene, other.wavelength(), b);
    for (std::size_t k = 0; k < rays.size(); ++k, ++count) {
      EXPECT_EQ(a.ended[k], b.ended[k]);
      EXPECT_EQ(a.position(k), (Vec3<double>{-b.x[k], b.y[k], b.z[k]}));
      EXPECT_EQ(a.direction(k), (Vec3<double>{-b.l[k], b.m[k], b.n[k]}));
      EXPECT_EQ(a.opl[k], b.opl[k]);
    }
  }
  EXPECT_EQ(count, 10000);
}

// All lengths times 1e3 and 1e-3: all results too. 1e-12 of the system's size of 50 mm.
TEST(Laws, a_scaled_system_gives_scaled_results) {
  Uniform u(7);
  int count = 0;
  for (int i = 0; i < 2000; ++i) {
    const prescription::Model model = random_model(u);
    const CompiledScene compiled = checked(scene::compile(model));
    const std::vector<GlobalRay> rays = random_rays(u, 5);
    trace::RayBatch a = batch_of(rays);
    trace::trace(compiled.scene, compiled.wavelength(), a);
    for (const double scale : {1e3, 1e-3}) {
      prescription::Model scaled = model;
      for (auto& surface : scaled.surfaces) {
        surface.thickness_mm *= scale;
        surface.decenter_mm = scale * surface.decenter_mm;
        surface.semi_diameter_mm *= scale;
        surface.inner_semi_diameter_mm *= scale;
        scale_shape(surface.shape, scale);
      }
      const CompiledScene other = checked(scene::compile(scaled));
      std::vector<GlobalRay> scaled_rays = rays;
      for (GlobalRay& ray : scaled_rays) ray.p = scale * ray.p;
      trace::RayBatch b = batch_of(scaled_rays);
      trace::trace(other.scene, other.wavelength(), b);
      for (std::size_t k = 0; k < rays.size(); ++k) {
        if (!tame(passages(compiled.scene, compiled.wavelength(), rays[k]))) continue;
        ASSERT_EQ(a.ended[k], b.ended[k]);
        EXPECT_LE(norm(scale * a.position(k) - b.position(k)), 50e-12 * scale);
        EXPECT_LE(norm(a.direction(k) - b.direction(k)), 5e-12);
        EXPECT_NEAR(scale * a.opl[k], b.opl[k], 50e-12 * scale);
        count += a.ended[k] == 0;
      }
    }
  }
  EXPECT_GE(count, 2000);
}

// A conic with K = 0 against the sphere by its centre: |p - C| = |R|, and the ray behind it obeys Snell about p - C.
TEST(Laws, conic_constant_zero_is_the_sphere) {
  Uniform u(8);
  int count = 0;
  for (int i = 0; i < 2000; ++i) {
    const double radius = (u() < 0.5 ? -1 : 1) * u(4, 40), index = u(1.1, 1.9);
    prescription::Model model;
    model.wavelengths_nm = {550};
    model.surfaces = {surface_of(conic_shape(radius, 0), 0, index), surface_of({}, 0, 1)};
    model.surfaces.front().stop = true;
    const CompiledScene compiled = checked(scene::compile(model));
    for (const GlobalRay& ray : random_rays(u, 5)) {
      const auto all = passages(compiled.scene, compiled.wavelength(), ray);
      if (all.empty()) continue;
      const Vec3<double> centre{0, 0, radius}, from_centre = all[0].hit - centre;
      EXPECT_NEAR(norm(from_centre), std::abs(radius), 40e-15);
      EXPECT_LT(std::abs(all[0].hit.z), std::abs(radius));  // on the vertex's side of the equator
      EXPECT_LE(norm(cross(from_centre, all[0].before) - index * cross(from_centre, all[0].after)), 1e-14 * std::abs(radius));
      ++count;
    }
  }
  EXPECT_GE(count, 9000);
}

// A surface of facets, as shipped: no ray is lost in silence, nothing is NaN, and at the facet that the slope at the hit
// belongs to Snell's law holds. On an edge, within rounding, the slope may be the neighbour's: rarer than one in a thousand.
TEST(Laws, hold_on_a_surface_of_facets) {
  const auto read = prescription::read_prescription(SAGITTA_SOURCE_DIR "/systems/cornea-delaunay.yaml");
  ASSERT_TRUE(read.model);
  const CompiledScene compiled = checked(scene::compile(*read.model));
  Uniform u(9);
  int refracted = 0, on_edge = 0;
  std::array<int, surface::status_count> of{};
  for (const GlobalRay& ray : random_rays(u, 20000)) {
    trace::RayBatch batch = batch_of({ray});
    trace_surface(compiled.scene, compiled.wavelength(), 1, batch);
    for (const auto* column : {&batch.x, &batch.y, &batch.z, &batch.l, &batch.m, &batch.n, &batch.opl}) EXPECT_TRUE(std::isfinite(column->front()));
    ++of[static_cast<std::size_t>(batch.status(0))];
    if (batch.ended[0] != 0) continue;
    const Vec3<double> hit = batch.position(0), normal = unit_normal(compiled.scene.surface(1).shape, hit.x, hit.y);
    EXPECT_LE(norm(cross(hit - ray.p, ray.d)), 1e-14);
    const double index = compiled.wavelength().index[1];
    ++(norm(cross(normal, ray.d) - index * cross(normal, batch.direction(0))) <= 1e-14 ? refracted : on_edge);
  }
  EXPECT_EQ(refracted + on_edge, of[0]);
  EXPECT_EQ(of[0] + of[static_cast<std::size_t>(Status::outside_data)], 20000);
  EXPECT_GE(of[0], 15000);
  EXPECT_GE(of[static_cast<std::size_t>(Status::outside_data)], 100);
  EXPECT_LE(on_edge, 15);
}

}  // namespace
}  // namespace sagitta::test
