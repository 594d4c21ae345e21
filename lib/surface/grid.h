// SPDX-License-Identifier: Apache-2.0
// Heights on a regular grid, on a base conic: Zemax's Grid Sag.
//
//   z = conic(r; c, K) + p(x, y),   p(x_0 + (i + s) h_x, y_0 + (j + t) h_y) = sum over a, b in {0, 1} of
//       z_ab H_a(s) H_b(t) + h_x z_x,ab K_a(s) H_b(t) + h_y z_y,ab H_a(s) K_b(t) + h_x h_y z_xy,ab K_a(s) K_b(t)          (1)
//   H_1 = s^2 (3 - 2 s),   H_0 = 1 - H_1,   K_0 = s (1-s)^2,   K_1 = -s^2 (1-s)
//
// z, z_x, z_y, z_xy   height, slopes and twist at the nodes (i, j), (i+1, j), (i, j+1), (i+1, j+1) of a cell; scene/compile_grid.h says whence
// h_x, h_y            spacings, mm
//
// In each cell a bicubic, C1 over all: on an edge, height and slopes follow from its two nodes alone. Of a smooth surface of which the nodes are exact the height is right to
// O(h^4), the slopes to O(h^3), second derivatives to O(h^2); these jump from cell to cell.
//
// Domain: the rectangle of the nodes, without the cells that touch a node without data, and the conic's. A ray whose hit is elsewhere is outside_data.
//
// The hit is the one continuous with the base conic's (quadric.h, of which the conic is a special case): where the departure is all of the sag, a slanted ray meets the
// base beside its hit, perhaps beyond the rectangle. That is why p goes on there, as far as (1) does with one more row of cells all around, as wide as the whole
// grid: their slopes across the rim fall evenly to 0, and beyond them p is constant. Nodes without data have heights from their neighbours. Rays pass over such places, none
// ends there with a hit; one that meets the base there and has no hit is outside_data too.
//
// The bound of second derivatives that the iteration asks for: those of a bicubic are of degree (1, 3), (2, 2) and (3, 1), and none leaves the range of its Bernstein
// coefficients (cell_bends). Of the whole grid it is known; that of the few cells around a place counts where the other is so large that it matters.
//
// Errors: of heights 24 u of the terms' sizes in (1), of slopes as much of theirs, and what a place that is off by 8 u of its distance from the first node changes.
//
// Source: Zemax OpticStudio's help, "Grid Sag"; the bicubic of four values a node: Ahlin, Math. Comp. 18, 264 (1964).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "lib/surface/conic_departure.h"
#include "lib/surface/quadric.h"

namespace sagitta::surface {

inline constexpr int fewest_grid_nodes = 5, most_grid_nodes = 100'000;  // along x or y

// At a node: the height in mm; slopes times the spacing, the twist times both.
struct alignas(32) GridNode {
  double z, x, y, xy;
};

// Largest second derivatives, 1/mm.
struct GridBends {
  double xx = 0, xy = 0, yy = 0;

  void include(const GridBends& other) { xx = std::max(xx, other.xx), xy = std::max(xy, other.xy), yy = std::max(yy, other.yy); }
};

struct BicubicGrid : QuadricDeparture<BicubicGrid> {
  static constexpr std::string_view kind = "grid";
  static constexpr std::array keys{
      numerics::Key{.name = "points", .kind = numerics::ValueKind::file, .meaning = "file of the heights", .required = true},
      numerics::Key{.name = "format", .kind = numerics::ValueKind::text, .meaning = "format of the file", .choices = "zemax|xyz"},
      base_radius_key, base_conic_constant_key};

  // Nodes count along both axes from 0 at the least x and y; with the row around them they are in rows of rising y, each of rising x.
  int count_x = 0, count_y = 0;  // without the row around them
  double first_x = 0, first_y = 0, spacing_x = 1, spacing_y = 1;  // mm
  const GridNode* nodes = nullptr;
  const char* is_hole = nullptr;  // of each cell, the row around them included; null: there are none
  GridBends steepest_bends;       // of p, anywhere
  bool has_given_slopes = true;   // else they follow from the heights

  std::string kernel() const {
    return "bicubic grid of " + std::to_string(count_x) + " x " + std::to_string(count_y) + (has_given_slopes ? "" : ", slopes by differences");
  }
  std::size_t data_bytes() const {
    const auto cells = static_cast<std::size_t>(count_x + 1) * static_cast<std::size_t>(count_y + 1);
    return sizeof *this + static_cast<std::size_t>(count_x + 2) * static_cast<std::size_t>(count_y + 2) * sizeof *nodes + (is_hole ? cells : 0);
  }

