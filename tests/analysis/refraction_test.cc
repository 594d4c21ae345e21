// SPDX-License-Identifier: Apache-2.0
#include "lib/analysis/refraction.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/prescriptions.h"

namespace sagitta::test {
namespace {

using analysis::Power;
using analysis::Refraction;
using analysis::RefractionRequest;

CompiledScene shipped(const std::string& name) {
  const auto read = prescription::read_prescription(SAGITTA_SOURCE_DIR "/systems/" + name);
  EXPECT_TRUE(read.model) << name;
  return checked(scene::compile(*read.model));
}
Refraction refracted(const CompiledScene& eye, double vertex_distance = 0, std::size_t field = 0, std::size_t wavelength = 0) {
  const auto result = analysis::refraction(eye.scene, eye.scene.wavelengths[wavelength], eye.scene.fields[field], {.vertex_distance = vertex_distance, .wavefront = {}});
  EXPECT_TRUE(result.refraction) << result.reason;
  return result.refraction.value_or(Refraction{});
}

void expect_power(const Power& power, double M, double J0, double J45, double tolerance) {
  EXPECT_NEAR(power.M(), M, tolerance);
  EXPECT_NEAR(power.J0(), J0, tolerance);
  EXPECT_NEAR(power.J45(), J45, tolerance);
}

// V10 of references.md: the sections' paraxial refractions at the vertex, -2.181238 (y) and -0.625463 D (x).
TEST(Refraction, biconic_test_eye_wants_its_published_lens) {
  const Refraction r = refracted(shipped("biconic-test-eye.yaml"));
  for (const Power& power : {r.paraxial, r.far_point}) {
    EXPECT_NEAR(power.vv, -2.181238, 1e-5);
    EXPECT_NEAR(power.uu, -0.625463, 1e-5);
    EXPECT_NEAR(power.uv, 0, 1e-9);
  }
}

// 2026-11-23: 1e-2 D off of +14.19 and -3.32, by the H^2 of an eye whose sections have other pupils. n'/t - (n' - 1)/R in each section, retina and apex on one axis.
TEST(Refraction, aphakic_eye_of_two_sections_wants_their_lenses) {
  const Refraction r = refracted(scene_of("  - {biconic: {radius_x_mm: 8.1, radius_y_mm: 7.5, conic_constant_x: -0.2, conic_constant_y: -0.2}, thickness_mm: 3.6, medium: {index: 1.336}}\n"
                                          "  - {stop: true, thickness_mm: 20.4, medium: {index: 1.336}}\n  - {conic: {radius_mm: -12}}\n", "entrance_pupil_diameter_mm: 4"));
  for (const Power& power : {r.paraxial, r.far_point}) {
    EXPECT_NEAR(power.uu, 1336 / 24.0 - 336 / 8.1, 1e-5);
    EXPECT_NEAR(power.vv, 1336 / 24.0 - 336 / 7.5, 1e-5);
  }
}
// 2026-11-23: -1.59 for -1.61 D with a pupil of a micrometre, +305 with a nanometre.
TEST(Refraction, has_its_digits_or_none_whatever_the_size_of_the_pupil) {
  const auto read = prescription::read_prescription(SAGITTA_SOURCE_DIR "/systems/biconic-test-eye.yaml");
  ASSERT_TRUE(read.model);
  int found = 0;
  for (const double stop : {1.0, 1e-1, 1e-2, 1e-3, 1e-4, 1e-6}) {
    prescription::Model eye = *read.model;
    ASSERT_EQ(eye.aperture.kind, prescription::ApertureKind::stop_diameter_mm);
    eye.aperture.value = stop;
    const CompiledScene compiled = checked(scene::compile(eye));
    const auto result = analysis::refraction(compiled.scene, compiled.scene.wavelengths[0], compiled.scene.fields[0], {});
    if (!result.refraction) {
      EXPECT_EQ(result.reason, "the pupil is too small: rounding alone would make a thousandth of a dioptre");
      continue;
    }
    ++found;
    for (const Power& power : {result.refraction->paraxial, result.refraction->far_point}) expect_power(power, -1.40335, .77789, 0, 1e-3);
  }
  EXPECT_EQ(found, 3);
}
// 2026-11-23: M -1.4108 and J0 +.7704 with the object at 30 mm, for -1.40335 and +.77789 from infinity.
TEST(Refraction, does_not_depend_on_where_the_object_stands) {
  const auto read = prescription::read_prescription(SAGITTA_SOURCE_DIR "/systems/biconic-test-eye.yaml");
  ASSERT_TRUE(read.model);
  for (const double distance : {std::numeric_limits<double>::infinity(), 1e3, 66.0, 30.0}) {
    prescription::Model eye = *read.model;
    eye.object.distance_mm = distance;
    const Refraction r = refracted(checked(scene::compile(eye)));
    for (const Power& power : {r.paraxial, r.far_point}) expect_power(power, -(2.181238 + .625463) / 2, (2.181238 - .625463) / 2, 0, 1e-5);
  }
}
// 2026-11-23: .034 D apart, aimed, and .016 D unaimed; J0 is 5.85 D there. -0.187274 D by a narrow pencil of another program.
TEST(Refraction, is_the_far_points_at_sixty_degrees) {
  const auto read = prescription::read_prescription(SAGITTA_SOURCE_DIR "/systems/navarro-eye.yaml");
  ASSERT_TRUE(read.model);
  for (const bool is_aimed : {true, false}) {
    prescription::Model eye = *read.model;
    eye.aperture.value = 3, eye.aperture.is_of_stop = is_aimed;
    eye.fields.points = {{0, 60}};
    const Refraction r = refracted(checked(scene::compile(eye)));
    expect_power(r.paraxial, r.far_point.M(), r.far_point.J0(), r.far_point.J45(), 1e-4);
    if (is_aimed) expect_power(r.far_point, -.187274, 5.849732, 0, 1e-4);
  }
}

// At the entrance pupil, references.md T7: M of the wavefront with its aberrations taken out is -1.3949 D (with the exit pupil's radius -1.7076 D), of the
// two other ways what V10 is, each section moved by the pupil's 3.337 mm. OpticStudio's own Z4, .29880600 um on 1.146033527 mm, for least squares.
TEST(Refraction, wavefront_is_over_the_entrance_pupil) {
  const CompiledScene eye = shipped("biconic-test-eye.yaml");
  const Refraction r = refracted(eye, -eye.scene.pupil.z);
  ASSERT_TRUE(r.least_squares && r.at_centre);
  EXPECT_NEAR(r.least_squares->M(), -4 * std::numbers::sqrt3 * .29880600 / (1.146033527 * 1.146033527), 1e-6);
  EXPECT_NEAR(r.at_centre->M(), -1.3949, 2e-3);  // how many terms were fitted there is not known
  EXPECT_NEAR(r.at_centre->M(), r.far_point.M(), .01);
  EXPECT_NEAR(r.paraxial.M(), r.far_point.M(), 1e-6);
  const double d = eye.scene.pupil.z / 1000;
  EXPECT_NEAR(r.far_point.M(), (1 / (1 / -2.181238 - d) + 1 / (1 / -0.625463 - d)) / 2, 1e-5);
}

// E3: the wide-angle eye is focused at 543 nm; at its vertex -0.774077 D at 458 nm, +0.414468 D at 632.8 nm.
TEST(Refraction, navarro_eye_has_its_published_chromatic_difference) {
  const CompiledScene eye = shipped("navarro-eye.yaml");
  const double expected[] = {NAN, -0.774077, 0.414468};
  for (const std::size_t w : {1u, 2u}) {
    const Refraction r = refracted(eye, 0, 0, w);
    expect_power(r.paraxial, expected[w], 0, 0, 1e-5);
    expect_power(r.far_point, expected[w], 0, 0, 1e-5);
  }
}

// A thin lens of power F at the stop, retina at t in index n: it wants n/t - F. At the vertex distance d: 1/(1/P + d).
constexpr const char* reduced = "  - {stop: true, conic: {radius_mm: 5.55}, thickness_mm: 24, medium: {index: 1.336}}\n  - {conic: {radius_mm: -12}}\n";
TEST(Refraction, reduced_eye_wants_what_its_length_asks_for) {
  const CompiledScene eye = scene_of(reduced, "entrance_pupil_diameter_mm: .5");
  const double P = 1336 / 24.0 - 336 / 5.55;  // D
  for (const double d : {0.0, 12.0, 14.0, -3.0}) {
    const Refraction r = refracted(eye, d);
    const double there = 1 / (1 / P + d / 1000);
    expect_power(r.paraxial, there, 0, 0, 1e-6);
    expect_power(r.far_point, there, 0, 0, 1e-6);
  }
  EXPECT_NEAR(spectacles(refracted(eye).paraxial).cylinder, 0, 1e-6);
}

// The far point by tracing from there: an object at it is sharp. A quarter of the pupil's radius from the axis its rays are off by the eye's spherical
// aberration alone, of the third power; a defocus of .01 D would be off by .01/1336 24 h, 1.8e-4 h.
TEST(Refraction, object_at_the_far_point_is_sharp) {
  const CompiledScene eye = scene_of(reduced, "entrance_pupil_diameter_mm: .5");
  const double P = refracted(eye).far_point.M();
  ASSERT_LT(P, 0);
  const CompiledScene near = scene_of(reduced, "entrance_pupil_diameter_mm: .5", "object: {distance_mm: " + std::to_string(-1000 / P) + "}\n");
  const Refraction r = refracted(near);
  expect_power(r.paraxial, P, 0, 0, 1e-6);  // the lens for infinity, whatever the object
  expect_power(r.far_point, P, 0, 0, 1e-6);
  trace::RayBatch rays = launch(near.scene, near.scene.fields[0], 1, std::vector<trace::PupilPoint>{{0, .02}});
  trace::trace(near.scene, near.scene.wavelengths[0], rays);
  ASSERT_EQ(rays.ended[0], 0);
  EXPECT_LT(std::abs(rays.y[0]), 1.8e-4 * .02 * .25 / 100);
}

// Sections turned by an angle: the prescription's axis turns the other way for the examiner, who sees x mirrored.
TEST(Refraction, axis_is_the_examiners) {
  const auto eye = [](double turn_deg) {
    return scene_of("  - {stop: true, biconic: {radius_x_mm: 7.9, radius_y_mm: 7.6}, tilt_deg: [0, 0, " + std::to_string(turn_deg) + "], thickness_mm: 31, medium: {index: 1.336}}\n  - {}\n", "entrance_pupil_diameter_mm: .5");
  };
  const analysis::Spectacles straight = spectacles(refracted(eye(0)).paraxial);
  EXPECT_LT(straight.cylinder, -1);
  EXPECT_NEAR(straight.axis_deg, 180, 1e-6);  // more power in y: the minus cylinder's axis is horizontal
  for (const double turn : {20.0, 45.0, 100.0}) {
    const Refraction r = refracted(eye(turn));
    for (const Power& power : {r.paraxial, r.far_point, r.least_squares.value_or(Power{})}) {
      EXPECT_NEAR(spectacles(power).axis_deg, 180 - turn, .01);
      EXPECT_NEAR(spectacles(power).cylinder, straight.cylinder, .01);
      EXPECT_NEAR(spectacles(power).sphere, straight.sphere, .01);
    }
  }
}

TEST(Refraction, spectacles_of_textbook_vectors) {
  const auto of = [](double M, double J0, double J45) { return spectacles(Power{M + J0, J45, M - J0}); };
  const auto a = of(-1.25, .25, 0);  // -1.00 -0.50 x 180
  EXPECT_NEAR(a.sphere, -1, 1e-15);
  EXPECT_NEAR(a.cylinder, -.5, 1e-15);
  EXPECT_NEAR(a.axis_deg, 180, 1e-12);
  const auto b = of(1, -.5, 0);  // +1.50 -1.00 x 90
  EXPECT_NEAR(b.sphere, 1.5, 1e-15);
  EXPECT_NEAR(b.axis_deg, 90, 1e-12);
  const auto c = of(0, 0, .5);  // +0.50 -1.00 x 45
  EXPECT_NEAR(c.axis_deg, 45, 1e-12);
  EXPECT_EQ(of(2, 0, 0).cylinder, 0);
}

// A crossed cylinder moved as its sections are, one by one.
TEST(Refraction, moved_power_is_that_of_its_sections) {
  const double first = 5, second = -8, angle = .3, a = .012, n = 1.1, c = std::cos(angle), s = std::sin(angle);
  const auto matrix = [&](double p, double q) { return Power{p * c * c + q * s * s, (p - q) * c * s, p * s * s + q * c * c}; };
  const Power there = analysis::moved(matrix(first, second), a, n), expected = matrix(first / (1 + a * first / n), second / (1 + a * second / n));
  EXPECT_NEAR(there.uu, expected.uu, 1e-13);
  EXPECT_NEAR(there.uv, expected.uv, 1e-13);
  EXPECT_NEAR(there.vv, expected.vv, 1e-13);
}

// Off axis, by Coddington's equations on a single sphere with the stop at its centre of curvature: every field is on axis, the oblique ones too.
TEST(Refraction, concentric_eye_is_the_same_in_every_direction) {
  const CompiledScene eye = scene_of("  - {conic: {radius_mm: 8}, thickness_mm: 8, medium: {index: 1.336}}\n  - {stop: true, thickness_mm: 23, medium: {index: 1.336}}\n  - {conic: {radius_mm: -23}}\n",
                                     "stop_diameter_mm: 1", "fields: {angles_deg: [[0, 0], [0, 30], [-25, 10]]}\n");
  const Refraction axis = refracted(eye, -eye.scene.pupil.z);
  for (const std::size_t field : {1u, 2u}) {
    const Refraction r = refracted(eye, -eye.scene.pupil.z, field);
    expect_power(r.paraxial, axis.paraxial.M(), 0, 0, 1e-5);
    expect_power(r.far_point, axis.far_point.M(), 0, 0, 1e-5);
  }
  EXPECT_NEAR(axis.paraxial.M(), axis.far_point.M(), 1e-6);
  // A plane 12 mm before the cornea is farther away along an oblique chief ray.
  for (const std::size_t field : {1u, 2u}) {
    const double secant = std::hypot(1, std::hypot(eye.scene.fields[field].x, eye.scene.fields[field].y)), a = (eye.scene.pupil.z + 12) / 1000 * secant;
    expect_power(refracted(eye, 12, field).far_point, 1 / (1 / axis.far_point.M() + a), 0, 0, 1e-5);
  }
}

}  // namespace
}  // namespace sagitta::test
