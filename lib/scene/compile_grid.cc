// SPDX-License-Identifier: Apache-2.0
#include "lib/scene/compile_grid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <tuple>
#include <utility>
#include <vector>

namespace sagitta::scene {
namespace {

using prescription::SagGrid;
using surface::BicubicGrid;
using surface::GridNode;

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
constexpr int most_in_difference = 5;

// The derivative at place k of the polynomial through `count` equidistant values, in spacings: what each of them, less the one at k, is multiplied with.
struct DifferenceWeights {
  double of[most_in_difference + 1][most_in_difference][most_in_difference];  // [count][k][j]

  DifferenceWeights() {
    for (int count = 2; count <= most_in_difference; ++count)
      for (int k = 0; k < count; ++k)
        for (int j = 0; j < count; ++j) {
          double above = 1, below = 1;
          for (int i = 0; i < count; ++i) {
            if (i != j && i != k) above *= k - i;
            if (i != j) below *= j - i;
          }
          of[count][k][j] = j == k ? 0 : above / below;
        }
  }
};

// Along one line of values, `stride` apart; NaN where a value has no neighbour.
void differences_along(const double* values, double* slopes, std::ptrdiff_t stride, int count) {
  static const DifferenceWeights weights;
  const auto is_known = [&](int i) { return !std::isnan(values[i * stride]); };
  for (int begin = 0; begin < count;) {
    int end = begin;
    while (end < count && is_known(end)) ++end;
    const int used = std::min(end - begin, most_in_difference);
    for (int i = begin; i < end; ++i) {
      const int first = std::clamp(i - most_in_difference / 2, begin, end - used);
      double sum = 0;
      for (int j = 0; j < used && used > 1; ++j) sum += weights.of[used][i - first][j] * (values[(first + j) * stride] - values[i * stride]);
      slopes[i * stride] = used > 1 ? sum : unknown;
    }
    if (end == begin) slopes[end * stride] = unknown, ++end;
    begin = end;
  }
}

class GridMaker {
 public:
  explicit GridMaker(const SagGrid& given)
      : count_x_(given.count_x), count_y_(given.count_y), row_(static_cast<std::size_t>(given.count_x) + 2),
        nodes_(row_ * (static_cast<std::size_t>(given.count_y) + 2), GridNode{unknown, 0, 0, 0}) {
    take(given);
    mark_holes();
    fill();
    surround();
  }

  BicubicGrid into(const SagGrid& given, const surface::Conic& base, numerics::Arena& arena) && {
    BicubicGrid result;
    result.base = surface::Quadric::of(base, base);
    result.count_x = count_x_, result.count_y = count_y_;
    result.first_x = given.first_x, result.first_y = given.first_y, result.spacing_x = given.spacing_x, result.spacing_y = given.spacing_y;
    result.has_given_slopes = given.has_given_slopes;
    result.nodes = arena.keep(std::move(nodes_));
    result.is_hole = has_holes_ ? arena.keep(std::move(is_hole_)) : nullptr;
    for (int j = 0; j <= count_y_; ++j)
      for (int i = 0; i <= count_x_; ++i) result.steepest_bends.include(result.cell_bends(i, j));
    return result;
  }

 private:
  // Numbers of nodes and cells, the row around the grid included.
  std::size_t at(int i, int j) const { return static_cast<std::size_t>(j) * row_ + static_cast<std::size_t>(i); }
  bool is_known(std::size_t node) const { return !std::isnan(nodes_[node].z); }

  // Heights, with the slopes of the file or by differences; unknown where one of them is.
  void take(const SagGrid& given) {
    const std::size_t count = given.nodes.size();
    std::vector<double> z(count), x(count), y(count), xy(count);
    for (std::size_t k = 0; k < count; ++k) {
      const SagGrid::Node& node = given.nodes[k];
      z[k] = node.z, x[k] = node.dz_dx * given.spacing_x, y[k] = node.dz_dy * given.spacing_y, xy[k] = node.d2z_dxdy * given.spacing_x * given.spacing_y;
    }
    if (!given.has_given_slopes) {
      const std::ptrdiff_t row = count_x_;
      for (int j = 0; j < count_y_; ++j) differences_along(z.data() + j * row, x.data() + j * row, 1, count_x_);
      for (int i = 0; i < count_x_; ++i) differences_along(z.data() + i, y.data() + i, row, count_y_);
      for (int i = 0; i < count_x_; ++i) differences_along(x.data() + i, xy.data() + i, row, count_y_);
    }
    for (int j = 0; j < count_y_; ++j)
      for (int i = 0; i < count_x_; ++i) {
        const auto k = static_cast<std::size_t>(j) * static_cast<std::size_t>(count_x_) + static_cast<std::size_t>(i);
        if (!std::isnan(z[k] + x[k] + y[k] + xy[k])) nodes_[at(i + 1, j + 1)] = {z[k], x[k], y[k], xy[k]};
      }
  }

