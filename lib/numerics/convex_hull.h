// SPDX-License-Identifier: Apache-2.0
// The convex hull of points that come one by one, in bounded memory for the clouds that occur.
//
// New points wait in a list; when it is full, the list and the hull so far become the new hull. Most points are dropped at
// sight, for they lie inside the hull: inside a circle in it; inside an octagon of points on its edges; or, of the wedges
// about the circle's centre into which the plane is cut, inside the chord of their own, from where one of the wedge's sides
// meets the hull to where the other does. 1024 wedges leave a strip of some millionths of the hull's size.
//
// Source: A. M. Andrew, Inf. Process. Lett. 9, 216 (1979).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "lib/numerics/lanes.h"

namespace sagitta::numerics {

class ConvexHull {
 public:
  // At most `block_size` points in vectors of n: the last one's unused lanes hold points of the set again.
  static constexpr std::size_t block_size = 256;
  template <int n>
  void add(const double* x, const double* y, std::size_t count) {
    using Vector = Lanes<n>;
    double outer_x[block_size], outer_y[block_size];
    const Vector middle_x = middle_.x, middle_y = middle_.y, circle = circle_squared_;
    std::size_t outer_count = 0;
    for (std::size_t i = 0; i < count; i += n) {
      const Vector px = Vector::load(x + i), py = Vector::load(y + i), dx = px - middle_x, dy = py - middle_y;
      if (all(dx * dx + dy * dy < circle)) continue;
      Mask<n> inside = px == px;
      for (const HalfPlane& side : octagon_) inside = inside & (Vector(side.a) * px + Vector(side.b) * py < Vector(side.c));
      if (all(inside)) continue;
      px.store(outer_x + outer_count), py.store(outer_y + outer_count);
      outer_count += n;
    }
    std::int32_t wedge[block_size];
    for (std::size_t i = 0; i < outer_count; i += n)
      (turns(Vector::load(outer_x + i) - middle_x, Vector::load(outer_y + i) - middle_y) * Vector(wedge_count)).store(wedge + i);
    for (std::size_t i = 0; i < outer_count; ++i)
      if (!chords_[static_cast<std::size_t>(wedge[i])].holds({outer_x[i], outer_y[i]})) points_.push_back({outer_x[i], outer_y[i]});
    if (points_.size() >= limit_) reduce();
  }

  // Largest distance of any point from (x, y); 0 where there are none. Points of the list and of the hull both count, and
  // the farthest point of a set is one of its hull's vertices.
  double farthest_from(double x, double y) const {
    double squared = 0;
    for (const Point& p : points_) squared = std::max(squared, (p.x - x) * (p.x - x) + (p.y - y) * (p.y - y));
    return std::sqrt(squared);
  }

 private:
  struct Point {
    double x, y;
    friend Point operator-(const Point& p, const Point& q) { return {p.x - q.x, p.y - q.y}; }
    friend bool operator<(const Point& p, const Point& q) { return p.x < q.x || (p.x == q.x && p.y < q.y); }
    friend bool operator==(const Point&, const Point&) = default;
  };
  static double cross(const Point& u, const Point& v) { return u.x * v.y - u.y * v.x; }

  // a x + b y < c: clearly to the left of the line from p to q, so that rounding could not bring a point out. Nothing at first.
  struct HalfPlane {
    double a = 0, b = 0, c = 0;

    HalfPlane() = default;
    HalfPlane(const Point& p, const Point& q) : a(q.y - p.y), b(p.x - q.x), c(a * p.x + b * p.y - 1e-14 * (std::abs(a * p.x) + std::abs(b * p.y))) {}
    bool holds(const Point& p) const { return a * p.x + b * p.y < c; }
  };

  static constexpr int wedge_count = 1024;

