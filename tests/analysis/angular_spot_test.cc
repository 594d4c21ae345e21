// SPDX-License-Identifier: Apache-2.0
#include "lib/analysis/angular_spot.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lib/analysis/job.h"
#include "tests/support/prescriptions.h"

namespace sagitta::analysis {
namespace {

using numerics::Vec3;
using trace::RayBatch;

constexpr double degree = std::numbers::pi / 180;

RayBatch rays_at(const std::vector<Vec3<double>>& points) {
  RayBatch rays(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) rays.set(i, points[i], {0, 0, 1}, 0);
  return rays;
}

AngularSpot spot_of(const std::vector<Vec3<double>>& points, const Vec3<double>& nodal_point, const numerics::Rotation<double>& global_from_local = {}) {
  AngularSpotCollector collector(nodal_point, points.front());
  collector.add(rays_at(points));
  return collector.spot(global_from_local);
}

// Four points around a direction, at the same angle from it and at any distance: distance changes nothing. Their chords to the middle are 2 sin(theta/2).
TEST(AngularSpot, is_the_angle_at_the_nodal_point_whatever_the_distance) {
  const Vec3<double> nodal_point{0.3, -0.2, 1};
  for (const double theta : {1e-7, 1e-3, 0.1})
    for (const double ax : {0.0, 0.5, -1.2}) {
      const Vec3<double> c{std::sin(ax), 0, std::cos(ax)}, right{std::cos(ax), 0, -std::sin(ax)}, up{0, 1, 0};
      std::vector<Vec3<double>> points{nodal_point + 5.0 * c};
      for (const Vec3<double>& side : {right, -right, up, -up})
        points.push_back(nodal_point + (10 + 3 * side.x + 7 * side.y) * (std::cos(theta) * c + std::sin(theta) * side));
      const AngularSpot spot = spot_of(points, nodal_point);
      const double chord = 2 * std::sin(theta / 2);
      EXPECT_NEAR(spot.centroid_x, ax, 1e-15);
      EXPECT_NEAR(spot.centroid_y, 0, 1e-15);
      // a place of 10 mm has steps of 1.8e-15: angles of 2e-16, and a few of them
      EXPECT_NEAR(spot.rms_radius, chord * std::sqrt(0.8), 1e-15) << theta;
      EXPECT_NEAR(spot.geometric_radius, chord, 1e-15) << theta;
    }
}

TEST(AngularSpot, gives_the_direction_of_its_centroid_in_the_global_frame) {
  // the image's own frame is turned by 90 degrees about z: its x is global y
  const numerics::Rotation<double> quarter{{0, -1, 0}, {1, 0, 0}, {0, 0, 1}};
  const AngularSpot spot = spot_of({{std::tan(20 * degree), std::tan(-5 * degree), 1}}, {0, 0, 0}, quarter);
  EXPECT_NEAR(spot.centroid_x, 5 * degree, 1e-15);
  EXPECT_NEAR(spot.centroid_y, 20 * degree, 1e-15);
  EXPECT_EQ(spot.rms_radius, 0);
}

TEST(AngularSpot, of_no_ray_or_at_the_nodal_point_is_not_a_number) {
  for (const Vec3<double>& at : {Vec3<double>{1, 2, 3}, Vec3<double>{1, 2, 4}}) {
    AngularSpotCollector collector({1, 2, 3}, {1, 2, 4});
    RayBatch rays = rays_at({at});
    if (at.z == 4) rays.ended[0] = trace::ending(1, surface::Status::missed);
    collector.add(rays);
    const AngularSpot spot = collector.spot({});
    for (const double value : {spot.centroid_x, spot.centroid_y, spot.rms_radius, spot.geometric_radius}) EXPECT_TRUE(std::isnan(value));
  }
}

// A chief ray through the centre of a sphere is not turned: N' is the centre, and the spot's direction the field's, exactly.
TEST(AngularSpot, of_a_reduced_eye_with_its_stop_at_the_nodal_point_is_the_field_itself) {
  const auto scene = test::scene_of(R"(
  - {conic: {radius_mm: 5.55}, thickness_mm: 5.55, medium: {index: 1.3333333333333333}}
  - {stop: true, thickness_mm: 16.65, medium: {index: 1.3333333333333333}}
  - {conic: {radius_mm: -11}}
)", "entrance_pupil_diameter_mm: 0.001", "fields: {angles_deg: [[0, 0], [0, 10], [-25, 30]]}\n").scene;
  JobRequest request;
  request.ray_count = 7;
  request.want_wavefront = false;
  const auto results = run_job(scene, request);
  const double fields[][2]{{0, 0}, {0, 10}, {-25, 30}};
  ASSERT_EQ(results.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    ASSERT_TRUE(results[i].angular_spot);
    // a pupil of 1 um: aberrations move the centroid by its square
    EXPECT_NEAR(results[i].angular_spot->centroid_x, fields[i][0] * degree, 1e-8);
    EXPECT_NEAR(results[i].angular_spot->centroid_y, fields[i][1] * degree, 1e-8);
    // in the plane across the line of sight a spot of so small an angle is what local x, y and z say; on the axis x and y alone
    if (i == 0) {
      EXPECT_NEAR(results[i].angular_spot->rms_radius, results[i].spot->rms_radius / 16.65, 1e-9 * results[i].angular_spot->rms_radius);
    }
  }
}

TEST(AngularSpot, is_left_out_on_a_plane_and_without_a_nodal_point) {
  JobRequest request;
  request.ray_count = 7;
  request.want_wavefront = false;
  const auto plane = test::scene_of("  - {conic: {radius_mm: 5}, stop: true, thickness_mm: 20, medium: {index: 1.5}}\n  - {}\n");
  EXPECT_FALSE(run_job(plane.scene, request).front().angular_spot);
  const auto afocal = test::scene_of("  - {stop: true, thickness_mm: 20}\n  - {conic: {radius_mm: -30}}\n");
  EXPECT_FALSE(run_job(afocal.scene, request).front().angular_spot);
}

}  // namespace
}  // namespace sagitta::analysis
