// SPDX-License-Identifier: Apache-2.0
// Heights on a grid by the textbook: slopes by differentiating Lagrange's polynomial, bicubics by their 16 coefficients,
//   p = sum of a_ij s^i t^j,  a = M F M^T,  F of the heights, slopes and twists at the corners of the cell                       (1)
// and beyond the rim, with P and its derivatives at the nearest place of the rim, u and v the distances from there along x and y,
//   p = P + P_x e(u) + P_y e(v) + P_xy e(u) e(v),   e(u) = u - u^2/(2 D) up to the width D of the grid, then D/2                  (2)
// A node without data has the mean of what its known neighbours predict, those next to known ones first.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "lib/prescription/sag_grid.h"

namespace sagitta::test {

template <class T>
struct HeightAndSlopes {
  T z, dz_dx, dz_dy;

  friend HeightAndSlopes operator+(const HeightAndSlopes& a, const HeightAndSlopes& b) { return {a.z + b.z, a.dz_dx + b.dz_dx, a.dz_dy + b.dz_dy}; }
  friend HeightAndSlopes operator-(const HeightAndSlopes& a, const HeightAndSlopes& b) { return {a.z - b.z, a.dz_dx - b.dz_dx, a.dz_dy - b.dz_dy}; }
  friend HeightAndSlopes operator*(const T& size, const HeightAndSlopes& of) { return {size * of.z, size * of.dz_dx, size * of.dz_dy}; }
};

template <class T>
class TextbookGrid {
 public:
  explicit TextbookGrid(const prescription::SagGrid& given) : given_(given) {
    for (const auto& node : given.nodes) nodes_.push_back({T(node.z), T(node.dz_dx), T(node.dz_dy), T(node.d2z_dxdy), !std::isnan(node.z)});
    if (!given.has_given_slopes) take_slopes();
    for (const Node& node : nodes_) is_given_.push_back(node.is_known);
    while (fill()) {}
  }

  bool has_data(const T& x, const T& y) const {
    const T near(1e-9), s = (x - T(given_.first_x)) / T(given_.spacing_x), t = (y - T(given_.first_y)) / T(given_.spacing_y);
    for (int j = 0; j + 1 < given_.count_y; ++j)
      for (int i = 0; i + 1 < given_.count_x; ++i) {
        const bool is_whole = is_given_[at(i, j)] && is_given_[at(i + 1, j)] && is_given_[at(i, j + 1)] && is_given_[at(i + 1, j + 1)];
        if (is_whole && s >= T(i) - near && s <= T(i + 1) + near && t >= T(j) - near && t <= T(j + 1) + near) return true;
      }
    return false;
  }

  HeightAndSlopes<T> height(const T& x, const T& y) const {
    const T hx(given_.spacing_x), hy(given_.spacing_y), width_x = hx * T(given_.count_x - 1), width_y = hy * T(given_.count_y - 1);
    const Beyond of_x((x - T(given_.first_x)), width_x), of_y((y - T(given_.first_y)), width_y);
    const auto cell = [](const T& s, int count) {
      const double at = static_cast<double>(s);
      return at > 0 ? static_cast<int>(std::min(at, count - 2.0)) : 0;  // NaN too
    };
    const int i = cell(of_x.nearest / hx, given_.count_x), j = cell(of_y.nearest / hy, given_.count_y);
    const T s = of_x.nearest / hx - T(i), t = of_y.nearest / hy - T(j);
    T F[4][4];  // rows: at s = 0, 1, then the slopes there; columns likewise along t
    for (int a = 0; a < 2; ++a)
      for (int b = 0; b < 2; ++b) {
        const Node& node = nodes_[at(i + a, j + b)];
        F[a][b] = node.z, F[2 + a][b] = hx * node.x, F[a][2 + b] = hy * node.y, F[2 + a][2 + b] = hx * hy * node.xy;
      }
    constexpr int M[4][4]{{1, 0, 0, 0}, {0, 0, 1, 0}, {-3, 3, -2, -1}, {2, -2, 1, 1}};
    T P(0), P_x(0), P_y(0), P_xy(0), s_k(1), s_before(0);
    for (int k = 0; k < 4; ++k) {
      T t_l(1), t_before(0);
      for (int l = 0; l < 4; ++l) {
        T a(0);  // (1)
        for (int m = 0; m < 4; ++m)
          for (int n = 0; n < 4; ++n) a += T(M[k][m] * M[l][n]) * F[m][n];
        P += a * s_k * t_l, P_x += T(k) * a * s_before * t_l / hx, P_y += T(l) * a * s_k * t_before / hy, P_xy += T(k * l) * a * s_before * t_before / (hx * hy);
        t_before = t_l, t_l *= t;
      }
      s_before = s_k, s_k *= s;
    }
    const T &e = of_x.moved, &f = of_y.moved;
    return {P + P_x * e + P_y * f + P_xy * e * f, (P_x + P_xy * f) * of_x.slope, (P_y + P_xy * e) * of_y.slope};  // (2)
  }