  // A cell, and where in it: from its first node on, in its own width; the width in spacings.
  template <class T>
  struct Along {
    int cell;
    T part;
    double width;
  };
  // In spacings from the first node; cell 0 is before it.
  template <class T>
  [[gnu::always_inline]] static Along<T> along(const T& from_first, int count) {
    const double last = count - 1;
    if (from_first >= T(0) && from_first <= T(last)) {
      const int cell = std::min(static_cast<int>(static_cast<double>(from_first)), count - 2);
      return {cell + 1, from_first - T(cell), 1};
    }
    const bool is_before = from_first < T(0);
    const T part = is_before ? T(T(1) + from_first / T(last)) : T((from_first - T(last)) / T(last));
    return {is_before ? 0 : count, part < T(0) ? T(0) : part > T(1) ? T(1) : part, last};
  }
  template <class T>
  Along<T> along_x(const T& x) const {
    return along(T((x - T(first_x)) / T(spacing_x)), count_x);
  }
  template <class T>
  Along<T> along_y(const T& y) const {
    return along(T((y - T(first_y)) / T(spacing_y)), count_y);
  }
  const GridNode* node(int i, int j) const { return nodes + static_cast<std::size_t>(j) * static_cast<std::size_t>(count_x + 2) + i; }

  // Of a value with differences, and of its derivative along the cell, in spacings: H_1, K_0, -K_1 of (1).
  template <class T>
  struct Basis {
    T h, k0, k1;
    T h_d, k0_d, k1_d;

    explicit Basis(const Along<T>& at) {
      const T s = at.part, rest = T(1) - s, w(at.width), of_h = s * s * (T(3) - T(2) * s);
      h = of_h, k0 = w * (s * rest * rest), k1 = w * (s * s * rest);
      h_d = T(6) * s * rest / w, k0_d = rest * (T(1) - T(3) * s), k1_d = s * (T(2) - T(3) * s);
    }
  };

  // p with its slopes, and the sizes of the terms of p.
  template <class T>
  struct Departure {
    T value, dx, dy, size;
  };
  template <class T>
  Departure<T> departure(const T& x, const T& y) const {
    using std::abs;
    const Along<T> at_x = along_x(x), at_y = along_y(y);
    const Basis<T> bx(at_x), by(at_y);
    const GridNode *low = node(at_x.cell, at_y.cell), *high = low + count_x + 2;
    // Along y first: on the left side, and of the difference of both sides. Differences of nodes come first of all: a height that all have costs slopes nothing.
    const T z(low[0].z), rise = T(high[0].z) - z, step = T(low[1].z) - z, twist = (T(high[1].z) - T(low[1].z)) - rise;
    const T y0 = T(low[0].y) * by.k0, y1 = T(high[0].y) * by.k1, y0_y = T(low[0].y) * by.k0_d, y1_y = T(high[0].y) * by.k1_d;
    const T dy0 = T(low[1].y) - T(low[0].y), dy1 = T(high[1].y) - T(high[0].y);
    const T left = z + (rise * by.h + (y0 - y1)), left_y = rise * by.h_d + (y0_y - y1_y);
    const T across = step + (twist * by.h + (dy0 * by.k0 - dy1 * by.k1)), across_y = twist * by.h_d + (dy0 * by.k0_d - dy1 * by.k1_d);
    const auto slope_at = [&](int side) {  // along x; and its derivative along y
      const T from(low[side].x), by_height = T(high[side].x) - from, low_twist(low[side].xy), high_twist(high[side].xy);
      return Gradient<T>{from + (by_height * by.h + (low_twist * by.k0 - high_twist * by.k1)), by_height * by.h_d + (low_twist * by.k0_d - high_twist * by.k1_d)};
    };
    const Gradient<T> x0 = slope_at(0), x1 = slope_at(1);
    const T of_x0 = x0.x * bx.k0, of_x1 = x1.x * bx.k1;
    return {left + (across * bx.h + (of_x0 - of_x1)), (across * bx.h_d + (x0.x * bx.k0_d - x1.x * bx.k1_d)) / T(spacing_x),
            (left_y + (across_y * bx.h + (x0.y * bx.k0 - x1.y * bx.k1))) / T(spacing_y),
            abs(z) + abs(rise) + abs(y0) + abs(y1) + abs(across) + abs(of_x0) + abs(of_x1)};
  }

  // For QuadricDeparture, which goes over places without data too.
  template <class T>
  Height<T> height(const T& x, const T& y) const {
    using std::abs;
    const Departure<T> p = departure(x, y);
    const T base_z = base.sag(x, y);
    const Gradient<T> slope = base.gradient(x, y);
    return {base_z + p.value, slope.x + p.dx, slope.y + p.dy, abs(base_z) + p.size};
  }

