// SPDX-License-Identifier: Apache-2.0
// What verify says of rounding, against closed forms and against the tracer's own numbers.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "lib/analysis/wavefront.h"
#include "lib/study/rounding.h"
#include "lib/study/truth.h"
#include "lib/trace/pattern.h"
#include "tests/study/subjects.h"
#include "tests/support/sag_grids.h"

namespace sagitta::test {
namespace {

using study::Rounding, study::rounding_of;
using surface::Status;

// Axial rays at pupil points that are exact (semi-diameter 8 mm) through planes 16 and 4 mm apart: no operation rounds but sums of numbers
// with few digits, and a sine and a cosine of 0.
TEST(Rounding, IsNoneWhereNothingIsRounded) {
  const auto compiled = checked(scene::compile(system_of({surface_of({}, 16, 1.5), surface_of({}, 4, 1)}, 16)));
  const Rounding rounding = rounding_of(compiled.scene, {.rays = 37});
  ASSERT_EQ(rounding.surfaces.size(), 4u);
  EXPECT_EQ(rounding.rays, 37);
  EXPECT_EQ(rounding.scale_mm, 16);
  for (const auto& surface : rounding.surfaces) {
    EXPECT_EQ(surface.position_mm.count(), 37);
    EXPECT_EQ(surface.position_mm.worst(), 0);
    EXPECT_EQ(surface.direction_rad.worst(), 0);
    EXPECT_EQ(surface.opl_mm.worst(), 0);
    EXPECT_EQ(surface.digits_lost, 0);
    EXPECT_EQ(surface.cause, "");
  }
  EXPECT_EQ(rounding.fields.at(0).no_wavefront, "the image is afocal");
}

// The ellipsoid of K = -1/n^2, n = 2: exact rays meet in its focus with one path, so the tracer's places across the axis are its errors, and so
// are its OPDs, whatever the sphere (its radius of 16 mm: the exit pupil is the surface). 1e-19 is the rounding of the exact numbers to
// doubles.
TEST(Rounding, OfACartesianOvalIsAllThatTheTracerSays) {
  const auto compiled = checked(scene::compile(system_of({surface_of(conic_shape(8, -.25), 16, 2)}, 8)));
  const scene::Scene& scene = compiled.scene;
  const Rounding rounding = rounding_of(scene, {.rays = 200});
  const auto pupil = trace::pupil_points({trace::PatternKind::hexapolar}, 200);
  auto rays = trace::launch(scene, scene.fields[0], 1, pupil);
  trace::trace(scene, scene.primary, rays);
  const auto sphere = analysis::reference_sphere(scene, scene.primary, scene.fields[0]).sphere;
  double place = 0, opd = 0;
  for (std::size_t i = 0; i < pupil.size(); ++i) {
    ASSERT_EQ(rays.ended[i], 0);
    place = std::fmax(place, std::hypot(rays.x[i], rays.y[i]));
    opd = std::fmax(opd, std::abs(optical_path_difference(sphere, rays.position(i), rays.direction(i), rays.opl[i])) / .000855);
  }
  EXPECT_GT(place, 0);
  EXPECT_GT(opd, 0);
  const auto& field = rounding.fields.at(0);
  EXPECT_EQ(field.arrived, static_cast<std::int64_t>(pupil.size()));
  EXPECT_NEAR(field.position_mm.worst(), place, 1e-12 * place);
  EXPECT_NEAR(field.opd_waves.worst(), opd, 1e-12 * opd);
  EXPECT_TRUE(rounding.disagreements.empty());
}

// Shares add up ray by ray, so no error in the image is larger than the sum of the largest shares.
TEST(Rounding, SharesOfSurfacesCoverTheErrorInTheImage) {
  const auto compiled = checked(scene::compile(
      system_of({surface_of(conic_shape(30, -.5), 4, 1.5), surface_of(conic_shape(-40, 0), 2, 1), surface_of({}, 1, 1),  // the last one is a dummy
                 surface_of(zernike_shape(25, .2, 6, {{3, 2.0}, {8, -1.5}}), 5, 1.6), surface_of(conic_shape(-60, -2), 30, 1)}, 9, {0, 11})));
  const Rounding rounding = rounding_of(compiled.scene, {.rays = 100});
  double share_mm = 0, share_waves = rounding.opd_formula_waves.worst(), place = 0, opd = 0;
  for (const auto& surface : rounding.surfaces) share_mm += surface.share_mm.worst(), share_waves += surface.share_waves.worst();
  for (const auto& field : rounding.fields) {
    EXPECT_EQ(field.no_wavefront, "");
    place = std::fmax(place, field.position_mm.worst());
    opd = std::fmax(opd, field.opd_waves.worst());
  }
  EXPECT_GT(place, 0);
  EXPECT_LE(place, share_mm);
  EXPECT_LE(opd, share_waves);
  EXPECT_EQ(rounding.surfaces[3].share_mm.worst(), 0);  // it is passed by
  EXPECT_EQ(rounding.surfaces[3].share_waves.worst(), 0);
  EXPECT_GT(rounding.surfaces[4].share_mm.worst(), 0);
}

// Glass of 1.5, then a plane tilted by the critical angle less 1e-12 of it: cos I' = sqrt(2e-12 tan^2 I_c ...) is about 1e-6, so a direction loses 6 digits
// or so there, and the cause is named. eps/cos I' is what the radicand's rounding forces (surface/refraction.h).
TEST(Rounding, NamesTheCriticalAngle) {
  const double critical = std::asin(1 / 1.5), tilt = critical * (1 - 1e-12);
  auto tilted = surface_of({}, 5, 1);
  tilted.tilt_deg = {tilt * 180 / 3.14159265358979324, 0, 0};
  const auto compiled = checked(scene::compile(system_of({surface_of({}, 10, 1.5), tilted}, 1)));
  const Rounding rounding = rounding_of(compiled.scene, {.rays = 20});
  const double cosine = std::sqrt(1 - std::pow(1.5 * std::sin(tilt), 2));  // to a percent
  const auto& surface = rounding.surfaces.at(2);
  EXPECT_EQ(surface.cause, "near the critical angle");
  EXPECT_GT(surface.digits_lost, 4);
  EXPECT_LT(surface.own_direction_rad.worst(), 1e-15 / cosine);
  EXPECT_GT(surface.own_direction_rad.worst(), 1e-18 / cosine);
}

// A lens that is no burden: its own errors are within the bounds, and these are no more than 100 to 200 roundings of its size: what the counts of
// rounding_bound_internal.h come to at cosines of about 1.
TEST(Rounding, StaysWithinBoundsThatAreNarrow) {
  const auto compiled = checked(scene::compile(
      system_of({surface_of(conic_shape(30, -.5), 4, 1.5), surface_of(conic_shape(-40, 0), 2, 1), surface_of({}, 1, 1),  // the last one is a dummy
                 surface_of(zernike_shape(25, .2, 6, {{3, 2.0}, {8, -1.5}}), 5, 1.6), surface_of(conic_shape(-60, -2), 30, 1)}, 9, {0, 11})));
  const Rounding rounding = rounding_of(compiled.scene, {.rays = 100});
  for (std::size_t k = 1; k < rounding.surfaces.size(); ++k) {
    const auto& surface = rounding.surfaces[k];
    EXPECT_EQ(surface.bound_position_mm.count(), rounding.rays);
    EXPECT_EQ(surface.without_bound, 0);
    EXPECT_GT(surface.of_bound, 0);
    EXPECT_LE(surface.of_bound, 1);
    EXPECT_LE(surface.own_position_mm.worst(), surface.bound_position_mm.worst());
    EXPECT_LT(surface.bound_position_mm.worst(), 100 * 0x1p-52 * rounding.scale_mm);
    EXPECT_LT(surface.bound_direction_rad.worst(), 200 * 0x1p-52);
    EXPECT_LT(surface.bound_opl_mm.worst(), 200 * 0x1p-52 * rounding.scale_mm);
  }
}

// So are those at aspheres, biconics, toroids and polynomials, whose terms add up to little here.
TEST(Rounding, StaysWithinBoundsAtEveryShapeOfAFormula) {
  const auto compiled = checked(compile_text(prescription_of(
      "  - {stop: true, biconic: {radius_x_mm: 7.83, radius_y_mm: 7.7, conic_constant_x: -0.18, conic_constant_y: -0.3}, thickness_mm: 0.55, medium: {index: 1.3777}}\n"
      "  - {asphere: {radius_mm: 6.5, conic_constant: -0.2, coefficients: {2: -0.001, 4: 1e-4, 5: 2e-6, 6: -1e-6}}, thickness_mm: 3, medium: {index: 1.337}}\n"
      "  - {xy_polynomial: {radius_mm: 10, coefficients: {3: 1e-4, 4: 2e-4, 10: 1e-6}}, thickness_mm: 4, medium: {index: 1.42}}\n"
      "  - {toroid: {radius_rotation_mm: -6, radius_mm: -6.1, conic_constant: -1, coefficients: {4: 1e-5}}, thickness_mm: 16.3, medium: {index: 1.336}}\n"
      "  - {biconic: {radius_x_mm: -12.91, radius_y_mm: -12.72, conic_constant_x: 0.27, conic_constant_y: 0.25}}\n",
      "entrance_pupil_diameter_mm: 5", "fields: {angles_deg: [[0, 0], [8, 20]]}\n")));
  const Rounding rounding = rounding_of(compiled.scene, {.rays = 200});
  EXPECT_GT(rounding.rays, 100);
  for (std::size_t k = 1; k < rounding.surfaces.size(); ++k) {
    const auto& surface = rounding.surfaces[k];
    EXPECT_EQ(surface.without_bound, 0);
    EXPECT_GT(surface.of_bound, 0);
    EXPECT_LE(surface.of_bound, 1);
    EXPECT_LT(surface.bound_position_mm.worst(), 300 * 0x1p-52 * rounding.scale_mm) << k;
    EXPECT_LT(surface.bound_direction_rad.worst(), 600 * 0x1p-52) << k;
  }
}

// And at grids: waves with slopes and by differences, on a base and on none, with a hole; rays that end there have no bound.
TEST(Rounding, StaysWithinBoundsAtGrids) {
  const Folder folder;
  std::string with_slopes = "31 31 0.25 0.25 0 0 0\n", without = "31 31 0.25 0.25 0 0.1 0\n";
  for (int j = 0; j < 31; ++j)
    for (int i = 0; i < 31; ++i) {
      const tests::SagGrid::Node node = tests::of_waves(.02, -3.75 + .25 * i, 3.75 - .25 * j);
      with_slopes += fmt::format("{} {} {} {} {}\n", node.z, node.dz_dx, node.dz_dy, node.d2z_dxdy, i == 20 && j == 12 ? 1 : 0);
      without += fmt::format("{}\n", node.z);
    }
  folder.file("slopes.dat", with_slopes), folder.file("heights.dat", without);
  const auto read = prescription::read_prescription(folder.file("system.yaml", prescription_of(
      "  - {stop: true, grid: {points: slopes.dat, radius_mm: 7.8, conic_constant: -0.2}, thickness_mm: 3, medium: {index: 1.3777}}\n"
      "  - {grid: {points: heights.dat}, thickness_mm: 20, medium: {index: 1.5}}\n  - {}\n", "entrance_pupil_diameter_mm: 5", "fields: {angles_deg: [[0, 0], [8, 12]]}\n")));
  ASSERT_TRUE(read.model);
  auto compiled = scene::compile(*read.model);
  ASSERT_TRUE(compiled.scene);
  const Rounding rounding = rounding_of(*compiled.scene, {.rays = 200});
  EXPECT_TRUE(rounding.disagreements.empty());
  for (std::size_t k = 1; k <= 3; ++k) {
    const auto& surface = rounding.surfaces[k];
    EXPECT_GT(surface.bound_position_mm.count(), 150);
    EXPECT_LT(surface.bound_position_mm.count(), rounding.rays);
    EXPECT_EQ(surface.without_bound, 0);
    EXPECT_LE(surface.of_bound, 1);
    EXPECT_LT(surface.bound_position_mm.worst(), 300 * 0x1p-52 * rounding.scale_mm) << k;
    EXPECT_LT(surface.bound_direction_rad.worst(), 2000 * 0x1p-52) << k;  // slopes: heights over spacings
  }
}

// Six rays parallel to the axis at a height of R (1 - 1e-8), where 1/cos I is 7071, and at R/10: the bound, and what may be lost, are as much larger.
TEST(Rounding, HasBoundsThatGrowWithTheCosine) {
  const auto bound_at = [](double height) {
    const double ring = std::sqrt(4.0 / 7);  // of the pupil's radius (trace/pattern.h)
    const auto compiled = checked(scene::compile(system_of({surface_of(conic_shape(10, 0), 20, 1.5)}, 2 * height / ring)));
    const study::SurfaceRounding surface = rounding_of(compiled.scene, {.rays = 7}).surfaces.at(1);
    EXPECT_EQ(surface.bound_position_mm.count(), 7);
    EXPECT_LE(surface.of_bound, 1);
    return surface.bound_position_mm.worst();
  };
  const double steep = bound_at(10 * (1 - 1e-8)), gentle = bound_at(1);
  EXPECT_GT(steep, 7071 * gentle);
  EXPECT_LT(steep, 100 * 7071 * gentle);  // ten times the height, and its square in the terms
}

// An aperture's rim between the tracer's place and the exact one.
TEST(Rounding, CountsRaysThatEndInOneWayOnly) {
  prescription::Model model = system_of({surface_of(conic_shape(30, -.5), 4, 1.5), surface_of(conic_shape(-40, 0), 30, 1)}, 9);
  const auto open = checked(scene::compile(model));
  const auto pupil = trace::pupil_points({trace::PatternKind::hexapolar}, 1000);
  auto rays = trace::launch(open.scene, open.scene.fields[0], 1, pupil);
  for (int number = 1; number <= 2; ++number) trace::trace_surface(open.scene, open.scene.primary, number, rays);
  const auto truth = study::true_rays(open.scene, open.scene.primary, open.scene.fields[0], pupil, {.surface_number = 2});
  ASSERT_TRUE(truth.rays) << truth.reason;
  int found = 0;
  for (std::size_t i = 0; i < pupil.size() && found == 0; ++i) {
    const double r = std::sqrt(rays.x[i] * rays.x[i] + rays.y[i] * rays.y[i]);
    const auto& exact = truth.rays->at_surface[i].position;
    const long double exact_r = std::hypot(exact.x, exact.y);
    if (!(std::abs(static_cast<double>(r - exact_r)) > 3e-16 * r)) continue;  // a rim must fit between the two, squared or not
    model.surfaces[1].semi_diameter_mm = static_cast<double>((r + exact_r) / 2);
    const auto narrow = checked(scene::compile(model));
    const Rounding rounding = rounding_of(narrow.scene, {.rays = 1000});
    for (const auto& one : rounding.disagreements) {
      if (one.pupil_x != pupil[i].x || one.pupil_y != pupil[i].y) continue;
      ++found;
      EXPECT_TRUE(one.is_on_rim);
      EXPECT_NE(one.status, one.exact_status);
      EXPECT_EQ(one.status, r < exact_r ? Status::ok : Status::clipped);
      EXPECT_EQ(one.surface + one.exact_surface, 2);  // of the one that is clipped
    }
    const Rounding strict = rounding_of(narrow.scene, {.rays = 1000, .position_tolerance_mm = 0});
    EXPECT_EQ(strict.disagreements.size(), rounding.disagreements.size());
    for (const auto& one : strict.disagreements) EXPECT_FALSE(one.is_on_rim);
  }
  EXPECT_EQ(found, 1);
}

TEST(Rounding, IsTheSameForAnyNumberOfThreads) {
  const auto compiled = checked(scene::compile(paper_lens(3)));
  const Rounding one = rounding_of(compiled.scene, {.rays = 300, .thread_count = 1}), four = rounding_of(compiled.scene, {.rays = 300, .thread_count = 4});
  for (std::size_t k = 0; k < one.surfaces.size(); ++k) {
    EXPECT_EQ(one.surfaces[k].position_mm.rms(), four.surfaces[k].position_mm.rms());
    EXPECT_EQ(one.surfaces[k].share_waves.rms(), four.surfaces[k].share_waves.rms());
  }
}

// The exact rays bend too: what the tolerance leaves is seen at the surface that ends the medium, and is what the estimate of it allows: a step's tolerance, for 5 steps or so
// at 1e-12 mm and 2 at 1e-6 mm, 2 more, twice, with variations of a size of 3 mm/(n0 g) at most.
TEST(Rounding, OfARayInAGradientIsWhatItsToleranceLeaves) {
  const auto of = [](const std::string& tolerance) {
    const auto compiled = checked(compile_text(prescription_of("  - {stop: true, thickness_mm: 20, medium: {grin: {selfoc: {index: 1.6, g_per_mm: 0.3}}}}\n"
                                                               "  - {conic: {radius_mm: -20}, thickness_mm: 2}\n  - {}\n", "entrance_pupil_diameter_mm: 1", tolerance)));
    return rounding_of(compiled.scene, {.rays = 7});
  };
  const Rounding fine = of(""), coarse = of("tolerance_mm: 1e-6\n");
  EXPECT_TRUE(fine.disagreements.empty());
  EXPECT_LE(fine.surfaces[2].own_position_mm.worst(), 1e-12 * 40);
  EXPECT_GT(coarse.surfaces[2].own_position_mm.worst(), 1e-10);
  EXPECT_LE(coarse.surfaces[2].own_position_mm.worst(), 1e-6 * 40);
  EXPECT_EQ(coarse.surfaces[2].cause, "the tolerance in a gradient, and many operations");
  EXPECT_LE(coarse.surfaces[3].own_position_mm.worst(), 1e-14);
  for (const Rounding* one : {&fine, &coarse})
    for (std::size_t k = 1; k <= 3; ++k) {
      EXPECT_EQ(one->surfaces[k].without_bound, 0) << k;
      EXPECT_EQ(one->surfaces[k].bound_position_mm.count(), 7) << k;
      EXPECT_LE(one->surfaces[k].of_bound, 1) << k;
    }
  EXPECT_GT(coarse.surfaces[2].bound_position_mm.worst(), 1e-6);
  EXPECT_LT(coarse.surfaces[2].bound_position_mm.worst(), 1e-6 * 1000);
  EXPECT_GT(fine.surfaces[2].bound_opl_mm.worst(), 1e-12);
  EXPECT_LT(fine.surfaces[2].bound_opl_mm.worst(), 1e-12 * 5000);
}

// A rod of 20 pitches, and a medium in which rays part by a factor of e every mm for 12 mm: what a step leaves at its start is as much larger at the end.
TEST(Rounding, OfAGradientGrowsAsRaysPart) {
  const auto bound_of = [](const std::string& form, double length, const std::string& pupil) {
    const auto compiled = checked(compile_text(prescription_of(fmt::format("  - {{stop: true, thickness_mm: {}, medium: {{grin: {{{}}}}}}}\n  - {{}}\n", length, form), "entrance_pupil_diameter_mm: " + pupil)));
    const study::SurfaceRounding at_end = rounding_of(compiled.scene, {.rays = 7}).surfaces.at(2);
    EXPECT_EQ(at_end.bound_position_mm.count(), 7) << form;
    EXPECT_LE(at_end.of_bound, 1) << form;
    return at_end.bound_position_mm.worst();
  };
  const double rod = bound_of("selfoc: {index: 1.6, g_per_mm: 1}", 126, "1");
  EXPECT_LT(rod, 1e-12 * 4 * 300 * 110);  // its rays part along the axis alone, by 126 mm/(n cos) or 91 mm for each of p_z: 4 of them, over the cosine, for two steps a radian or so
  const double parts = bound_of("quadratic: {index: 1, x2_per_mm2: 1, y2_per_mm2: 1}", 12, "1e-7"), hardly = bound_of("quadratic: {index: 1, x2_per_mm2: 1, y2_per_mm2: 1}", 4, "1e-7");
  EXPECT_GT(parts, std::exp(7.5) * hardly);  // e^8 of them
  EXPECT_GT(parts, 1e-12 * std::exp(12.0));
  EXPECT_LT(parts, 1e-12 * std::exp(12.0) * 100);
}

TEST(TrueRays, BendInGradientsAndDoNotStudyTheirSurfaces) {
  const auto compiled = checked(compile_text(prescription_of("  - {stop: true, conic: {radius_mm: 30}, thickness_mm: 3, medium: {index: 1.5}}\n  - {thickness_mm: 4, medium: {grin: {selfoc: {index: 1.6, "
                                                             "g_per_mm: 0.3}}}}\n  - {conic: {radius_mm: -20}, thickness_mm: 2}\n  - {}\n", "entrance_pupil_diameter_mm: 1")));
  const auto pupil = trace::pupil_points({trace::PatternKind::hexapolar}, 7);
  const auto exact = study::true_rays(compiled.scene, compiled.scene.primary, compiled.scene.fields[0], pupil, {.surface_number = 1});
  ASSERT_TRUE(exact.rays) << exact.reason;
  auto rays = trace::launch(compiled.scene, compiled.scene.fields[0], 1, pupil);
  trace::trace(compiled.scene, compiled.scene.primary, rays);
  for (std::size_t i = 0; i < pupil.size(); ++i) {
    EXPECT_NEAR(static_cast<double>(exact.rays->at_image[i].position.x), rays.x[i], 1e-11);
    EXPECT_NEAR(static_cast<double>(exact.rays->at_image[i].position.y), rays.y[i], 1e-11);
    EXPECT_EQ(exact.rays->at_image[i].ended, 0);
  }
  EXPECT_NE(study::true_rays(compiled.scene, compiled.scene.primary, compiled.scene.fields[0], pupil, {.surface_number = 2}).reason.find("gradient-index"), std::string::npos);
}

}  // namespace
}  // namespace sagitta::test
