// SPDX-License-Identifier: Apache-2.0
#include "lib/analysis/spot.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "tests/support/point_sets.h"

namespace sagitta::analysis {
namespace {

using surface::Status;
using trace::RayBatch;

struct Point {
  double x, y;
  std::int32_t ended = 0;
};

RayBatch rays_at(const std::vector<Point>& points) {
  RayBatch rays(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    rays.set(i, {points[i].x, points[i].y, 0}, {0, 0, 1}, 0);
    rays.ended[i] = points[i].ended;
  }
  return rays;
}

SpotCollector collected(const std::vector<Point>& points, SpotImage image = SpotImage(4, 1, 0, 0)) {
  SpotCollector collector(std::move(image));
  collector.add(rays_at(points));
  return collector;
}

std::uint64_t total(const SpotImage& image) { return std::accumulate(image.counts.begin(), image.counts.end(), std::uint64_t{0}); }

TEST(Spot, has_the_centroid_and_radii_of_its_points) {
  // a 3-4-5 cross about (1, -2), and lost rays that do not count
  const Spot spot = collected({{1, -2}, {4, 2}, {-2, -6}, {1, 3}, {1, -7}, {100, 100, trace::ending(2, Status::clipped)}, {NAN, 0, trace::ending(1, Status::missed)}}).spot();
  EXPECT_NEAR(spot.centroid_x, 1, 1e-15);
  EXPECT_NEAR(spot.centroid_y, -2, 1e-15);
  EXPECT_NEAR(spot.rms_radius, std::sqrt(20.0), 1e-14);  // (0 + 4 * 25)/5
  EXPECT_NEAR(spot.geometric_radius, 5, 1e-14);
  EXPECT_EQ(spot.rays.total(), 7);
  EXPECT_EQ(spot.rays[Status::ok], 5);
  EXPECT_EQ(spot.rays[Status::clipped], 1);
  EXPECT_EQ(spot.rays[Status::missed], 1);
}

TEST(Spot, of_no_ray_is_not_a_number_and_of_one_has_no_radius) {
  const Spot none = collected({{1, 2, trace::ending(1, Status::missed)}}).spot();
  for (const double value : {none.centroid_x, none.centroid_y, none.rms_radius, none.geometric_radius}) EXPECT_TRUE(std::isnan(value));
  EXPECT_EQ(none.rays.total(), 1);
  const Spot one = collected({{1, 2}}).spot();
  EXPECT_EQ(one.centroid_x, 1);
  EXPECT_EQ(one.centroid_y, 2);
  EXPECT_EQ(one.rms_radius, 0);
  EXPECT_EQ(one.geometric_radius, 0);
}

// A spot of 1e-3 mm that lies 1e6 mm off the axis, collected about its place: the sums keep their digits. ulp(1e6) is
// 1.2e-10, so is the error of the points themselves.
TEST(Spot, far_off_the_axis_keeps_its_digits) {
  std::vector<Point> points;
  for (int i = 0; i < 100000; ++i) {
    const double angle = 2 * std::acos(-1.0) * i / 100000;
    points.push_back({1e6 + 1e-3 * std::cos(angle), -1e6 + 1e-3 * std::sin(angle)});
  }
  const Spot spot = collected(points, SpotImage(4, 1e-3, 1e6, -1e6)).spot();
  EXPECT_NEAR(spot.centroid_x, 1e6, 1.2e-10);
  EXPECT_NEAR(spot.centroid_y, -1e6, 1.2e-10);
  EXPECT_NEAR(spot.rms_radius, 1e-3, 1.2e-10);
  EXPECT_NEAR(spot.geometric_radius, 1e-3, 2.4e-10);
}

// About another centre: c away, the squares of c lose eps c^2/(2 rms).
TEST(Spot, does_not_depend_on_where_it_is_collected_about) {
  tests::Uniform u(41);
  std::vector<Point> points;
  for (int i = 0; i < 5000; ++i) points.push_back({0.01 * u(-1, 1) + 0.3, 0.01 * u(-1, 1) - 0.2});
  const Spot a = collected(points, SpotImage(64, 1e-3, 0.3, -0.2)).spot(), b = collected(points, SpotImage(64, 1e-3, 0, 0)).spot();
  EXPECT_NEAR(a.centroid_x, b.centroid_x, 1e-16);
  EXPECT_NEAR(a.centroid_y, b.centroid_y, 1e-16);
  EXPECT_NEAR(a.rms_radius, b.rms_radius, 4 * 2.2e-16 * 0.13 / 0.008);
  EXPECT_NEAR(a.geometric_radius, b.geometric_radius, 1e-16);
}

// The farthest point from the centroid by trying all, for clouds that fill the hull's list several times.
TEST(Spot, geometric_radius_is_that_of_the_farthest_of_many_points) {
  for (const int kind : {0, 1, 2, 3}) {
    tests::Uniform u(42);
    std::vector<Point> points;
    for (int i = 0; i < 30000; ++i) {
      const double r = std::sqrt(u()), angle = u(0, 6.2831853);
      if (kind == 0) points.push_back({r * std::cos(angle), r * std::sin(angle)});              // disc
      if (kind == 1) points.push_back({3 + r * r * std::cos(angle), r * r * r * std::sin(2 * angle)});  // beside the centre
      if (kind == 2) points.push_back({r, 2 * r});                                                // on a line
      if (kind == 3) points.push_back({std::cos(angle), std::sin(angle)});                       // circle
    }
    const Spot spot = collected(points).spot();
    double farthest = 0;
    for (const Point& p : points) farthest = std::max(farthest, std::hypot(p.x - spot.centroid_x, p.y - spot.centroid_y));
    EXPECT_NEAR(spot.geometric_radius, farthest, 2e-15 * (1 + farthest)) << kind;
  }
}

TEST(Spot, does_not_depend_on_how_the_rays_are_divided_into_batches) {
  tests::Uniform u(43);
  std::vector<Point> points;
  for (int i = 0; i < 20000; ++i) points.push_back({u(-1, 1), u(-1, 1), u() < 0.1 ? trace::ending(3, Status::clipped) : 0});
  const SpotCollector whole = collected(points);
  SpotCollector parts(SpotImage(4, 1, 0, 0));
  for (std::size_t from = 0, size = 1; from < points.size(); from += size, size = 2 * size + 1)
    parts.add(rays_at({points.begin() + static_cast<std::ptrdiff_t>(from), points.begin() + static_cast<std::ptrdiff_t>(std::min(points.size(), from + size))}));
  EXPECT_EQ(whole.spot().centroid_x, parts.spot().centroid_x);
  EXPECT_EQ(whole.spot().rms_radius, parts.spot().rms_radius);
  EXPECT_EQ(whole.spot().geometric_radius, parts.spot().geometric_radius);
  EXPECT_EQ(whole.image().counts, parts.image().counts);
  EXPECT_EQ(whole.spot().rays.of, parts.spot().rays.of);
}

TEST(SpotImage, row_0_is_the_largest_y_and_column_0_the_smallest_x) {
  SpotImage image(4, 1, 10, 20);
  image.add(8.5, 21.5);   // top left
  image.add(11.5, 18.5);  // bottom right
  image.add(11.5, 18.5);
  image.add(10, 20);      // the centre belongs to the pixel right of and above it
  EXPECT_EQ(image.counts[0], 1u);
  EXPECT_EQ(image.counts[15], 2u);
  EXPECT_EQ(image.counts[1 * 4 + 2], 1u);
  EXPECT_EQ(image.pixel_mm, 1);
}

// A point beyond the edge makes the pixels larger, and no ray is lost; the picture is that of the larger pixels from
// the start.
TEST(SpotImage, grows_to_hold_every_ray) {
  for (const int size : {2, 4, 6, 64}) {
    tests::Uniform u(44);
    SpotImage grown(size, 0.25, 0.5, -0.5);
    std::vector<Point> points;
    for (int i = 0; i < 1000; ++i) points.push_back({0.5 + 0.1 * i * u(-1, 1), -0.5 + 0.1 * i * u(-1, 1)});
    for (const Point& p : points) grown.add(p.x, p.y);
    EXPECT_EQ(total(grown), 1000u);
    SpotImage large(size, grown.pixel_mm, 0.5, -0.5);
    for (const Point& p : points) large.add(p.x, p.y);
    EXPECT_EQ(grown.counts, large.counts) << size;
    EXPECT_EQ(grown.pixel_mm, large.pixel_mm);
    EXPECT_GT(grown.pixel_mm, 0.25);
  }
}

TEST(SpotImage, of_a_collector_can_be_had_with_larger_pixels) {
  const SpotCollector collector = collected({{0.5, 0.5}, {1.5, 1.5}, {-1.5, 0.5}, {3, 3, trace::ending(1, Status::missed)}}, SpotImage(8, 0.5, 0, 0));
  const SpotImage image = collector.image_with(2);
  EXPECT_EQ(image.pixel_mm, 2);
  EXPECT_EQ(total(image), 3u);
  EXPECT_EQ(image.counts[3 * 8 + 4], 2u);
  EXPECT_EQ(image.counts[3 * 8 + 3], 1u);
  EXPECT_EQ(collector.image().pixel_mm, 0.5);
}

}  // namespace
}  // namespace sagitta::analysis
