// SPDX-License-Identifier: Apache-2.0
// Fields by visual angles and by where their images are: paraxially, in closed form, and by real chief rays.
#include "lib/trace/fields.h"

#include <cmath>
#include <numbers>

#include "tests/support/prescriptions.h"

namespace sagitta::test {
namespace {

using trace::PupilPoint;

constexpr double degree = std::numbers::pi / 180;

// A thin lens of f = 100 between air and air, with a plane behind it.
const std::string thin = "  - {stop: true, conic: {radius_mm: 100}, thickness_mm: 0, medium: {index: 1.5}}\n  - {conic: {radius_mm: -100}, thickness_mm: 100}\n  - {}\n";
const std::string narrow = "entrance_pupil_diameter_mm: 1";

scene::Field paraxial_field(const CompiledScene& compiled, const PupilPoint& height) { return trace::fields_of_paraxial_images(compiled.scene, std::vector{height}).at(0).value(); }

TEST(Fields, of_paraxial_images_are_height_over_focal_length) {
  const CompiledScene lens = scene_of(thin, narrow);
  EXPECT_FALSE(paraxial_field(lens, {3, -25}).is_height);
  EXPECT_NEAR(paraxial_field(lens, {3, -25}).x, 0.03, 1e-16);
  EXPECT_NEAR(paraxial_field(lens, {3, -25}).y, -0.25, 1e-16);
  EXPECT_EQ(paraxial_field(lens, {0, 0}).y, 0);
  // from water the image of the angle t is n f t high; a mirror turns no sign
  const CompiledScene from_water = scene_of("  - {stop: true, conic: {radius_mm: 10}, thickness_mm: 60, medium: {index: 1.6}}\n  - {}\n", narrow, "object: {medium: {index: 1.25}}\n");
  EXPECT_NEAR(paraxial_field(from_water, {0, 2}).y, 2 * (0.35 / 10) / 1.25, 1e-16);
  const CompiledScene mirror = scene_of("  - {stop: true, conic: {radius_mm: -200}, thickness_mm: -100, medium: mirror}\n  - {}\n", narrow);
  EXPECT_NEAR(paraxial_field(mirror, {0, 2}).y, 0.02, 1e-17);
}

TEST(Fields, of_paraxial_images_of_a_near_object_are_height_over_magnification) {
  const scene::Field field = paraxial_field(scene_of(thin, narrow, "object: {distance_mm: 300}\nfields: {object_heights_mm: [[0, 0]]}\n"), {1, -5});  // m = -1/2
  EXPECT_TRUE(field.is_height);
  EXPECT_NEAR(field.x, -2, 1e-14);
  EXPECT_NEAR(field.y, 10, 1e-14);
}

// Each section has its own focal length, and its own nodal point.
const std::string astigmatic = "  - {stop: true, biconic: {radius_x_mm: 25, radius_y_mm: 50}, thickness_mm: 100, medium: {index: 1.5}}\n  - {}\n";

TEST(Fields, of_an_astigmatic_system_go_by_its_sections) {
  const scene::Field field = paraxial_field(scene_of(astigmatic, narrow), {1, 1});
  EXPECT_NEAR(field.x, 0.5 / 25, 1e-16);
  EXPECT_NEAR(field.y, 0.5 / 50, 1e-16);
  // nodal points in the centres of curvature, 200 and 225 or 250 mm behind the object
  const CompiledScene near = scene_of(astigmatic, narrow, "object: {distance_mm: 200}\nfields: {object_heights_mm: [[0, 0]]}\n");
  const scene::Field seen = trace::fields_of_visual_angles(near.scene, std::vector<PupilPoint>{{0.1, 0.1}}).at(0).value();
  EXPECT_TRUE(seen.is_height);
  EXPECT_NEAR(seen.x, -22.5, 1e-13);
  EXPECT_NEAR(seen.y, -25, 1e-13);
}

TEST(Fields, of_visual_angles_of_a_distant_object_are_its_angles) {
  const scene::Field field = trace::fields_of_visual_angles(scene_of(thin, narrow).scene, std::vector<PupilPoint>{{0.1, -0.3}}).at(0).value();
  EXPECT_FALSE(field.is_height);
  EXPECT_EQ(field.x, 0.1);
  EXPECT_EQ(field.y, -0.3);
}

// The ray aimed at the front nodal point leaves in the direction it came in (its slope in the same medium: a thick lens in air, nearly on the axis).
TEST(Fields, of_visual_angles_send_an_undeviated_ray_through_the_nodal_points) {
  const std::string thick = "  - {stop: true, conic: {radius_mm: 40}, thickness_mm: 12, medium: {index: 1.6}}\n  - {conic: {radius_mm: -90}, thickness_mm: 150}\n  - {}\n";
  const CompiledScene lens = scene_of(thick, narrow, "object: {distance_mm: 130}\nfields: {object_heights_mm: [[0, 0]]}\n");
  const double t = 1e-4, nodal = lens.first_order.front_nodal_point;
  const scene::Field field = trace::fields_of_visual_angles(lens.scene, std::vector<PupilPoint>{{0, t}}).at(0).value();
  trace::RayBatch ray = trace::launch(lens.scene, field, lens.wavelength(), std::vector<PupilPoint>{{0, nodal * -t / lens.scene.pupil.semi_diameter}});  // where it crosses the pupil, at z = 0
  trace::trace(lens.scene, lens.wavelength(), ray);
  EXPECT_EQ(ray.ended[0], 0);
  EXPECT_NEAR(ray.m[0] / ray.n[0], t, 1e-9);  // aberrations: t^3 and the like
}

TEST(Fields, that_do_not_exist_are_none) {
  const CompiledScene afocal = scene_of("  - {stop: true, thickness_mm: 10}\n  - {}\n", narrow);
  EXPECT_FALSE(trace::fields_of_paraxial_images(afocal.scene, std::vector<PupilPoint>{{0, 5}}).at(0));
  const CompiledScene near = scene_of("  - {stop: true, thickness_mm: 10}\n  - {}\n", narrow, "object: {distance_mm: 200}\nfields: {object_heights_mm: [[0, 0]]}\n");
  EXPECT_FALSE(trace::fields_of_visual_angles(near.scene, std::vector<PupilPoint>{{0, 0.1}}).at(0));
  const CompiledScene ball = scene_of("  - {stop: true, thickness_mm: 10}\n  - {conic: {radius_mm: -12}}\n", "stop_diameter_mm: 1");
  const trace::Fields fields = trace::fields_of_real_images(ball.scene, std::vector<PupilPoint>{{0, 5}, {0, 13}});
  EXPECT_TRUE(fields.at(0));
  EXPECT_FALSE(fields.at(1));
}

void expect_met(const CompiledScene& compiled, const std::vector<PupilPoint>& places, double least_angle = 0) {
  const trace::Fields fields = trace::fields_of_real_images(compiled.scene, places);
  ASSERT_EQ(fields.size(), places.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    SCOPED_TRACE(i);
    ASSERT_TRUE(fields[i]);
    EXPECT_GE(std::atan(std::hypot(fields[i]->x, fields[i]->y)), least_angle);
    trace::RayBatch chief = launch(compiled.scene, *fields[i], compiled.wavelength(), std::vector<PupilPoint>{{0, 0}});
    trace::trace(compiled.scene, compiled.wavelength(), chief);
    EXPECT_NEAR(chief.x[0], places[i].x, 1e-11);
    EXPECT_NEAR(chief.y[0], places[i].y, 1e-11);
  }
}

const std::vector<PupilPoint> places{{0, 0}, {0, 3}, {-4, 2}, {6, -7}};

TEST(Fields, of_real_images_meet_them) {
  const CompiledScene pinhole = scene_of("  - {stop: true, thickness_mm: 10}\n  - {}\n", "stop_diameter_mm: 1");
  const trace::Fields behind_pinhole = trace::fields_of_real_images(pinhole.scene, std::vector<PupilPoint>{{0, 10}, {-5, 0}});
  EXPECT_NEAR(behind_pinhole.at(0).value().y, 1, 1e-12);
  EXPECT_NEAR(behind_pinhole.at(1).value().x, -0.5, 1e-12);

  const std::string eye = "  - {conic: {radius_mm: 7.72, conic_constant: -0.26}, thickness_mm: 0.55, medium: {index: 1.3777}}\n  - {conic: {radius_mm: 6.5}, thickness_mm: 3.05, medium: {index: 1.3391}}\n"
                          "  - {stop: true, decenter_mm: [0.2, 0, 0], thickness_mm: 0, medium: {index: 1.3391}}\n  - {conic: {radius_mm: 10.2, conic_constant: -3.1316}, thickness_mm: 4, medium: {index: 1.4222}}\n"
                          "  - {conic: {radius_mm: -6, conic_constant: -1}, thickness_mm: 16.32, medium: {index: 1.3377}}\n  - {conic: {radius_mm: -12}}\n";
  for (const char* aperture : {"stop_diameter_mm: 3", "stop_diameter_mm: 3, aim: stop"})
    for (const char* object : {"", "object: {distance_mm: 200}\nfields: {object_heights_mm: [[0, 0]]}\n"}) {
      SCOPED_TRACE(std::string(aperture) + object);
      expect_met(scene_of(eye, aperture, object), places);
    }
  // a wide angle, on an image surface that ends at 12 mm
  expect_met(scene_of(eye, "stop_diameter_mm: 3, aim: stop"), {{0, 11.5}}, 55 * degree);
}

// Decentred and tilted, the place is in the image surface's own frame; apertures have no say.
TEST(Fields, of_real_images_are_in_the_image_surfaces_frame) {
  expect_met(scene_of("  - {stop: true, conic: {radius_mm: 50}, thickness_mm: 150, medium: {index: 1.5}}\n  - {decenter_mm: [1, -2, 0], tilt_deg: [10, -5, 30], semi_diameter_mm: 0.1}\n", "stop_diameter_mm: 3"), {{0, 0}});
  const CompiledScene clipped = scene_of("  - {stop: true, thickness_mm: 10}\n  - {decenter_mm: [1, -2, 0], tilt_deg: [10, -5, 30], semi_diameter_mm: 1}\n", "stop_diameter_mm: 1");
  for (const trace::PupilPoint& place : places) {
    const scene::Field field = trace::fields_of_real_images(clipped.scene, std::vector{place}).at(0).value();
    const auto p = clipped.scene.surfaces[1].global_from_local * numerics::Vec3<double>{place.x, place.y, 0};
    EXPECT_NEAR(field.x, p.x / p.z, 1e-12);
    EXPECT_NEAR(field.y, p.y / p.z, 1e-12);
  }
}

}  // namespace
}  // namespace sagitta::test
