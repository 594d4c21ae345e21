// SPDX-License-Identifier: Apache-2.0
// Frames that follow one another, against matrices written out by hand, one rotation about one axis each: columns are the axes of the frame.
#include "lib/lens_file/placement.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace sagitta::lens_file {
namespace {

using Vector = numerics::Vec3<double>;

// The axes of a frame and its origin, in the frame of the object.
struct Axes {
  Vector origin, x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};

  void shift(double dx, double dy, double dz) { origin = origin + dx * x + dy * y + dz * z; }
  // Right-handed: +y toward +z, +z toward +x, +x toward +y.
  void tilt_x(double deg) { turn(y, z, deg); }
  void tilt_y(double deg) { turn(z, x, deg); }
  void tilt_z(double deg) { turn(x, y, deg); }

 private:
  static void turn(Vector& from, Vector& toward, double deg) {
    const double a = deg * std::acos(-1.0) / 180, c = std::cos(a), s = std::sin(a);
    const Vector f = from, t = toward;
    from = c * f + s * t;
    toward = c * t - s * f;
  }
};

Surface surface(Real thickness) {
  Surface one;
  one.thickness = thickness;
  return one;
}

void expect_near(const Vector& a, const Vector& b, double tolerance) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

// The frame that a prescription makes of a place: decenter from the point on the axis, then tilts about the new axes.
Axes frame_of(const Placed& placed, double axis_z) {
  Axes axes;
  axes.shift(placed.decenter_mm.x, placed.decenter_mm.y, axis_z + placed.decenter_mm.z);
  axes.tilt_x(placed.tilt_deg.x), axes.tilt_y(placed.tilt_deg.y), axes.tilt_z(placed.tilt_deg.z);
  return axes;
}

TEST(Placement, agrees_with_frames_that_are_turned_by_hand) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> angle(-170, 170), length(-20, 20);
  int checked = 0;
  for (int trial = 0; trial < 300; ++trial) {
    Lens lens;
    Axes axes;
    double axis_z = 0;
    std::vector<Axes> expected;
    std::vector<double> places;
    for (int i = 0; i < 5; ++i) {
      Surface one = surface(length(random));
      for (int k = 0; k < trial % 3; ++k) {
        const double dx = length(random), dy = length(random), a = angle(random), b = angle(random), c = angle(random), gap = length(random);
        const bool tilts_first = random() % 2 == 0;
        one.before.push_back({{dx, dy, 0}, {a, b, c}, tilts_first});
        one.before.push_back(Move::along_axis(gap));
        one.thickness_before += gap, axis_z += gap;
        if (tilts_first) axes.tilt_z(c), axes.tilt_y(b), axes.tilt_x(a), axes.shift(dx, dy, 0);
        else axes.shift(dx, dy, 0), axes.tilt_x(a), axes.tilt_y(b), axes.tilt_z(c);
        axes.shift(0, 0, gap);
      }
      Axes alone = axes;
      if (i % 2 == 1) {
        const double dy = length(random), a = angle(random), b = angle(random);
        one.own.push_back({{0, dy, 0}, {a, b, 0}});
        alone.shift(0, dy, 0), alone.tilt_x(a), alone.tilt_y(b);
      }
      expected.push_back(alone), places.push_back(axis_z);
      axes.shift(0, 0, static_cast<double>(one.thickness));
      axis_z += static_cast<double>(one.thickness);
      lens.surfaces.push_back(one);
    }
    const std::vector<Placed> placed = place(lens);
    ASSERT_EQ(placed.size(), expected.size());
    for (std::size_t i = 0; i < placed.size(); ++i) {
      const Axes found = frame_of(placed[i], places[i]);
      // 20 turns of at most 100 mm in double.
      expect_near(found.origin, expected[i].origin, 1e-12);
      expect_near(found.x, expected[i].x, 1e-13);
      expect_near(found.y, expected[i].y, 1e-13);
      expect_near(found.z, expected[i].z, 1e-13);
      ++checked;
    }
  }
  EXPECT_EQ(checked, 1500);
}

TEST(Placement, of_one_move_is_that_move_to_its_last_digit) {
  for (const auto& [decenter, tilt] : {std::pair{Vector{0.1, -48.695345, 0.3}, Vector{-8.438645, 0, 0}}, std::pair{Vector{}, Vector{1.1, -2.2, 3.3}}, std::pair{Vector{}, Vector{0, 135, 0}},
                                       std::pair{Vector{}, Vector{0, 0, -179.9}}, std::pair{Vector{1e-7, 0, 0}, Vector{90, 0, 0}}, std::pair{Vector{}, Vector{180, 0, 0}}}) {
    Lens lens;
    lens.surfaces = {surface(0.1L), surface(0.7L)};
    const auto real = [](double x) { return std::strtold(std::to_string(x).c_str(), nullptr); };
    lens.surfaces[1].own.push_back({{real(decenter.x), real(decenter.y), real(decenter.z)}, {real(tilt.x), real(tilt.y), real(tilt.z)}});
    if (decenter.x == 1e-7) lens.surfaces[1].own[0].decenter.x = 1e-7L;
    const std::vector<Placed> placed = place(lens);
    EXPECT_FALSE(placed[0].is_moved());
    EXPECT_EQ(placed[1].decenter_mm, decenter);
    EXPECT_EQ(placed[1].tilt_deg, tilt);
  }
}

TEST(Placement, of_moves_that_cancel_is_none) {
  Lens lens;
  const Move there{{0.3L, -1.7L, 0}, {10, -20, 33.3L}};
  lens.surfaces = {surface(12.34L), surface(5.6L), surface(-5.6L), surface(20), surface(0)};
  lens.surfaces[1].before = {there};
  lens.surfaces[3].before = {there.inverse(), Move::along_axis(5.6L)};
  lens.surfaces[3].thickness_before = 5.6L;
  const std::vector<Placed> placed = place(lens);
  EXPECT_FALSE(placed[0].is_moved());
  EXPECT_EQ(placed[1].decenter_mm, (Vector{0.3, -1.7, 0}));
  EXPECT_EQ(placed[1].tilt_deg, (Vector{10, -20, 33.3}));
  EXPECT_TRUE(placed[2].is_moved());
  EXPECT_FALSE(placed[3].is_moved());
  EXPECT_FALSE(placed[4].is_moved());
}

// Light along z, a mirror turned by 45 degrees about x, the axis turned as far once more: it goes on along +y, 30 mm away from the mirror.
TEST(Placement, of_a_fold_has_exact_places_and_angles) {
  Lens lens;
  lens.surfaces = {surface(50), surface(-30), surface(0)};
  lens.surfaces[1].before = {{{}, {45, 0, 0}}};
  lens.surfaces[1].after = {{{}, {45, 0, 0}}};
  const std::vector<Placed> placed = place(lens);
  EXPECT_EQ(placed[1].tilt_deg, (Vector{45, 0, 0}));
  EXPECT_EQ(placed[2].tilt_deg, (Vector{90, 0, 0}));
  EXPECT_EQ(placed[2].decenter_mm, (Vector{0, 30, 30}));  // the axis is at 50 - 30
}

}  // namespace
}  // namespace sagitta::lens_file
