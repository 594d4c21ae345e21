// SPDX-License-Identifier: Apache-2.0
// Where rays start, which way they go, and from where their OPL counts, for every kind of object.
#include "lib/trace/launch.h"

#include <cmath>

#include "tests/support/prescriptions.h"

namespace sagitta::test {
namespace {

using numerics::dot;
using numerics::norm;
using trace::PupilPoint;
using trace::RayBatch;

constexpr double degree = 3.14159265358979323846 / 180;
const std::vector<PupilPoint> rim_points{{0, 0}, {0, 1}, {1, 0}, {-0.6, 0.8}, {0.3, -0.5}};

// A lens in front of its stop: the entrance pupil is not the stop.
const std::string lens_before_stop = "  - {conic: {radius_mm: 20}, thickness_mm: 2, medium: {index: 1.5}}\n"
                                     "  - {conic: {radius_mm: -30}, thickness_mm: 4}\n"
                                     "  - {stop: true, thickness_mm: 20}\n  - {}\n";

// Where a ray passes a plane across the axis.
Vec3<double> at_plane(const RayBatch& rays, std::size_t i, double z) {
  return rays.position(i) + ((z - rays.z[i]) / rays.n[i]) * rays.direction(i);
}

// The pupil point scales the paraxial entrance pupil, in its plane across the axis.
void expect_through_pupil(const CompiledScene& compiled, const RayBatch& rays) {
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Vec3<double> p = at_plane(rays, i, compiled.first_order.entrance_pupil.z);
    EXPECT_NEAR(p.x, rim_points[i].x * compiled.scene.pupil.semi_diameter, 1e-12);
    EXPECT_NEAR(p.y, rim_points[i].y * compiled.scene.pupil.semi_diameter, 1e-12);
    EXPECT_NEAR(norm(rays.direction(i)), 1, 4e-16);
    EXPECT_GT(rays.n[i], 0);
    EXPECT_EQ(rays.ended[i], 0);
  }
}

TEST(Launch, a_positive_field_angle_travels_toward_plus_y) {
  const CompiledScene compiled = scene_of(lens_before_stop, "entrance_pupil_diameter_mm: 4", "fields: {angles_deg: [[3, 7]]}\n");
  const RayBatch rays = launch(compiled.scene, compiled.scene.fields[0], 1, rim_points);
  expect_through_pupil(compiled, rays);
  const Vec3<double> d = numerics::normalized(Vec3<double>{std::tan(3 * degree), std::tan(7 * degree), 1});
  for (std::size_t i = 0; i < rays.size(); ++i) {
    EXPECT_LE(norm(rays.direction(i) - d), 4e-16);
    EXPECT_GT(rays.m[i], 0);
  }
}

// From the plane across the bundle through the global origin: there n d.p = 0, so OPL = n d.p anywhere.
TEST(Launch, opl_of_a_collimated_bundle_counts_from_the_plane_through_the_origin) {
  for (const double index : {1.0, 1.336}) {
    const CompiledScene compiled = scene_of(lens_before_stop, "entrance_pupil_diameter_mm: 4", "fields: {angles_deg: [[0, 0], [-3, 7]]}\n");
    for (const scene::Field& field : compiled.scene.fields) {
      const RayBatch rays = launch(compiled.scene, field, index, rim_points);
      for (std::size_t i = 0; i < rays.size(); ++i)
        EXPECT_NEAR(rays.optical_path_length(i), index * dot(rays.position(i), rays.direction(i)), 1e-14);
    }
  }
}

TEST(Launch, rays_of_a_finite_object_come_from_its_point) {
  for (const auto& [distance, fields] : {std::pair<double, std::string>{100, "object_heights_mm: [[2, -5]]"}, {3, "object_heights_mm: [[0.2, -0.5]]"}}) {
    const CompiledScene compiled = scene_of(lens_before_stop, "entrance_pupil_diameter_mm: 4",
                                            "object: {distance_mm: " + std::to_string(distance) + ", medium: {index: 1.25}}\nfields: {" + fields + "}\n");
    const RayBatch rays = launch(compiled.scene, compiled.scene.fields[0], 1.25, rim_points);
    expect_through_pupil(compiled, rays);
    const Vec3<double> object{distance == 100 ? 2 : 0.2, distance == 100 ? -5 : -0.5, -distance};
    for (std::size_t i = 0; i < rays.size(); ++i) {
      EXPECT_LE(norm(at_plane(rays, i, -distance) - object), 1e-12);
      // OPL from the object point to where the ray starts
      EXPECT_NEAR(rays.optical_path_length(i), 1.25 * dot(rays.position(i) - object, rays.direction(i)), 2e-14 * (1 + distance));
    }
  }
}

TEST(Launch, field_angles_of_a_finite_object_are_the_chief_rays_at_the_entrance_pupil) {
  const CompiledScene compiled = scene_of(lens_before_stop, "entrance_pupil_diameter_mm: 4", "object: {distance_mm: 50}\nfields: {angles_deg: [[0, 5], [-4, 0]]}\n");
  for (std::size_t field = 0; field < 2; ++field) {
    const RayBatch rays = launch(compiled.scene, compiled.scene.fields[field], 1, rim_points);
    expect_through_pupil(compiled, rays);
    EXPECT_NEAR(rays.l[0] / rays.n[0], field == 0 ? 0 : std::tan(-4 * degree), 1e-15);
    EXPECT_NEAR(rays.m[0] / rays.n[0], field == 0 ? std::tan(5 * degree) : 0, 1e-15);
    for (std::size_t i = 1; i < rays.size(); ++i) EXPECT_LE(norm(at_plane(rays, i, -50) - at_plane(rays, 0, -50)), 1e-12);
  }
  // a positive angle: the object point is below the axis
  EXPECT_LT(at_plane(launch(compiled.scene, compiled.scene.fields[0], 1, rim_points), 0, -50).y, 0);
}

// A virtual object behind the pupil: light converges toward it, and OPL counts from it, so it is negative before it.
TEST(Launch, rays_of_a_virtual_object_travel_toward_it_with_negative_opl) {
  const CompiledScene compiled = scene_of("  - {stop: true, conic: {radius_mm: 20}, thickness_mm: 2, medium: {index: 1.5}}\n  - {thickness_mm: 20}\n  - {}\n",
                                          "entrance_pupil_diameter_mm: 4", "object: {distance_mm: -30}\nfields: {object_heights_mm: [[0, 2]]}\n");
  const RayBatch rays = launch(compiled.scene, compiled.scene.fields[0], 1, rim_points);
  expect_through_pupil(compiled, rays);
  const Vec3<double> object{0, 2, 30};
  for (std::size_t i = 0; i < rays.size(); ++i) {
    EXPECT_LE(norm(at_plane(rays, i, 30) - object), 1e-12);
    EXPECT_NEAR(rays.optical_path_length(i), -norm(object - rays.position(i)), 1e-13);
  }
}

// The entrance pupil before a real object: rays still leave the object point toward +z.
TEST(Launch, rays_leave_an_object_behind_its_entrance_pupil_forward) {
  // thin lens f = 100 (both faces at one place), stop 200 behind it: the entrance pupil is 200 behind... before the lens
  const CompiledScene compiled = scene_of("  - {conic: {radius_mm: 100}, thickness_mm: 0, medium: {index: 1.5}}\n  - {conic: {radius_mm: -100}, thickness_mm: 200}\n"
                                          "  - {stop: true, thickness_mm: 10}\n  - {}\n",
                                          "entrance_pupil_diameter_mm: 4", "object: {distance_mm: 50}\nfields: {object_heights_mm: [[0, 1]]}\n");
  EXPECT_NEAR(compiled.first_order.entrance_pupil.z, -200, 1e-10);
  const RayBatch rays = launch(compiled.scene, compiled.scene.fields[0], 1, rim_points);
  expect_through_pupil(compiled, rays);
  const Vec3<double> object{0, 1, -50};
  for (std::size_t i = 0; i < rays.size(); ++i) {
    EXPECT_LE(norm(at_plane(rays, i, -50) - object), 1e-11);
    EXPECT_NEAR(rays.optical_path_length(i), dot(rays.position(i) - object, rays.direction(i)), 1e-13);
  }
}

// The part of the OPL common to all rays is kept apart: far away, differences between rays keep their digits. The exact
// difference is |p - O| - |c - O| = h^2/(2 D) to 1e-33 here: 2^2/2e15.
TEST(Launch, differences_of_opl_keep_their_digits_however_far_the_object_is) {
  const CompiledScene compiled = scene_of("  - {stop: true, thickness_mm: 2}\n  - {}\n", "entrance_pupil_diameter_mm: 4", "object: {distance_mm: 1e15}\n");
  const RayBatch rays = launch(compiled.scene, compiled.scene.fields[0], 1, rim_points);
  EXPECT_EQ(rays.opl_origin, 1e15);
  EXPECT_EQ(rays.opl[0], 0);
  EXPECT_NEAR(rays.opl[1], 2e-15, 1e-30);
}

TEST(Launch, every_batch_of_a_field_has_one_origin_of_opl) {
  for (const std::string object : {"object: {distance_mm: .inf}\n", "object: {distance_mm: 1}\n", "object: {distance_mm: 100}\n", "object: {distance_mm: -30}\n"}) {
    const CompiledScene compiled = scene_of(lens_before_stop, "entrance_pupil_diameter_mm: 4", object + "fields: {angles_deg: [[1, 2]]}\n");
    const RayBatch chief = launch(compiled.scene, compiled.scene.fields[0], 1, std::vector<PupilPoint>{{0, 0}});
    const RayBatch rays = launch(compiled.scene, compiled.scene.fields[0], 1, rim_points);
    EXPECT_EQ(chief.opl_origin, rays.opl_origin);
    EXPECT_EQ(chief.opl[0], 0) << object;
    EXPECT_EQ(chief.opl[0], rays.opl[0]);
    EXPECT_EQ(chief.position(0), rays.position(0));
  }
}

TEST(Launch, object_na_is_the_sine_of_the_rim_rays_times_the_index) {
  const CompiledScene compiled = scene_of(lens_before_stop, "object_na: 0.3", "object: {distance_mm: 40, medium: {index: 1.5}}\n");
  const RayBatch rays = launch(compiled.scene, compiled.scene.fields[0], 1.5, rim_points);
  expect_through_pupil(compiled, rays);
  EXPECT_NEAR(1.5 * rays.m[1], 0.3, 1e-15);
  EXPECT_NEAR(1.5 * rays.l[2], 0.3, 1e-15);
  EXPECT_NEAR(compiled.scene.pupil.semi_diameter, (compiled.first_order.entrance_pupil.z + 40) * std::tan(std::asin(0.2)), 1e-12);
}

// The stop in the rear focal plane of the lens before it: chief rays are parallel to the axis.
TEST(Launch, telecentric_beams_have_chief_rays_parallel_to_the_axis) {
  // thin lens of f = 100
  const CompiledScene compiled = scene_of("  - {conic: {radius_mm: 100}, thickness_mm: 0, medium: {index: 1.5}}\n  - {conic: {radius_mm: -100}, thickness_mm: 100}\n"
                                          "  - {stop: true, thickness_mm: 100}\n  - {}\n",
                                          "object_na: 0.02", "object: {distance_mm: 100}\nfields: {object_heights_mm: [[0, 0], [1, 2]]}\n");
  EXPECT_TRUE(compiled.scene.pupil.telecentric);
  const double tangent = 0.02 / std::sqrt(1 - 0.02 * 0.02);
  const RayBatch rays = launch(compiled.scene, compiled.scene.fields[1], 1, rim_points);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    EXPECT_EQ(rays.position(i), (Vec3<double>{1, 2, -100}));
    EXPECT_EQ(rays.optical_path_length(i), 0);
    EXPECT_NEAR(rays.l[i] / rays.n[i], rim_points[i].x * tangent, 1e-16);
    EXPECT_NEAR(rays.m[i] / rays.n[i], rim_points[i].y * tangent, 1e-16);
  }
  // and paraxially they pass the middle of the stop
  RayBatch chief = launch(compiled.scene, {true, 1e-4, 2e-4}, 1, std::vector<PupilPoint>{{0, 0}});
  for (int number = 1; number <= 3; ++number) trace_surface(compiled.scene, compiled.wavelength(), number, chief);
  EXPECT_LE(std::hypot(chief.x[0], chief.y[0]), 1e-12);
}

}  // namespace
}  // namespace sagitta::test
