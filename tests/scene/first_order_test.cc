// SPDX-License-Identifier: Apache-2.0
#include "lib/scene/first_order.h"

#include <fmt/format.h>

#include <cmath>
#include <fstream>

#include "tests/support/random_system.h"

namespace sagitta::test {
namespace {

scene::FirstOrder first_order_of(const std::string& surfaces, const std::string& aperture = "entrance_pupil_diameter_mm: 4", const std::string& more = {}) {
  return scene_of(surfaces, aperture, more).first_order;
}

// A11. 4e-16 relative per operation on numbers up to 10.
TEST(FirstOrder, ball_lens_has_its_exact_focal_length) {
  const auto ball = [](const char* index) {
    return first_order_of(std::string("  - {stop: true, conic: {radius_mm: 5}, thickness_mm: 10, medium: {index: ") + index + "}}\n  - {conic: {radius_mm: -5}, thickness_mm: 5}\n  - {}\n");
  };
  EXPECT_NEAR(ball("1.5168").effective_focal_length, 7.337461300309597523219814241486, 1e-14);
  EXPECT_NEAR(ball("1.5168").back_focal_length, 2.337461300309597523219814241486, 1e-14);
  EXPECT_NEAR(ball("2").back_focal_length, 0, 1e-15);
  // both principal points in the centre
  EXPECT_NEAR(ball("1.5168").front_principal_point, 5, 2e-14);
  EXPECT_NEAR(ball("1.5168").rear_principal_point, 5, 2e-14);
}

TEST(FirstOrder, a_mirror_focuses_at_half_its_radius) {
  const scene::FirstOrder o = first_order_of("  - {stop: true, conic: {radius_mm: -200}, thickness_mm: -100, medium: mirror}\n  - {}\n");
  EXPECT_DOUBLE_EQ(o.effective_focal_length, 100);
  EXPECT_DOUBLE_EQ(o.rear_focal_point, -100);
  EXPECT_DOUBLE_EQ(o.back_focal_length, -100);  // along +z, as thicknesses
  EXPECT_DOUBLE_EQ(o.image_z, -100);
  EXPECT_EQ(o.exit_pupil.z, 0);
  EXPECT_EQ(o.exit_pupil.semi_diameter, 2);
}

// Thin lens of f = 100 and an object at 300: 1/s' = 1/f - 1/s, s' = 150; and a virtual object.
TEST(FirstOrder, image_of_a_finite_object_obeys_the_lens_equation) {
  const std::string lens = "  - {stop: true, conic: {radius_mm: 100}, thickness_mm: 0, medium: {index: 1.5}}\n  - {conic: {radius_mm: -100}, thickness_mm: 10}\n  - {}\n";
  EXPECT_NEAR(first_order_of(lens, "entrance_pupil_diameter_mm: 4", "object: {distance_mm: 300}\n").image_z, 150, 1e-12);
  EXPECT_NEAR(first_order_of(lens, "entrance_pupil_diameter_mm: 4", "object: {distance_mm: -100}\n").image_z, 50, 1e-12);
  // in the front focal plane: the image is at infinity, although 1/s' is rounding and not zero
  EXPECT_TRUE(std::isinf(first_order_of(lens, "entrance_pupil_diameter_mm: 4", "object: {distance_mm: 100}\n").image_z));
}

// Two thin lenses a sum of focal lengths apart; the second's is not a binary fraction, so rounding leaves some power.
TEST(FirstOrder, an_afocal_system_has_no_focal_length_although_rounding_leaves_some_power) {
  int count = 0;
  for (const double f1 : {100.0, 73.1, 51.3 / 0.513})
    for (const double f2 : {10.0, 35.7, -20.3, 1.1}) {
      const auto half = [](double f) { return fmt::format("{:.17g}", f * 0.513); };
      const scene::FirstOrder o = first_order_of(
          "  - {stop: true, conic: {radius_mm: " + half(f1) + "}, thickness_mm: 0, medium: {index: 1.513}}\n  - {thickness_mm: " + fmt::format("{:.17g}", f1 + f2) +
          "}\n  - {thickness_mm: 0, medium: {index: 1.513}}\n  - {conic: {radius_mm: " + half(-f2) + "}, thickness_mm: 10}\n  - {}\n");
      for (const double none : {o.effective_focal_length, o.front_focal_length, o.rear_focal_length, o.back_focal_length, o.front_focal_point,
                                o.rear_focal_point, o.front_principal_point, o.rear_principal_point, o.front_nodal_point, o.rear_nodal_point, o.image_z})
        EXPECT_FALSE(std::isfinite(none)) << f1 << ' ' << f2;
      EXPECT_EQ(o.power, 0);
      // the exit pupil is the first lens seen through the second: magnification -f2/f1
      EXPECT_NEAR(o.exit_pupil.semi_diameter, 2 * std::abs(f2 / f1), 1e-12);
      ++count;
    }
  EXPECT_EQ(count, 12);
}

TEST(FirstOrder, a_system_without_power_has_pupils_and_no_focal_length) {
  const scene::FirstOrder o = first_order_of("  - {thickness_mm: 5, medium: {index: 1.5}}\n  - {stop: true, thickness_mm: 5}\n  - {}\n");
  EXPECT_FALSE(std::isfinite(o.effective_focal_length));
  EXPECT_NEAR(o.entrance_pupil.z, 5 / 1.5, 1e-15);
  EXPECT_EQ(o.exit_pupil.z, 5);
  EXPECT_EQ(o.exit_pupil.semi_diameter, 2);
}

// A weak but real system is not taken for an afocal one: f = 1e9 mm from one surface.
TEST(FirstOrder, a_weak_lens_keeps_its_focal_length) {
  const scene::FirstOrder o = first_order_of("  - {stop: true, conic: {radius_mm: 5e8}, thickness_mm: 1, medium: {index: 1.5}}\n  - {}\n");
  EXPECT_NEAR(o.effective_focal_length, 1e9, 1e-6);
}

TEST(FirstOrder, dummy_surfaces_behind_the_last_acting_one_change_nothing) {
  const std::string lens = "  - {stop: true, conic: {radius_mm: 100}, thickness_mm: 3, medium: {index: 1.5}}\n  - {conic: {radius_mm: -100}, thickness_mm: 20}\n";
  const scene::FirstOrder a = first_order_of(lens + "  - {}\n"), b = first_order_of(lens + "  - {conic: {radius_mm: 7}, thickness_mm: 5}\n  - {conic: {radius_mm: -3}}\n");
  EXPECT_EQ(a.back_focal_length, b.back_focal_length);
  EXPECT_EQ(a.effective_focal_length, b.effective_focal_length);
  EXPECT_EQ(a.rear_focal_point, b.rear_focal_point);
  EXPECT_EQ(a.exit_pupil.z, b.exit_pupil.z);
}

// A32, with real rays: H = n (u_b y - u y_b) of a marginal and a chief ray so near the axis that they are paraxial (1e-5 of
// the system's size: third order 1e-15 relative) is the same at every surface, and pupils and focus are where real rays
// cross the axis.
TEST(FirstOrder, real_rays_near_the_axis_cross_at_pupils_and_focus_and_keep_the_lagrange_invariant) {
  Uniform u(31);
  int count = 0;
  double largest = 0;
  for (int i = 0; i < 300; ++i) {
    prescription::Model model = random_model(u, {.departures = false, .moved = false, .apertures = false});
    for (auto& surface : model.surfaces) surface.stop = false;
    const auto stop = static_cast<std::size_t>(u() * (static_cast<double>(model.surfaces.size()) - 1.001));
    model.surfaces[stop].stop = true;
    const CompiledScene compiled = checked(scene::compile(model));
    const scene::Scene& scene = compiled.scene;
    if (scene.surfaces.empty() || scene.pupil.telecentric) continue;
    const scene::FirstOrder& o = compiled.first_order;
    if (!(std::abs(o.entrance_pupil.z) < 100 && std::abs(o.exit_pupil.z) < 1000 && std::abs(o.rear_focal_point) < 1000)) continue;
    const double h = 1e-5;
    trace::RayBatch rays = batch_of({{{0, h, 0}, {0, 0, 1}},                                             // parallel to the axis
                                     {{0, 0, o.entrance_pupil.z}, numerics::normalized(Vec3<double>{0, h, 1})}});  // to the pupil's centre
    const auto invariant = [&](int gap) {
      return compiled.wavelength().index[static_cast<std::size_t>(gap)] * (rays.m[1] * rays.y[0] - rays.m[0] * rays.y[1]);
    };
    double at_stop = 1;
    const double before = invariant(0);
    int last = scene.surface_count() - 1;
    trace::RayBatch at_last;
    for (int number = 1; number < scene.surface_count(); ++number) {
      trace_surface(scene, compiled.wavelength(), number, rays);
      if (number == scene.stop) at_stop = rays.y[1];
      // transfer keeps it, and its sign follows the sense of travel as m does: n m y
      EXPECT_NEAR(invariant(number) / before, 1, 1e-7) << i;
    }
    EXPECT_EQ(count_statuses(rays)[surface::Status::ok], 2);
    EXPECT_NEAR(at_stop / h, 0, 1e-6) << i;
    const double z = scene.surface(last).axis_z;
    const auto crossing = [&](std::size_t k) { return z + rays.z[k] - rays.y[k] * rays.n[k] / rays.m[k]; };
    EXPECT_NEAR(crossing(0), o.rear_focal_point, 1e-6 * (1 + std::abs(o.rear_focal_point) + o.rear_focal_length * o.rear_focal_length));
    EXPECT_NEAR(crossing(1), o.exit_pupil.z, 1e-6 * (1 + o.exit_pupil.z * o.exit_pupil.z));
    EXPECT_NEAR(std::abs(h / rays.m[0]), std::abs(o.rear_focal_length), 1e-6 * std::abs(o.rear_focal_length));
    largest = std::max(largest, std::abs(o.effective_focal_length));
    ++count;
  }
  EXPECT_GE(count, 100);
}

// Points of a sphere in front of water: the power is that of the sphere. The quartic over the points nearest the
// vertex leaves r^6/(16 R^5) of the sag; with points within 1 mm (the nearest 100 of 2000 over a radius of 4.5 mm, or half
// the beam of 4 mm) this changes the second derivative by about its own, 30 r^4/(16 R^5) * (a fraction of one) < 7e-5 of
// 1/R = 0.128.
TEST(FirstOrder, the_power_of_a_sampled_sphere_is_that_of_the_sphere) {
  const Folder folder;
  std::string points = "x_mm y_mm z_mm\n";
  Uniform u(32);
  for (const auto& p : tests::uniform_random(2500, 4.5, 33))
    if (std::hypot(p.x, p.y) <= 4.5) points += fmt::format("{:.17g} {:.17g} {:.17g}\n", p.x, p.y, tests::sphere(7.8)(p.x, p.y));
  folder.file("cap.xyz", points);
  const std::string yaml = prescription_of("  - {stop: true, delaunay: {points: cap.xyz, format: xyz, interpolation: linear}, thickness_mm: 20, medium: {index: 1.336}}\n  - {}\n");
  const auto read = prescription::read_prescription(folder.file("s.yaml", yaml));
  ASSERT_TRUE(read.model);
  const CompiledScene compiled = checked(scene::compile(*read.model));
  EXPECT_NEAR(compiled.first_order.effective_focal_length, 7.8 / 0.336, 7.8 / 0.336 * 7e-5 / 0.128);
  EXPECT_NEAR(compiled.scene.surface(1).vertex_curvature, 1 / 7.8, 7e-5);
}

// The x section of a system is the y section of the same system with x and y exchanged, the stop being one.
TEST(FirstOrder, the_x_section_is_the_y_section_of_the_system_turned) {
  const auto system = [](const std::string& first, const std::string& last) {
    return compile_text(prescription_of("  - {" + first + ", thickness_mm: 3, medium: {index: 1.5}}\n  - {stop: true, thickness_mm: 2, medium: {index: 1.5}}\n  - {" + last +
                                            ", thickness_mm: 20}\n  - {}\n", "stop_diameter_mm: 3"));
  };
  const scene::CompileResult is = system("biconic: {radius_x_mm: 20, radius_y_mm: 30}", "toroid: {radius_rotation_mm: -40, radius_mm: -25, coefficients: {2: 1e-3}}");
  const scene::CompileResult turned = system("biconic: {radius_x_mm: 30, radius_y_mm: 20}", "conic: {radius_mm: -40}");
  ASSERT_TRUE(is.first_order_x && turned.scene);
  EXPECT_TRUE(turned.first_order_x);  // for its x section is that of the y section here no more
  for (const auto pupil : {&scene::FirstOrder::entrance_pupil, &scene::FirstOrder::exit_pupil}) {
    const scene::Pupil &of_x = (*is.first_order_x).*pupil, &of_y = turned.first_order.*pupil;
    EXPECT_NEAR(of_x.z, of_y.z, 1e-14);
    EXPECT_NEAR(of_x.semi_diameter, of_y.semi_diameter, 1e-14);
    EXPECT_GT(std::abs(of_x.z - (is.first_order.*pupil).z), .01);
  }
  const scene::CompileResult round = system("conic: {radius_mm: 20}", "zernike: {radius_mm: -30, normalization_radius_mm: 3, indexing: osa, coefficients_um: {4: 20, 12: -7, 24: 3}}");
  ASSERT_TRUE(round.scene);
  EXPECT_FALSE(round.first_order_x);
  // A toric retina refracts nothing (Atchison's eye, 2026-11-23: its x pupils were reported, the same as the others).
  const scene::CompileResult retina = compile_text(prescription_of("  - {stop: true, conic: {radius_mm: 7.8}, thickness_mm: 20, medium: {index: 1.336}}\n  - {biconic: {radius_x_mm: -12, radius_y_mm: -11}}\n"));
  ASSERT_TRUE(retina.scene);
  EXPECT_FALSE(retina.first_order_x);
}

}  // namespace
}  // namespace sagitta::test
