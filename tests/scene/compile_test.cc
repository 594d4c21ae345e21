// SPDX-License-Identifier: Apache-2.0
#include "lib/scene/compile.h"

#include <fmt/format.h>

#include <cmath>

#include "tests/support/prescriptions.h"

namespace sagitta::test {
namespace {

const std::string lens = "  - {conic: {radius_mm: 50}, thickness_mm: 4, medium: {index: 1.5}}\n  - {conic: {radius_mm: -50}, thickness_mm: 6}\n"
                         "  - {stop: true, thickness_mm: 40}\n  - {}\n";

void expect_near(const Vec3<double>& a, const Vec3<double>& b, double tolerance = 1e-15) { EXPECT_LE(norm(a - b), tolerance); }

TEST(Compile, a_positive_tilt_about_x_turns_plus_y_toward_plus_z) {
  const double a = 30 * std::acos(-1.0) / 180;
  const auto axes = [](const char* tilt) {
    const CompiledScene compiled = scene_of(std::string("  - {stop: true, thickness_mm: 1, tilt_deg: ") + tilt + "}\n  - {}\n");
    const auto& r = compiled.scene.surface(1).global_from_local.rotation;
    return std::array{r * Vec3<double>{1, 0, 0}, r * Vec3<double>{0, 1, 0}, r * Vec3<double>{0, 0, 1}};
  };
  const auto x = axes("[30, 0, 0]"), y = axes("[0, 30, 0]"), z = axes("[0, 0, 30]");
  expect_near(x[0], {1, 0, 0});
  expect_near(x[1], {0, std::cos(a), std::sin(a)});
  expect_near(x[2], {0, -std::sin(a), std::cos(a)});
  expect_near(y[0], {std::cos(a), 0, -std::sin(a)});
  expect_near(y[2], {std::sin(a), 0, std::cos(a)});
  expect_near(z[0], {std::cos(a), std::sin(a), 0});
  expect_near(z[1], {-std::sin(a), std::cos(a), 0});
  // about x first, then the new y: x -> z' of the first turn; then the new z
  const auto all = axes("[90, 90, 90]");
  // after x: (x, z, -y); after y: x'' = -z' = y, y'' = z, z'' = x' = x; after z: x''' = y'' = z, y''' = -x'' = -y
  expect_near(all[0], {0, 0, 1});
  expect_near(all[1], {0, -1, 0});
  expect_near(all[2], {1, 0, 0});
}

TEST(Compile, decenter_comes_before_tilt_and_the_axis_goes_on_behind) {
  const CompiledScene compiled = scene_of("  - {stop: true, thickness_mm: 3}\n  - {thickness_mm: 5, decenter_mm: [1, 2, 0.5], tilt_deg: [90, 0, 0]}\n"
                                          "  - {thickness_mm: -7, medium: mirror}\n  - {}\n");
  const auto& surfaces = compiled.scene.surfaces;
  expect_near(surfaces[1].global_from_local.translation, {1, 2, 3.5});
  expect_near(surfaces[2].global_from_local.translation, {0, 0, 8});
  expect_near(surfaces[3].global_from_local.translation, {0, 0, 1});
  EXPECT_EQ(surfaces[2].global_from_local.rotation, numerics::Rotation<double>{});
  EXPECT_EQ(surfaces[1].axis_z, 3);
  EXPECT_EQ(surfaces[3].axis_z, 1);
  // (0, 0, 1) of the tilted frame is (0, -1, 0) of the global one: below the vertex
  expect_near(surfaces[1].global_from_local * Vec3<double>{0, 0, 1}, {1, 1, 3.5});
  // into the frame before and out again
  for (std::size_t i = 1; i < surfaces.size(); ++i) {
    const Vec3<double> p{0.3, -2, 5};
    expect_near(surfaces[i].global_from_local * (surfaces[i].local_from_previous * p), surfaces[i - 1].global_from_local * p, 1e-14);
  }
  EXPECT_TRUE(surfaces[0].centred);
  EXPECT_FALSE(surfaces[1].centred);
  EXPECT_FALSE(surfaces[2].centred);  // back from the tilted frame
  EXPECT_TRUE(surfaces[3].centred);
}

TEST(Compile, a_decenter_along_the_axis_alone_is_a_shift) {
  const CompiledScene compiled = scene_of("  - {stop: true, thickness_mm: 3}\n  - {thickness_mm: 5, decenter_mm: [0, 0, 0.5]}\n  - {}\n");
  EXPECT_TRUE(compiled.scene.surface(2).centred);
  EXPECT_EQ(compiled.scene.surface(2).local_from_previous.translation.z, -3.5);
  EXPECT_EQ(compiled.scene.surface(3).local_from_previous.translation.z, -4.5);
}

TEST(Compile, indices_follow_the_media_and_a_mirror_keeps_the_one_before) {
  const CompiledScene compiled = scene_of("  - {stop: true, thickness_mm: 3, medium: {index: 1.5}}\n  - {thickness_mm: -3, medium: mirror}\n  - {thickness_mm: -3}\n  - {medium: {index: 3}}\n",
                                          "entrance_pupil_diameter_mm: 4", "object: {medium: {index: 1.25}}\n");
  EXPECT_EQ(compiled.wavelength().index, (std::vector{1.25, 1.5, 1.5, 1.0, 1.0}));
  EXPECT_TRUE(compiled.scene.surface(2).mirror);
  EXPECT_TRUE(compiled.scene.surface(4).image);
}

TEST(Compile, the_primary_wavelength_makes_the_first_order) {
  const std::string surfaces = "surfaces:\n  - {stop: true, conic: {radius_mm: 50}, thickness_mm: 4, medium: N-BK7}\n  - {}\n";
  const std::string head = "sagitta: 1\naperture: {entrance_pupil_diameter_mm: 4}\n";
  const auto power = [&](const std::string& wavelengths) { return checked(compile_text(head + wavelengths + surfaces)).first_order.power; };
  EXPECT_EQ(power("wavelengths_nm: [486.1, 656.3]\n"), power("wavelengths_nm: [486.1]\n"));
  EXPECT_EQ(power("wavelengths_nm: [486.1, 656.3]\nprimary_nm: 656.3\n"), power("wavelengths_nm: [656.3]\n"));
  EXPECT_EQ(power("wavelengths_nm: [486.1, 656.3]\nprimary_nm: 587.6\n"), power("wavelengths_nm: [587.6]\n"));
  EXPECT_NEAR(power("wavelengths_nm: [587.5618]\n"), 0.5168000 / 50, 1e-8);
}

// A thin lens of f = 50 (index 1.5, both radii 50) with thickness 4: all from the matrix by hand.
TEST(Compile, all_aperture_kinds_give_the_same_beam_when_they_should) {
  const CompiledScene by_pupil = scene_of(lens, "entrance_pupil_diameter_mm: 10");
  EXPECT_EQ(by_pupil.scene.pupil.semi_diameter, 5);
  // power of each face 0.01; y2 = 1 - 4/1.5 * 0.01, V2 = -0.01 - 0.01 y2; stop height A = y2 + 6 V2
  const double y2 = 1 - 0.04 / 1.5, V2 = -0.01 - 0.01 * y2, A = y2 + 6 * V2;
  const CompiledScene by_stop = scene_of(lens, fmt::format("stop_diameter_mm: {:.17g}", 10 * A));
  EXPECT_NEAR(by_stop.scene.pupil.semi_diameter, 5, 1e-14);
  const CompiledScene by_f_number = scene_of(lens, fmt::format("image_f_number: {:.17g}", -1 / V2 / 10));
  EXPECT_NEAR(by_f_number.scene.pupil.semi_diameter, 5, 1e-14);
  for (const CompiledScene* one : {&by_pupil, &by_stop, &by_f_number}) {
    EXPECT_EQ(one->scene.pupil.z, by_pupil.first_order.entrance_pupil.z);
    EXPECT_EQ(one->first_order.entrance_pupil.semi_diameter, one->scene.pupil.semi_diameter);
    EXPECT_FALSE(one->scene.pupil.telecentric);
  }
  // entrance pupil: B/A with B = 4/1.5 + 6 (1 - 0.01 * 4/1.5)
  EXPECT_NEAR(by_pupil.scene.pupil.z, (4 / 1.5 + 6 * (1 - 0.04 / 1.5)) / A, 1e-13);
  const CompiledScene by_na = scene_of(lens, "object_na: 0.1", "object: {distance_mm: 80}\n");
  EXPECT_NEAR(by_na.scene.pupil.semi_diameter, (by_na.scene.pupil.z + 80) * std::tan(std::asin(0.1)), 1e-13);
}

TEST(Compile, a_mirror_system_has_a_positive_beam) {
  const CompiledScene compiled = scene_of("  - {stop: true, conic: {radius_mm: -200}, thickness_mm: -100, medium: mirror}\n  - {}\n", "image_f_number: 10");
  EXPECT_DOUBLE_EQ(compiled.scene.pupil.semi_diameter, 5);
  const CompiledScene diverging = scene_of("  - {stop: true, conic: {radius_mm: 200}, thickness_mm: -100, medium: mirror}\n  - {}\n", "image_f_number: 10");
  EXPECT_DOUBLE_EQ(diverging.scene.pupil.semi_diameter, 5);
}

TEST(Compile, fields_are_tangents_or_heights) {
  const CompiledScene angles = scene_of(lens, "entrance_pupil_diameter_mm: 4", "fields: {angles_deg: [[0, 45], [-30, 0]]}\n");
  ASSERT_EQ(angles.scene.fields.size(), 2u);
  EXPECT_FALSE(angles.scene.fields[0].is_height);
  EXPECT_NEAR(angles.scene.fields[0].y, 1, 1e-15);
  EXPECT_NEAR(angles.scene.fields[1].x, -std::sqrt(1.0 / 3), 1e-15);
  EXPECT_TRUE(angles.scene.object.at_infinity());
  const CompiledScene heights = scene_of(lens, "entrance_pupil_diameter_mm: 4", "object: {distance_mm: 80}\nfields: {object_heights_mm: [[1, -2]]}\n");
  EXPECT_TRUE(heights.scene.fields[0].is_height);
  EXPECT_EQ(heights.scene.fields[0].y, -2);
  EXPECT_EQ(heights.scene.object.z, -80);
  EXPECT_EQ(scene_of(lens, "entrance_pupil_diameter_mm: 4", "object: {distance_mm: -80}\n").scene.object.z, 80);
}

TEST(Compile, apertures_and_stop_are_kept) {
  const CompiledScene compiled = scene_of("  - {thickness_mm: 1, semi_diameter_mm: 3, inner_semi_diameter_mm: 1}\n  - {stop: true, thickness_mm: 1}\n  - {semi_diameter_mm: 2}\n");
  EXPECT_EQ(compiled.scene.stop, 2);
  EXPECT_EQ(compiled.scene.surface(1).semi_diameter, 3);
  EXPECT_EQ(compiled.scene.surface(1).inner_semi_diameter, 1);
  EXPECT_TRUE(std::isinf(compiled.scene.surface(2).semi_diameter));
  EXPECT_EQ(compiled.scene.surface(3).semi_diameter, 2);
}

// Exactly one error, with its place, and no scene.
void expect_error(const std::string& yaml, const std::string& part, int line) {
  const scene::CompileResult result = compile_text(yaml);
  EXPECT_FALSE(result.scene);
  ASSERT_EQ(result.findings.error_count(), 1) << part;
  EXPECT_NE(result.findings.all()[0].what.find(part), std::string::npos) << result.findings.all()[0].what;
  EXPECT_EQ(result.findings.all()[0].place.line, line);
}

const std::string telecentric_lens = "  - {conic: {radius_mm: 100}, thickness_mm: 0, medium: {index: 1.5}}\n  - {conic: {radius_mm: -100}, thickness_mm: 100}\n"
                                     "  - {stop: true, thickness_mm: 100}\n  - {}\n";

TEST(Compile, says_what_cannot_be_launched) {
  expect_error(prescription_of(telecentric_lens), "entrance pupil is at infinity", 3);
  expect_error(prescription_of(telecentric_lens, "stop_diameter_mm: 4", "object: {distance_mm: 100}\n"), "entrance pupil is at infinity", 3);
  expect_error(prescription_of(telecentric_lens, "object_na: 0.1", "object: {distance_mm: 100}\nfields: {angles_deg: [[0, 1]]}\n"), "entrance pupil is at infinity", 3);
  expect_error(prescription_of("  - {thickness_mm: 5}\n  - {stop: true, thickness_mm: 5}\n  - {}\n", "image_f_number: 4"), "afocal", 3);
  expect_error(prescription_of("  - {thickness_mm: 5}\n  - {stop: true, thickness_mm: 5}\n  - {}\n", "entrance_pupil_diameter_mm: 4", "object: {distance_mm: -5}\n"), "lies in the entrance pupil", 4);
}

// Of a caller of the library: a reader's model has a stop. 2026-11-23: memory before the surfaces was read (AddressSanitizer).
TEST(Compile, says_that_no_surface_is_the_stop) {
  prescription::Model model;
  model.wavelengths_nm = {550};
  model.surfaces.resize(2);
  const scene::CompileResult result = scene::compile(model);
  EXPECT_FALSE(result.scene);
  ASSERT_EQ(result.findings.error_count(), 1);
  EXPECT_EQ(result.findings.all()[0].what, "no surface is the stop");
}

// The same focal plane with a focal length that is no binary fraction: what rounding leaves is no pupil.
TEST(Compile, a_telecentric_stop_is_found_although_rounding_moves_the_pupil) {
  int count = 0;
  for (const double f : {73.1, 51.3, 20.3, 11.7}) {
    const std::string surfaces = fmt::format("  - {{conic: {{radius_mm: {:.17g}}}, thickness_mm: 0, medium: {{index: 1.513}}}}\n  - {{thickness_mm: {:.17g}}}\n"
                                             "  - {{stop: true, thickness_mm: 100}}\n  - {{}}\n", f * 0.513, f);
    expect_error(prescription_of(surfaces), "entrance pupil is at infinity", 3);
    EXPECT_TRUE(scene_of(surfaces, "object_na: 0.1", "object: {distance_mm: 60}\nfields: {object_heights_mm: [[0, 1]]}\n").scene.pupil.telecentric);
    ++count;
  }
  EXPECT_EQ(count, 4);
}

TEST(Compile, telecentric_beams_have_the_tangent_of_their_aperture) {
  const CompiledScene compiled = scene_of("  - {thickness_mm: 0}\n" + telecentric_lens, "object_na: 0.3", "object: {distance_mm: 100, medium: {index: 1.5}}\nfields: {object_heights_mm: [[0, 1]]}\n");
  EXPECT_TRUE(compiled.scene.pupil.telecentric);
  EXPECT_NEAR(compiled.scene.pupil.edge_tangent, 0.2 / std::sqrt(0.96), 1e-16);
  EXPECT_TRUE(std::isnan(compiled.first_order.entrance_pupil.semi_diameter));
}

}  // namespace
}  // namespace sagitta::test