 private:
  struct Node {
    T z, x, y, xy;
    bool is_known;
  };
  struct Beyond {
    T nearest, moved{0}, slope{1};  // e(u), e'(u)

    Beyond(const T& from_first, const T& width) : nearest(from_first) {
      if (from_first < T(0)) nearest = T(0);
      if (from_first > width) nearest = width;
      const T u = from_first - nearest, size = u < T(0) ? T(-u) : u;
      if (size == T(0)) return;
      const T e = size < width ? T(size - size * size / (T(2) * width)) : T(width / T(2));
      moved = u < T(0) ? T(-e) : e, slope = size < width ? T(T(1) - size / width) : T(0);
    }
  };

  std::size_t at(int i, int j) const { return static_cast<std::size_t>(j) * static_cast<std::size_t>(given_.count_x) + static_cast<std::size_t>(i); }

  // Of Lagrange's polynomial through up to five known values in a row, those around it as far as may be; false where it stands alone.
  template <class ValueAt>
  static bool derivative(int place, int count, const ValueAt& value_at, const T& spacing, T& result) {
    int begin = place, end = place + 1;
    while (begin > 0 && value_at(begin - 1)) --begin;
    while (end < count && value_at(end)) ++end;
    while (end - begin > 5) (place - begin > end - 1 - place ? ++begin : --end);
    if (end - begin < 2) return false;
    result = T(0);
    for (int j = begin; j < end; ++j)
      for (int left_out = begin; left_out < end; ++left_out) {  // of the product of x - x_i the factor that is differentiated
        if (left_out == j) continue;
        T product = *value_at(j);
        for (int i = begin; i < end; ++i)
          if (i != j) product *= (i == left_out ? T(1) : T(place - i)) / T(j - i);
        result += product / spacing;
      }
    return true;
  }
  void take_slopes() {
    const auto each = [&](T Node::*to, T Node::*from, bool is_along_x) {
      const std::vector<Node> before = nodes_;
      for (int j = 0; j < given_.count_y; ++j)
        for (int i = 0; i < given_.count_x; ++i) {
          Node& node = nodes_[at(i, j)];
          if (!before[at(i, j)].is_known) continue;
          const auto value_at = [&](int k) -> const T* {
            const Node& other = before[is_along_x ? at(k, j) : at(i, k)];
            return other.is_known ? &(other.*from) : nullptr;
          };
          node.is_known = derivative(is_along_x ? i : j, is_along_x ? given_.count_x : given_.count_y, value_at, T(is_along_x ? given_.spacing_x : given_.spacing_y), node.*to);
        }
    };
    // What stands alone along y counts for slopes along x, and the other way round; twists need both.
    const std::vector<Node> all = nodes_;
    each(&Node::y, &Node::z, false);
    const std::vector<Node> along_y = nodes_;
    nodes_ = all;
    each(&Node::x, &Node::z, true);
    each(&Node::xy, &Node::x, false);
    for (std::size_t k = 0; k < nodes_.size(); ++k) nodes_[k].y = along_y[k].y, nodes_[k].is_known = nodes_[k].is_known && along_y[k].is_known;
  }
  bool fill() {
    const std::vector<Node> before = nodes_;
    bool is_any = false;
    for (int j = 0; j < given_.count_y; ++j)
      for (int i = 0; i < given_.count_x; ++i) {
        if (before[at(i, j)].is_known) continue;
        Node sum{T(0), T(0), T(0), T(0), true};
        int known = 0;
        for (int b = std::max(0, j - 1); b <= std::min(given_.count_y - 1, j + 1); ++b)
          for (int a = std::max(0, i - 1); a <= std::min(given_.count_x - 1, i + 1); ++a) {
            const Node& from = before[at(a, b)];
            if (!from.is_known) continue;
            ++known;
            sum.z += from.z + from.x * T(i - a) * T(given_.spacing_x) + from.y * T(j - b) * T(given_.spacing_y), sum.x += from.x, sum.y += from.y;
          }
        if (known == 0) continue;
        nodes_[at(i, j)] = {sum.z / T(known), sum.x / T(known), sum.y / T(known), T(0), true};
        is_any = true;
      }
    return is_any;
  }

  const prescription::SagGrid& given_;
  std::vector<Node> nodes_;
  std::vector<char> is_given_;
};

}  // namespace sagitta::test
