// SPDX-License-Identifier: Apache-2.0
// The convex hull of points that come one by one, in bounded memory for the clouds that occur.
//
// New points wait in a list; when it is full, the list and the hull so far become the new hull. A point inside a circle
// about the origin that the hull contains is dropped at sight, and so is one inside a polygon of some of the hull's vertices:
// the fewer points come from outside the hull, the faster it goes.
//
// Source: A. M. Andrew, Inf. Process. Lett. 9, 216 (1979).
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

namespace sagitta::numerics {

class ConvexHull {
 public:
  // At most `block_size` points.
  static constexpr std::size_t block_size = 256;
  void add(const double* x, const double* y, std::size_t count) {
    double outer_x[block_size], outer_y[block_size], outside[block_size];
    std::size_t outer_count = 0;
    for (std::size_t i = 0; i < count; ++i) {
      outer_x[outer_count] = x[i], outer_y[outer_count] = y[i];
      outer_count += x[i] * x[i] + y[i] * y[i] < inner_squared_ ? 0 : 1;
    }
    if (outer_count == 0) return;
    std::fill_n(outside, outer_count, 0.0);
    for (std::size_t edge = 0; edge < edge_count; ++edge) {
      const double a = polygon_.a[edge], b = polygon_.b[edge], c = polygon_.c[edge];
      for (std::size_t i = 0; i < outer_count; ++i) outside[i] = a * outer_x[i] + b * outer_y[i] < c ? outside[i] : 1;
    }
    for (std::size_t i = 0; i < outer_count; ++i)
      if (outside[i] != 0) points_.push_back({outer_x[i], outer_y[i]});
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

  static constexpr std::size_t edge_count = 32;
  struct Polygon {
    double a[edge_count]{}, b[edge_count]{}, c[edge_count]{};  // inside: a x + b y < c for each edge; at first nothing is
  };

  static double turn(const Point& a, const Point& b, const Point& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  }

  // Some vertices of the hull, evenly taken in its order, and the half planes left of the edges between them; what lies inside
  // does so clearly, rounding could not bring it out.
  void make_polygon(const std::vector<Point>& hull) {
    if (hull.size() <= 2) return;
    for (std::size_t i = 0; i < edge_count; ++i) {
      const Point &p = hull[i * hull.size() / edge_count], &q = hull[(i + 1) % edge_count * hull.size() / edge_count];
      const double a = q.y - p.y, b = p.x - q.x, size = std::abs(a * p.x) + std::abs(b * p.y);
      // a vertex taken twice makes no edge
      polygon_.a[i] = a, polygon_.b[i] = b;
      polygon_.c[i] = p == q ? 1 : a * p.x + b * p.y - 1e-14 * size;
    }
  }

  void reduce() {
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
    // The circle about the origin inside the hull: the least distance to an edge, a little less for rounding.
    double inner = INFINITY;
    for (std::size_t i = 0; i < hull.size(); ++i) {
      const Point &a = hull[i], &b = hull[(i + 1) % hull.size()];
      inner = std::min(inner, turn({0, 0}, a, b) / std::hypot(b.x - a.x, b.y - a.y));
    }
    inner_squared_ = inner > 0 && hull.size() > 2 ? inner * inner * (1 - 1e-9) : 0;
    make_polygon(hull);
    points_ = std::move(hull);
    limit_ = std::max<std::size_t>(4096, 2 * points_.size());
  }

  std::vector<Point> points_;  // the hull, and what came since
  double inner_squared_ = 0;
  Polygon polygon_;
  std::size_t limit_ = 4096;
};

}  // namespace sagitta::numerics
