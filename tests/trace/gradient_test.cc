// SPDX-License-Identifier: Apache-2.0
// Systems with gradient-index media, from the prescription to the image.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>

#include "lib/analysis/wavefront.h"
#include "lib/trace/pattern.h"
#include "tests/support/prescriptions.h"

namespace sagitta::trace {
namespace {

using test::batch_of, test::CompiledScene, test::global_ray, test::GlobalRay, test::scene_of;

CompiledScene system_of(const std::string& name) {
  const auto read = prescription::read_prescription(SAGITTA_SOURCE_DIR "/systems/" + name + ".yaml");
  for (const auto& finding : read.findings.all()) ADD_FAILURE() << format(finding);
  if (!read.model) return {};
  return test::checked(scene::compile(*read.model));
}

GlobalRay traced(const CompiledScene& system, const GlobalRay& ray) {
  RayBatch batch = batch_of({ray});
  trace(system.scene, system.scene.primary, batch);
  EXPECT_EQ(batch.status(0), Status::ok);
  return global_ray(system.scene, batch, 0);
}

// references.md, E12 and E14; T25: z counts from the vertex that the medium follows.
TEST(Gradient, TheLiouBrennanEyeHasItsPublishedPowerAndFocus) {
  const CompiledScene eye = system_of("liou-brennan-eye");
  EXPECT_NEAR(1000 * eye.first_order.power, 60.3428, 1e-4);
  EXPECT_NEAR(eye.first_order.rear_focal_point, 23.95001, 1e-5);
}
TEST(Gradient, AxialRaysOfTheLiouBrennanEyeCrossTheAxisWhereTheyShould) {
  const CompiledScene eye = system_of("liou-brennan-eye");
  const double crossings[]{23.92558414, 23.85406230, 23.74089222};
  for (int h = 1; h <= 3; ++h) {
    const GlobalRay ray = traced(eye, {{0, double(h), -5}, {0, 0, 1}});
    EXPECT_NEAR(ray.p.z - ray.p.y * ray.d.z / ray.d.y, crossings[h - 1], 1e-7) << h;
  }
}
TEST(Gradient, AThinParaxialRayOfTheLiouBrennanEyeGoesThroughItsFocus) {
  const CompiledScene eye = system_of("liou-brennan-eye");
  const GlobalRay ray = traced(eye, {{0, 1e-4, -5}, {0, 0, 1}});  // the spherical aberration of 1e-4 mm is 2e-10
  EXPECT_NEAR(ray.p.z - ray.p.y * ray.d.z / ray.d.y, eye.first_order.rear_focal_point, 1e-8);
}

// The same lens reversed (T3): z -> -z, each half's polynomial about its other vertex.
TEST(Gradient, ALensOfTwoGradientsIsTheSameFromBehind) {
  const std::string grad_a = "{grin: {polynomial: {index: 1.368, z_coefficients: {1: 0.049057, 2: -0.015427}, r_coefficients: {2: -0.001978}}}}";
  const std::string grad_p = "{grin: {polynomial: {index: 1.407, z_coefficients: {2: -0.006605}, r_coefficients: {2: -0.001978}}}}";
  const std::string back_p = "{grin: {polynomial: {index: 1.3679981355, z_coefficients: {1: 0.0321003, 2: -0.006605}, r_coefficients: {2: -0.001978}}}}";
  const std::string back_a = "{grin: {polynomial: {index: 1.4069996313, z_coefficients: {1: 8.6e-7, 2: -0.015427}, r_coefficients: {2: -0.001978}}}}";
  const CompiledScene forward = scene_of("  - {stop: true, conic: {radius_mm: 12.4, conic_constant: -0.94}, thickness_mm: 1.59, medium: " + grad_a + "}\n  - {thickness_mm: 2.43, medium: " +
                                         grad_p + "}\n  - {conic: {radius_mm: -8.1, conic_constant: 0.96}, thickness_mm: 5}\n  - {}\n");
  const CompiledScene reversed = scene_of("  - {stop: true, conic: {radius_mm: 8.1, conic_constant: 0.96}, thickness_mm: 2.43, medium: " + back_p + "}\n  - {thickness_mm: 1.59, medium: " +
                                          back_a + "}\n  - {conic: {radius_mm: -12.4, conic_constant: -0.94}, thickness_mm: 5}\n  - {}\n");
  EXPECT_NEAR(reversed.first_order.power, forward.first_order.power, 1e-10);
  const GlobalRay there = traced(forward, {{0.3, 1.5, -5}, numerics::normalized(Vec3<double>{0.02, -0.1, 1})});
  const Vec3<double> start{there.p.x, there.p.y, 4.02 - there.p.z};
  const GlobalRay back = traced(reversed, {start, {-there.d.x, -there.d.y, there.d.z}});
  const double to_start = (9.02 - back.p.z) / back.d.z;  // z = -5 mirrored
  EXPECT_NEAR(back.p.x + to_start * back.d.x, 0.3, 1e-8);  // the reversed coefficients have 10 digits
  EXPECT_NEAR(back.p.y + to_start * back.d.y, 1.5, 1e-8);
}

TEST(Gradient, TheIndexOfALensRisesWithTheMediumThatItDispersesAs) {
  const CompiledScene eye = system_of("liou-brennan-eye");
  const auto index_at_vertex = [](const scene::Wavelength& wavelength) { return std::get<gradient_index::Polynomial>(wavelength.gradient(4)->form).index; };
  EXPECT_EQ(index_at_vertex(eye.scene.wavelengths[0]), 1.368);
  for (const auto& wavelength : eye.scene.wavelengths) {
    const double L = wavelength.wavelength_um, reference = 0.555;
    EXPECT_NEAR(index_at_vertex(wavelength), 1.368 - 0.1455 * (L - reference) + 0.0961 * (L * L - reference * reference), 1e-12);
    EXPECT_NEAR(wavelength.index[1] - 1.376, index_at_vertex(wavelength) - 1.368, 1e-12);
  }
}

// Spots of no size and wavefronts of no error: n = 1 at the rim, so the image is sharp however oblique the bundle.
TEST(Gradient, TheExactSystemsAreSharp) {
  for (const std::string name : {"luneburg-lens", "maxwell-fisheye"}) {
    const CompiledScene system = system_of(name);
    for (const scene::Field& field : system.scene.fields) {
      RayBatch rays = launch(system.scene, field, 1, pupil_points({PatternKind::hexapolar}, 300));
      trace(system.scene, system.scene.primary, rays);
      RayBatch chief = launch(system.scene, field, 1, std::vector<PupilPoint>{{0, 0}});
      trace(system.scene, system.scene.primary, chief);
      for (std::size_t i = 0; i < rays.size(); ++i) {
        ASSERT_EQ(rays.status(i), Status::ok) << name << " ray " << i;
        EXPECT_LE(norm(rays.position(i) - chief.position(0)), 1e-11) << name;
        EXPECT_NEAR(rays.optical_path_length(i), chief.optical_path_length(0), 1e-11) << name;
      }
      const auto wavefront = analysis::wavefront(system.scene, system.scene.primary, field, {});
      ASSERT_TRUE(wavefront.wavefront) << wavefront.reason;
      EXPECT_LE(wavefront.wavefront->peak_to_valley_waves, 1e-7) << name;  // 5e-11 mm
    }
  }
}
TEST(Gradient, TheFocusOfASelfocRodIsThatOfItsPitch) {
  const CompiledScene rod = system_of("selfoc-rod");
  EXPECT_NEAR(rod.first_order.effective_focal_length, 1 / (1.6 * 0.3), 1e-12);
  EXPECT_NEAR(rod.first_order.back_focal_length, 0, 1e-12);
}

// A mirror in the middle of a rod: what follows it is the same medium, seen from behind. It is the rod of twice the length.
TEST(Gradient, BehindAMirrorIsTheMediumBeforeIt) {
  const std::string medium = "{grin: {polynomial: {index: 1.5, z_coefficients: {1: 0.01, 2: -0.004}, r_coefficients: {2: -0.02, 4: 0.0001}}}}";
  const CompiledScene folded = scene_of("  - {stop: true, thickness_mm: 3, medium: " + medium + "}\n  - {thickness_mm: -3, medium: mirror}\n  - {thickness_mm: -1}\n  - {}\n");
  // Light that comes back from the mirror's plane sees the index that it saw on the way: a plane mirror turns the ray, which then does what a ray from there would.
  const CompiledScene there = scene_of("  - {stop: true, thickness_mm: 3, medium: " + medium + "}\n  - {thickness_mm: 0, medium: {index: 1.494}}\n  - {}\n");
  const GlobalRay ray{{0.2, 0.7, -1}, numerics::normalized(Vec3<double>{0.05, -0.1, 1})};
  const GlobalRay back = traced(folded, ray);
  EXPECT_LT(back.d.z, 0);
  // Sent back from where it came out, it returns.
  RayBatch reversed = batch_of({{back.p, -back.d}});
  trace(folded.scene, folded.scene.primary, reversed);
  ASSERT_EQ(reversed.status(0), Status::ok);
  const GlobalRay again = global_ray(folded.scene, reversed, 0);
  EXPECT_LE(std::abs(dot(again.d, -ray.d) - 1), 1e-12);
  const Vec3<double> off = again.p - ray.p;
  EXPECT_LE(norm(off - dot(off, ray.d) * ray.d), 1e-11);
  EXPECT_EQ(folded.scene.wavelengths[0].gradient(2)->axial_shift, 3);
}

// The medium goes with the surface that it follows: a system that is decentred and tilted as a whole does the same.
TEST(Gradient, TheMediumMovesWithItsSurface) {
  const std::string medium = "{grin: {quadratic: {index: 1.5, x_per_mm: 0.05, y_per_mm: -0.02, z_per_mm: 0.03, x2_per_mm2: -0.02, y2_per_mm2: 0.01}}}";
  const CompiledScene plain = scene_of("  - {stop: true, thickness_mm: 4, medium: " + medium + "}\n  - {thickness_mm: 0}\n  - {}\n");
  const CompiledScene moved = scene_of("  - {stop: true, decenter_mm: [1, -2, 0.5], tilt_deg: [20, 10, 30], thickness_mm: 4, medium: " + medium +
                                       "}\n  - {decenter_mm: [0, 0, 0], thickness_mm: 0}\n  - {}\n");
  const auto& frame = moved.scene.surface(1).global_from_local;
  const GlobalRay ray{{0.2, 0.3, 0}, numerics::normalized(Vec3<double>{0.1, 0.2, 1})};
  RayBatch in_plain = batch_of({ray}), in_moved = batch_of({{frame * ray.p, frame.rotation * ray.d}});
  trace_surface(plain.scene, plain.scene.primary, 1, in_plain);
  trace_surface(moved.scene, moved.scene.primary, 1, in_moved);
  EXPECT_LE(norm(in_plain.direction(0) - in_moved.direction(0)), 1e-15);
  trace_surface(moved.scene, moved.scene.primary, 2, in_moved);
  ASSERT_EQ(in_moved.status(0), Status::ok);
  // Where the moved ray comes out, in the medium's frame, the plain system has it too: on a plane tilted the other way.
  const Vec3<double> out = frame.inverse() * global_position(moved.scene, 2, in_moved, 0);
  const auto& tilt = frame.rotation;
  const CompiledScene tilted = [&] {
    CompiledScene result = scene_of("  - {stop: true, thickness_mm: 4, medium: " + medium + "}\n  - {thickness_mm: 0}\n  - {}\n");
    result.scene.surfaces[1].local_from_previous = moved.scene.surface(2).local_from_previous;
    result.scene.surfaces[1].centred = false;
    return result;
  }();
  trace_surface(tilted.scene, tilted.scene.primary, 2, in_plain);
  EXPECT_LE(norm(tilted.scene.surface(2).local_from_previous.inverse() * in_plain.position(0) - out), 1e-14);
  EXPECT_GT(norm(out - Vec3<double>{0.2 + 0.1 * 4, 0.3 + 0.2 * 4, 4}), 0.05);
  EXPECT_GT(std::abs(tilt.row_x.y), 0.1);
}

// The pull of a medium is turned into the frame of the surface that ends it: before a tilted plane the ray is the parabola r = r0 + p0 t + l t^2/4 that it is in the
// medium's own frame, with n^2 = n0^2 + l.r along it. 1e-12 mm: the tolerance of the few steps that there are.
TEST(Gradient, ARayBeforeATiltedPlaneIsAParabola) {
  const Vec3<double> l{0.4, -0.3, 0};
  const CompiledScene tilted = scene_of("  - {stop: true, thickness_mm: 4, medium: {grin: {quadratic: {index: 1.5, x_per_mm: 0.4, y_per_mm: -0.3}}}}\n  - {tilt_deg: [20, -15, 30]}\n");
  const Vec3<double> start{0.2, 0.5, 0};
  const double n2 = 1.5 * 1.5 + dot(l, start);
  const GlobalRay end = traced(tilted, {start, {0, 0, 1}});
  const double t = end.p.z / std::sqrt(n2);  // l has no z
  EXPECT_LE(norm(end.p - (start + Vec3<double>{0, 0, end.p.z} + t * t / 4 * l)), 1e-12);
  EXPECT_LE(norm(end.d - numerics::normalized(Vec3<double>{t / 2 * l.x, t / 2 * l.y, std::sqrt(n2)})), 1e-12);
  EXPECT_GT(t * t / 4 * norm(l), 0.5);
}

// A plane in the middle with the rest of the medium behind it is nothing.
TEST(Gradient, APlaneWithinAMediumChangesNothing) {
  const CompiledScene one = scene_of("  - {stop: true, thickness_mm: 6, medium: {grin: {luneburg: {radius_mm: 5, center_z_mm: 3}}}}\n  - {thickness_mm: 1}\n  - {}\n");
  const CompiledScene two = scene_of("  - {stop: true, thickness_mm: 2, medium: {grin: {luneburg: {radius_mm: 5, center_z_mm: 3}}}}\n"
                                     "  - {thickness_mm: 4, medium: {grin: {luneburg: {radius_mm: 5, center_z_mm: 1}}}}\n  - {thickness_mm: 1}\n  - {}\n");
  const GlobalRay ray{{0.2, 1, -1}, numerics::normalized(Vec3<double>{0.1, 0.2, 1})};
  const GlobalRay a = traced(one, ray), b = traced(two, ray);
  EXPECT_LE(norm(a.p - b.p), 1e-12);
  EXPECT_LE(norm(a.d - b.d), 1e-12);
  EXPECT_NEAR(one.first_order.power, two.first_order.power, 1e-13);
  EXPECT_NEAR(one.first_order.rear_focal_point, two.first_order.rear_focal_point, 1e-11);
}

TEST(Gradient, ARayHasTheSameBitsOnAnyNumberOfThreadsAndSurfaceBySurface) {
  const CompiledScene eye = system_of("liou-brennan-eye");
  const RayBatch launched = launch(eye.scene, eye.scene.fields[1], 1, pupil_points({PatternKind::hexapolar}, 1000));
  RayBatch one = launched, three = launched;
  trace(eye.scene, eye.scene.primary, one, 1);
  trace(eye.scene, eye.scene.primary, three, 3);
  SurfaceBySurface listing(eye.scene, eye.scene.primary, launched);
  const RayBatch* listed = nullptr;
  for (int number = 1; number <= eye.scene.surface_count(); ++number) listed = &listing.next();
  for (const RayBatch* other : {static_cast<const RayBatch*>(&three), listed}) {
    EXPECT_EQ(one.x, other->x);
    EXPECT_EQ(one.n, other->n);
    EXPECT_EQ(one.opl, other->opl);
    EXPECT_EQ(one.ended, other->ended);
  }
}

// As one that leaves it (tests/gradient_index).
TEST(Gradient, ARayThatComesToAMediumWhereItHasNoIndexMissesIt) {
  const CompiledScene rod = scene_of("  - {stop: true, thickness_mm: 6, medium: {grin: {selfoc: {index: 1.6, g_per_mm: 0.3}}}}\n  - {}\n");  // r < 3.33 mm
  RayBatch rays = batch_of({{{0, 3.4, -1}, {0, 0, 1}}, {{0, 3.3, -1}, {0, 0, 1}}});
  trace(rod.scene, rod.scene.primary, rays);
  EXPECT_EQ(rays.status(0), Status::missed);
  EXPECT_EQ(rays.ended_at(0), 1);
  EXPECT_EQ(rays.position(0), (Vec3<double>{0, 3.4, -1}));  // its last good place
  EXPECT_EQ(rays.status(1), Status::ok);
}

// At the rim of Luneburg's lens the index is that of what is around it, but for the rounding of where the ray meets it: nothing is refracted, to the last bit, however
// nearly the ray grazes.
TEST(Gradient, WhereTheIndexIsThatOfWhatIsAroundItNothingIsRefracted) {
  const CompiledScene ball = scene_of("  - {stop: true, thickness_mm: 1, medium: {index: 1.3}}\n"
                                      "  - {conic: {radius_mm: 7.3}, thickness_mm: 1, medium: {grin: {luneburg: {index: 1.3, radius_mm: 7.3, center_z_mm: 7.3}}}}\n  - {}\n");
  std::vector<GlobalRay> given;
  for (int i = 0; i < 100; ++i) {
    const double h = 7.3 * (1 - std::pow(10.0, -0.1 * i)), azimuth = i;
    given.push_back({{h * std::cos(azimuth), h * std::sin(azimuth), -3}, {0, 0, 1}});
  }
  RayBatch rays = batch_of(given);
  trace_surface(ball.scene, ball.scene.primary, 1, rays);
  const RayBatch arriving = rays;
  trace_surface(ball.scene, ball.scene.primary, 2, rays);
  for (std::size_t i = 0; i < given.size(); ++i) {
    ASSERT_EQ(rays.status(i), Status::ok) << i;
    EXPECT_EQ(rays.direction(i), arriving.direction(i)) << i;
  }
}

TEST(Gradient, AnImageThatEndsAGradientHasASpotButNoWavefront) {
  const CompiledScene rod = scene_of("  - {stop: true, thickness_mm: 5.235987755982989, medium: {grin: {selfoc: {index: 1.6, g_per_mm: 0.3}}}}\n  - {}\n", "entrance_pupil_diameter_mm: 0.1");
  EXPECT_NEAR(rod.first_order.effective_focal_length, 1 / 0.48, 1e-12);
  EXPECT_NEAR(rod.first_order.rear_focal_length, 1.6 / 0.48, 1e-12);  // as if the rod's axis went on
  const auto result = analysis::wavefront(rod.scene, rod.scene.primary, rod.scene.fields[0], {});
  EXPECT_FALSE(result.wavefront);
  EXPECT_NE(result.reason.find("gradient-index"), std::string::npos) << result.reason;
  RayBatch rays = launch(rod.scene, rod.scene.fields[0], 1, pupil_points({PatternKind::hexapolar}, 60));
  trace(rod.scene, rod.scene.primary, rays);
  for (std::size_t i = 0; i < rays.size(); ++i) EXPECT_LE(std::hypot(rays.x[i], rays.y[i]), 1e-4);  // g^2 r^3, and a few times that
}

TEST(Gradient, ACoarserToleranceOfTheSystemTakesFewerSteps) {
  const auto lens = [](const std::string& tolerance) {
    return scene_of("  - {stop: true, thickness_mm: 200, medium: {grin: {selfoc: {index: 1.6, g_per_mm: 0.3}}}}\n  - {}\n", "entrance_pupil_diameter_mm: 0.1", tolerance);
  };
  const CompiledScene fine = lens(""), coarse = lens("tolerance_mm: 1e-6\n");
  EXPECT_EQ(fine.scene.tolerance.mm, gradient_index::default_tolerance_mm);
  EXPECT_EQ(coarse.scene.tolerance.mm, 1e-6);
  const GlobalRay ray{{0.2, 1, -1}, {0, 0, 1}};
  const double off = norm(traced(fine, ray).p - traced(coarse, ray).p);
  EXPECT_GT(off, 1e-11);
  EXPECT_LT(off, 1e-5);
}

TEST(Gradient, WhatIsNotAMediumIsAnError) {
  const auto errors = [](const std::string& surfaces) {
    const test::Folder folder;
    auto read = prescription::read_prescription(folder.file("system.yaml", test::prescription_of(surfaces)));
    if (read.model) read.findings = scene::compile(*read.model).findings;
    std::string text;
    for (const auto& finding : read.findings.all()) text += format(finding) + '\n';
    return text;
  };
  EXPECT_NE(errors("  - {stop: true, thickness_mm: 30, medium: {grin: {polynomial: {index: 1.4, z_coefficients: {1: -0.1}}}}}\n  - {}\n").find("no index from 0.001 to 1000 all along the axis"),
            std::string::npos);
}

}  // namespace
}  // namespace sagitta::trace