  // On the rim too, and beside it as far as rounding may go.
  template <class T>
  bool has_data(const T& x, const T& y) const {
    constexpr double slack = 1e-9;  // of a spacing
    const auto at_x = static_cast<double>(T((x - T(first_x)) / T(spacing_x))), at_y = static_cast<double>(T((y - T(first_y)) / T(spacing_y)));
    if (!(at_x >= -slack && at_x <= count_x - 1 + slack && at_y >= -slack && at_y <= count_y - 1 + slack)) return false;
    if (!is_hole) return true;
    const auto cell = [](double at, int count) { return std::clamp(static_cast<int>(at), 0, count - 2) + 1; };
    for (const double off_y : {-slack, slack})
      for (const double off_x : {-slack, slack})
        if (!is_hole[cell(at_y + off_y, count_y) * static_cast<std::ptrdiff_t>(count_x + 1) + cell(at_x + off_x, count_x)]) return true;
    return false;
  }
  template <class T>
  T sag(const T& x, const T& y) const {
    return has_data(x, y) ? height(x, y).z : not_a_number<T>();
  }
  template <class T>
  Gradient<T> gradient(const T& x, const T& y) const {
    return has_data(x, y) ? QuadricDeparture::gradient(x, y) : Gradient<T>{not_a_number<T>(), not_a_number<T>()};
  }
  template <class T>
  Crossing<T> meet(const Vec3<T>& p, const Vec3<T>& d) const {
    const Crossing<T> hit = QuadricDeparture::meet(p, d);
    if (hit.status == Status::ok) return has_data(hit.point.x, hit.point.y) ? hit : no_crossing<T>(Status::outside_data);
    if (hit.status == Status::missed) return hit;
    const Crossing<T> start = base.meet(p, d);
    return has_data(start.point.x, start.point.y) ? hit : no_crossing<T>(Status::outside_data);
  }

  // Bernstein coefficients of a cubic between two values with slopes, in its own width, or of a derivative of it.
  template <int derivative>
  static std::array<double, 4 - derivative> controls(double from, double to, double from_slope, double to_slope) {
    if constexpr (derivative == 0) return {from, from + from_slope / 3, to - to_slope / 3, to};
    else if constexpr (derivative == 1) return {from_slope, 3 * (to - from) - from_slope - to_slope, to_slope};
    else return {6 * (to - from) - 4 * from_slope - 2 * to_slope, 6 * (from - to) + 2 * from_slope + 4 * to_slope};
  }
  GridBends cell_bends(int cell_x, int cell_y) const {
    const double wide_x = cell_x == 0 || cell_x == count_x ? count_x - 1 : 1, wide_y = cell_y == 0 || cell_y == count_y ? count_y - 1 : 1;
    const GridNode *low = node(cell_x, cell_y), *high = low + count_x + 2;
    const auto largest = [&]<int of_x, int of_y>() {
      const auto height_of = [&](int side) { return controls<of_y>(low[side].z - low[0].z, high[side].z - low[0].z, wide_y * low[side].y, wide_y * high[side].y); };
      const auto slope_of = [&](int side) { return controls<of_y>(wide_x * low[side].x, wide_x * high[side].x, wide_x * wide_y * low[side].xy, wide_x * wide_y * high[side].xy); };
      const auto z0 = height_of(0), z1 = height_of(1), x0 = slope_of(0), x1 = slope_of(1);
      double most = 0;
      for (std::size_t k = 0; k < z0.size(); ++k)
        for (const double control : controls<of_x>(z0[k], z1[k], x0[k], x1[k])) most = std::max(most, std::abs(control));
      return most;
    };
    const double hx = wide_x * spacing_x, hy = wide_y * spacing_y;
    return {largest.template operator()<2, 0>() / hx / hx, largest.template operator()<1, 1>() / hx / hy, largest.template operator()<0, 2>() / hy / hy};
  }
  template <class T>
  T bend_on(const Vec3<T>& at, const Vec3<T>& d, const T& within) const {
    constexpr double matters = 0.05;  // of the slope along the line, which is 1 or so
    constexpr int most_cells = 16;
    const double L = std::abs(static_cast<double>(d.x)), M = std::abs(static_cast<double>(d.y)), h = static_cast<double>(within);
    const auto along_line = [&](const GridBends& bends) { return L * L * bends.xx + 2 * L * M * bends.xy + M * M * bends.yy; };
    double most = along_line(steepest_bends);
    if (!(most * h <= matters)) {
      constexpr double slack = 1e-9;
      const auto cells = [&](double centre, double reach, double spacing, int count) {
        return std::array{along((centre - reach) / spacing - slack, count).cell, along((centre + reach) / spacing + slack, count).cell};
      };
      const auto [left, right] = cells(static_cast<double>(at.x) - first_x, L * h, spacing_x, count_x);
      const auto [low, high] = cells(static_cast<double>(at.y) - first_y, M * h, spacing_y, count_y);
      if ((right - left + 1.0) * (high - low + 1.0) <= most_cells) {
        GridBends near;
        for (int j = low; j <= high; ++j)
          for (int i = left; i <= right; ++i) near.include(cell_bends(i, j));
        most = along_line(near);
      }
    }
    return base.bend_on(at, d, within) + T(most);
  }