  void mark_holes() {
    is_hole_.assign(static_cast<std::size_t>(count_x_ + 1) * static_cast<std::size_t>(count_y_ + 1), 0);
    for (int j = 1; j < count_y_; ++j)
      for (int i = 1; i < count_x_; ++i) {
        const bool is_whole = is_known(at(i, j)) && is_known(at(i + 1, j)) && is_known(at(i, j + 1)) && is_known(at(i + 1, j + 1));
        is_hole_[static_cast<std::size_t>(j) * static_cast<std::size_t>(count_x_ + 1) + static_cast<std::size_t>(i)] = !is_whole;
        has_holes_ = has_holes_ || !is_whole;
      }
  }

  // From the known nodes on, ring by ring; what a ring gives does not depend on the order within it.
  void fill() {
    std::vector<std::pair<int, int>> ring, next;
    std::vector<char> is_waiting(nodes_.size(), 0);
    const auto for_each_neighbour = [&](int i, int j, const auto& visit) {
      for (int dj = -1; dj <= 1; ++dj)
        for (int di = -1; di <= 1; ++di)
          if ((di != 0 || dj != 0) && i + di >= 1 && i + di <= count_x_ && j + dj >= 1 && j + dj <= count_y_) visit(i + di, j + dj);
    };
    const auto ask_around = [&](int i, int j) {
      for_each_neighbour(i, j, [&](int a, int b) {
        if (is_known(at(a, b)) || is_waiting[at(a, b)]) return;
        is_waiting[at(a, b)] = 1;
        next.emplace_back(a, b);
      });
    };
    for (int j = 1; j <= count_y_ && has_holes_; ++j)
      for (int i = 1; i <= count_x_; ++i)
        if (is_known(at(i, j))) ask_around(i, j);
    std::vector<GridNode> found;
    while (!next.empty()) {
      ring.swap(next), next.clear(), found.clear();
      for (const auto& [i, j] : ring) {
        GridNode sum{0, 0, 0, 0};
        double known = 0;
        for_each_neighbour(i, j, [&, i = i, j = j](int a, int b) {
          const GridNode& from = nodes_[at(a, b)];
          if (std::isnan(from.z)) return;
          sum = {sum.z + (from.z + (i - a) * from.x + (j - b) * from.y), sum.x + from.x, sum.y + from.y, 0}, ++known;
        });
        found.push_back({sum.z / known, sum.x / known, sum.y / known, 0});
      }
      for (std::size_t k = 0; k < ring.size(); ++k) nodes_[at(ring[k].first, ring[k].second)] = found[k];
      for (const auto& [i, j] : ring) ask_around(i, j);
    }
  }

  // The row around the grid, as far away as the grid is wide: where a slope that falls evenly to 0 leads to.
  void surround() {
    const double half_x = (count_x_ - 1) / 2.0, half_y = (count_y_ - 1) / 2.0;
    for (int j = 1; j <= count_y_; ++j)
      for (const auto& [to, from, way] : {std::tuple{0, 1, -half_x}, std::tuple{count_x_ + 1, count_x_, half_x}}) {
        const GridNode& rim = nodes_[at(from, j)];
        nodes_[at(to, j)] = {rim.z + way * rim.x, 0, rim.y + way * rim.xy, 0};
      }
    for (int i = 0; i <= count_x_ + 1; ++i)
      for (const auto& [to, from, way] : {std::tuple{0, 1, -half_y}, std::tuple{count_y_ + 1, count_y_, half_y}}) {
        const GridNode& rim = nodes_[at(i, from)];
        nodes_[at(i, to)] = {rim.z + way * rim.y, rim.x + way * rim.xy, 0, 0};
      }
  }

  int count_x_, count_y_;
  std::size_t row_;
  std::vector<GridNode> nodes_;
  std::vector<char> is_hole_;  // of cells
  bool has_holes_ = false;
};

}  // namespace

BicubicGrid grid_surface(const SagGrid& given, const surface::Conic& base, numerics::Arena& arena) { return GridMaker(given).into(given, base, arena); }

BicubicGrid compile_grid(const prescription::Shape& given, numerics::Arena& arena) {
  return grid_surface(*given.grid, {1 / given.parameters.number("radius_mm"), given.parameters.number("conic_constant")}, arena);
}

}  // namespace sagitta::scene
