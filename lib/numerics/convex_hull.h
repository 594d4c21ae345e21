// SPDX-License-Identifier: Apache-2.0
// The convex hull of points that come one by one, in bounded memory for the clouds that occur.
//
// New points wait in a list; when it is full, the list and the hull so far become the new hull. A point inside a circle
// about the origin that the hull contains is dropped at sight, and so is one inside a polygon of some of the hull's vertices: the
// fewer points come from outside the hull, the faster it goes.
//
// Source: A. M. Andrew, Inf. Process. Lett. 9, 216 (1979).
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
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
    alignas(Vector) double outer_x[block_size], outer_y[block_size];
    const Vector inner_x = inner_.x, inner_y = inner_.y, inner_squared = inner_squared_;
    std::size_t outer_count = 0;
    for (std::size_t i = 0; i < count; i += n) {
      const Vector px = Vector::load(x + i), py = Vector::load(y + i);
      const Vector from_x = px - inner_x, from_y = py - inner_y;
      if (all(from_x * from_x + from_y * from_y < inner_squared)) continue;
      px.store(outer_x + outer_count), py.store(outer_y + outer_count);
      outer_count += n;
    }
    for (std::size_t i = 0; i < outer_count; i += n) {
      const Vector px = Vector::load(outer_x + i), py = Vector::load(outer_y + i);
      if (all(rough_.holds<n>(px, py)) || all(coarse_.holds<n>(px, py))) continue;
      const Mask<n> inside = fine_.holds<n>(px, py);
      if (!all(inside)) keep_those(outer_x + i, outer_y + i, n, select(inside, Vector(0), Vector(1)));
    }
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
    friend bool operator<(const Point& a, const Point& b) { return a.x < b.x || (a.x == b.x && a.y < b.y); }
    friend bool operator==(const Point&, const Point&) = default;
  };

  // Those of n points whose lanes are not 0.
  template <class Vector>
  [[gnu::noinline]] void keep_those(const double* x, const double* y, int n, const Vector& lanes) {
    double kept[block_size];
    lanes.store(kept);
    for (int i = 0; i < n; ++i)
      if (kept[i] != 0) points_.push_back({x[i], y[i]});
  }

  // The vertices of the hull that are the farthest along evenly spaced directions, and the half planes left of the edges between
  // them.
  template <std::size_t edge_count>
  struct Polygon {
    double a[edge_count]{}, b[edge_count]{}, c[edge_count]{};  // inside: a x + b y < c for each edge; at first nothing is

    template <int n>
    Mask<n> holds(const Lanes<n>& x, const Lanes<n>& y) const {
      Mask<n> inside = x == x;
      for (std::size_t i = 0; i < edge_count; ++i) inside = inside & (Lanes<n>(a[i]) * x + Lanes<n>(b[i]) * y < Lanes<n>(c[i]));
      return inside;
    }
    // What lies inside does so clearly, rounding could not bring it out.
    void take(const std::vector<Point>& hull) {
      if (hull.size() <= 2) return;
      const auto farthest_along = [&](std::size_t direction, std::size_t from) {
        const double angle = 2 * std::numbers::pi * static_cast<double>(direction) / edge_count, x = std::cos(angle), y = std::sin(angle);
        const auto along = [&](std::size_t vertex) { return x * hull[vertex % hull.size()].x + y * hull[vertex % hull.size()].y; };
        while (along(from + 1) > along(from)) ++from;
        return from;
      };
      std::size_t vertex = farthest_along(0, static_cast<std::size_t>(std::max_element(hull.begin(), hull.end()) - hull.begin()));
      for (std::size_t i = 0; i < edge_count; ++i) {
        const Point& p = hull[vertex % hull.size()];
        vertex = farthest_along(i + 1, vertex);
        const Point& q = hull[vertex % hull.size()];
        a[i] = q.y - p.y, b[i] = p.x - q.x;
        const double size = std::abs(a[i] * p.x) + std::abs(b[i] * p.y);
        c[i] = p == q ? 1 : a[i] * p.x + b[i] * p.y - 1e-14 * size;  // a vertex taken twice makes no edge
      }
    }
  };

  static double turn(const Point& a, const Point& b, const Point& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  }

  // About the middle of the hull's vertices weighted by their neighbours' distance: the least distance to an edge, a little less
  // for rounding.
  void take_circle(const std::vector<Point>& hull) {
    Point sum{0, 0};
    double length = 0, least = INFINITY;
    const auto for_each_edge = [&](const auto& work) {
      for (std::size_t i = 0; i < hull.size(); ++i) {
        const Point &a = hull[i], &b = hull[(i + 1) % hull.size()];
        work(a, b, std::hypot(b.x - a.x, b.y - a.y));
      }
    };
    for_each_edge([&](const Point& a, const Point& b, double edge) {
      sum = {sum.x + edge * (a.x + b.x) / 2, sum.y + edge * (a.y + b.y) / 2};
      length += edge;
    });
    inner_ = {sum.x / length, sum.y / length};
    for_each_edge([&](const Point& a, const Point& b, double edge) { least = std::min(least, turn(inner_, a, b) / edge); });
    inner_squared_ = least > 0 && hull.size() > 2 ? least * least * (1 - 1e-9) : 0;
  }

  [[gnu::noinline]] void reduce() {
    std::sort(points_.begin(), points_.end());
    points_.erase(std::unique(points_.begin(), points_.end()), points_.end());
    std::vector<Point> hull;  // anticlockwise: the lower chain from left to right, then the upper one back
    for (int chain = 0; chain < 2; ++chain) {
      const std::size_t first = hull.size();
      for (const Point& p : points_) {
        while (hull.size() >= first + 2 && turn(hull[hull.size() - 2], hull.back(), p) <= 0) hull.pop_back();
        hull.push_back(p);
      }
      if (hull.size() > first + 1) hull.pop_back();  // the end of one chain is the start of the other
      std::reverse(points_.begin(), points_.end());
    }
    take_circle(hull);
    rough_.take(hull);
    coarse_.take(hull);
    fine_.take(hull);
    points_ = std::move(hull);
    limit_ = std::max<std::size_t>(4096, 2 * points_.size());
  }

  std::vector<Point> points_;  // the hull, and what came since
  Point inner_{0, 0};  // the circle
  double inner_squared_ = 0;
  Polygon<8> rough_;  // four times the edges leave a sixteenth of the points
  Polygon<32> coarse_;
  Polygon<128> fine_;
  std::size_t limit_ = 4096;
};

}  // namespace sagitta::numerics