  // On a node the second derivative has two values, of the cells on both sides: their mean, or the one that there are data of.
  double vertex_curvature() const { return base.curvature_y + vertex_bend<false>(); }
  double vertex_curvature_x() const { return base.curvature_y + vertex_bend<true>(); }  // the base is a conic
  template <bool is_along_x>
  double vertex_bend() const {
    constexpr double slack = 1e-9;
    const Along<double> at = is_along_x ? along_x(0.0) : along_y(0.0), beside = is_along_x ? along_y(0.0) : along_x(0.0);
    const int count = is_along_x ? count_x : count_y;
    const double spacing = is_along_x ? spacing_x : spacing_y;
    const auto node_at = [&](int cell, int side) -> const GridNode& { return *(is_along_x ? node(cell, beside.cell + side) : node(beside.cell + side, cell)); };
    const auto in_cell = [&](int cell, double part) {
      const double wide = cell == 0 || cell == count ? count - 1 : 1;
      const auto second = [&](double from, double to, double from_slope, double to_slope) {
        const auto ends = controls<2>(from, to, wide * from_slope, wide * to_slope);
        return (ends[0] + part * (ends[1] - ends[0])) / (wide * wide * spacing * spacing);
      };
      const auto slope_along = [](const GridNode& one) { return is_along_x ? one.x : one.y; };
      const auto slope_across = [](const GridNode& one) { return is_along_x ? one.y : one.x; };
      const auto height = [&](int side) {
        const GridNode &from = node_at(cell, side), &to = node_at(cell + 1, side);
        return second(from.z, to.z, slope_along(from), slope_along(to));
      };
      const auto slope = [&](int side) {
        const GridNode &from = node_at(cell, side), &to = node_at(cell + 1, side);
        return second(slope_across(from), slope_across(to), from.xy, to.xy);
      };
      const Basis<double> b(beside);
      return height(0) + ((height(1) - height(0)) * b.h + (slope(0) * b.k0 - slope(1) * b.k1));
    };
    const bool is_on_first = at.part < slack && at.cell > 0, is_on_last = at.part > 1 - slack && at.cell < count;
    if (!is_on_first && !is_on_last) return in_cell(at.cell, at.part);
    const int behind = is_on_first ? at.cell : at.cell + 1, before = behind - 1;
    const auto counts = [&](double side) { return is_along_x ? has_data(side * 0.5 * spacing, 0.0) : has_data(0.0, side * 0.5 * spacing); };
    const bool has_behind = counts(1), has_before = counts(-1);
    if (has_behind != has_before) return has_behind ? in_cell(behind, 0) : in_cell(before, 1);
    return (in_cell(behind, 0) + in_cell(before, 1)) / 2;
  }

  // Of a hit, which is within the grid.
  SagRounding rounding(double x, double y) const {
    const double u = std::numeric_limits<double>::epsilon() / 2;
    const int cell_x = along_x(x).cell, cell_y = along_y(y).cell;
    const GridNode *low = node(cell_x, cell_y), *high = low + count_x + 2;
    const Departure<double> p = departure(x, y);
    const GridBends bends = cell_bends(cell_x, cell_y);
    double differences = std::abs(high[0].z - low[0].z) + std::abs(low[1].z - low[0].z) + std::abs(high[1].z - low[1].z), slopes = 0;
    for (const GridNode* one : {low, low + 1, high, high + 1}) slopes += std::abs(one->x) + std::abs(one->y) + std::abs(one->xy);
    const double off_x = 8 * u * std::abs(x - first_x), off_y = 8 * u * std::abs(y - first_y), of_slope = 24 * u * (3 * differences + 2 * slopes);
    const SagRounding of_base = base.rounding(x, y);
    return {of_base.height + 24 * u * (p.size + differences + slopes) + std::abs(p.dx) * off_x + std::abs(p.dy) * off_y + u * std::abs(p.value),
            of_base.slope + of_slope / spacing_x + of_slope / spacing_y + (bends.xx + bends.xy) * off_x + (bends.xy + bends.yy) * off_y};
  }
};

}  // namespace sagitta::surface
