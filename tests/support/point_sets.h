// SPDX-License-Identifier: Apache-2.0
// Points as measured surfaces have them, for tests: the (x, y) of freeform.md's acceptance figure 2, and heights from a
// function.
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "lib/prescription/point_cloud.h"

namespace sagitta::tests {

using prescription::PointCloud;
using Height = std::function<double(double, double)>;

struct Place2 {
  double x, y;
};

inline PointCloud cloud_of(const std::vector<Place2>& places, const Height& height) {
  PointCloud cloud;
  cloud.file = "points.xyz";
  for (const Place2& p : places) {
    cloud.points.push_back({p.x, p.y, height(p.x, p.y)});
    cloud.lines.push_back(static_cast<std::uint32_t>(cloud.points.size()));
  }
  return cloud;
}

// Numbers of [0, 1), the same on every machine (std's distributions are not).
class Uniform {
 public:
  explicit Uniform(std::uint64_t seed) : engine_(seed) {}
  double operator()() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }
  double operator()(double low, double high) { return low + (high - low) * (*this)(); }

 private:
  std::mt19937_64 engine_;
};

// nx x ny points over [-a, a] x [-b, b].
inline std::vector<Place2> regular_grid(int nx, int ny, double a, double b) {
  std::vector<Place2> places;
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) places.push_back({a * (2.0 * i / (nx - 1) - 1), b * (2.0 * j / (ny - 1) - 1)});
  return places;
}

inline std::vector<Place2> uniform_random(int count, double a, std::uint64_t seed) {
  Uniform u(seed);
  std::vector<Place2> places;
  for (int i = 0; i < count; ++i) {
    const double x = u(-a, a), y = u(-a, a);
    places.push_back({x, y});
  }
  return places;
}

// Lines along x, `per_line` points each, jittered by a third of their distance along and a tenth of the lines' across.
inline std::vector<Place2> scan_lines(int lines, int per_line, double a, std::uint64_t seed) {
  Uniform u(seed);
  std::vector<Place2> places;
  for (int j = 0; j < lines; ++j) {
    for (int i = 0; i < per_line; ++i) {
      const double x = a * (2 * (i + u(-1, 1) / 3) / (per_line - 1) - 1), y = a * (2 * (j + u(-1, 1) / 10) / (lines - 1) - 1);
      places.push_back({x, y});
    }
  }
  return places;
}

inline std::vector<Place2> polar_rings(int rings, int meridians, double radius, bool apex) {
  std::vector<Place2> places;
  if (apex) places.push_back({0, 0});
  for (int k = 1; k <= rings; ++k) {
    for (int i = 0; i < meridians; ++i) {
      const double r = radius * k / rings, angle = 2 * std::numbers::pi * i / meridians;
      places.push_back({r * std::cos(angle), r * std::sin(angle)});
    }
  }
  return places;
}

struct Layout {
  std::string name;
  std::vector<Place2> places;
};
// About `count` points each, all within the square [-5, 5]^2 or the disc of radius 5.
inline std::vector<Layout> all_layouts(int count) {
  const int side = static_cast<int>(std::sqrt(count)), half = side / 2;
  return {{"regular", regular_grid(side, side, 5, 5)},
          {"uniform random", uniform_random(count, 5, 11)},
          {"4:1 rectangles", regular_grid(half, 2 * side, 5, 5)},
          {"scan lines with jitter", scan_lines(half, 2 * side, 5, 12)},
          {"polar rings with apex", polar_rings(half, 2 * side, 5, true)},
          {"polar rings without apex", polar_rings(half, 2 * side, 5, false)}};
}

inline Height sphere(double radius) {
  return [=](double x, double y) { return (x * x + y * y) / (radius + std::copysign(std::sqrt(radius * radius - x * x - y * y), radius)); };
}

}  // namespace sagitta::tests