  // Directions are counted in turns along the square |x| + |y| = 1, from the x axis to the y axis and on: 0 to below 1, 0 for
  // (0, 0); and back.
  template <class T>
  static T turns(const T& x, const T& y) {
    using std::abs;
    const T size = abs(x) + abs(y), along = y / select(size > T(0), size, T(1));
    const T quarters = select(x < T(0), T(2) - along, select(y < T(0), T(4) + along, along));
    return select(quarters < T(4), quarters, T(0)) * T(0.25);
  }
  static Point direction(double turns) {
    const double quarters = 4 * turns;
    return quarters < 1 ? Point{1 - quarters, quarters} : quarters < 3 ? Point{quarters < 2 ? 1 - quarters : quarters - 3, 2 - quarters} : Point{quarters - 3, quarters - 4};
  }

  [[gnu::noinline]] void reduce() {
    std::sort(points_.begin(), points_.end());
    points_.erase(std::unique(points_.begin(), points_.end()), points_.end());
    std::vector<Point> hull;  // anticlockwise: the lower chain from left to right, then the upper one back
    for (int chain = 0; chain < 2; ++chain) {
      const std::size_t first = hull.size();
      for (const Point& p : points_) {
        while (hull.size() >= first + 2 && cross(hull.back() - hull[hull.size() - 2], p - hull[hull.size() - 2]) <= 0) hull.pop_back();
        hull.push_back(p);
      }
      if (hull.size() > first + 1) hull.pop_back();  // the end of one chain is the start of the other
      std::reverse(points_.begin(), points_.end());
    }
    points_ = std::move(hull);
    limit_ = std::max<std::size_t>(4096, 2 * points_.size());
    if (points_.size() > 2) look_inside();
  }

  const Point& vertex(std::size_t i) const { return points_[i % points_.size()]; }

  // The shapes inside the hull: what lies in one of them is dropped.
  void look_inside() {
    Point sum{0, 0};
    double length = 0, least = INFINITY;
    const auto for_each_edge = [&](const auto& work) {
      for (std::size_t i = 0; i < points_.size(); ++i) work(vertex(i), vertex(i + 1), std::hypot(vertex(i + 1).x - vertex(i).x, vertex(i + 1).y - vertex(i).y));
    };
    for_each_edge([&](const Point& p, const Point& q, double edge) {
      sum = {sum.x + edge * (p.x + q.x), sum.y + edge * (p.y + q.y)};
      length += 2 * edge;
    });
    const Point middle{sum.x / length, sum.y / length};
    for_each_edge([&](const Point& p, const Point& q, double edge) { least = std::min(least, cross(q - p, middle - p) / edge); });
    if (!(least > 0 && std::isfinite(length * length))) return;  // as thin as rounding, or too large; the last one's shapes still hold
    middle_ = middle;
    circle_squared_ = least * least * (1 - 1e-9);

    // Where the wedges' sides meet the hull: side k the edge from vertex i on, which are passed in their order about the middle.
    std::vector<Point> met;
    std::size_t i = 0;
    while (!(vertex(i).y <= middle.y && vertex(i + 1).y > middle.y)) ++i;
    for (int k = 0; k <= wedge_count; ++k) {
      const Point side = direction(static_cast<double>(k % wedge_count) / wedge_count);
      while (cross(side, vertex(i + 1) - middle) <= 0) ++i;
      const Point edge = vertex(i + 1) - vertex(i);
      const double t = cross(vertex(i) - middle, edge) / cross(side, edge);
      met.push_back({middle.x + t * side.x, middle.y + t * side.y});
    }
    for (std::size_t k = 0; k < wedge_count; ++k) chords_[k] = {met[k], met[k + 1]};
    for (std::size_t k = 0; k < octagon_.size(); ++k) octagon_[k] = {met[wedge_count / 8 * k], met[wedge_count / 8 * (k + 1)]};
  }

  std::vector<Point> points_;  // the hull, and what came since
  Point middle_{0, 0};
  double circle_squared_ = 0;
  std::array<HalfPlane, 8> octagon_;
  std::vector<HalfPlane> chords_ = std::vector<HalfPlane>(wedge_count);
  std::size_t limit_ = 4096;
};

}  // namespace sagitta::numerics
