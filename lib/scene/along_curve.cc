// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "lib/scene/delaunay.h"

namespace sagitta::scene {
namespace {

Rectangle box_of(const std::vector<numerics::Vec3<double>>& points) {
  Rectangle box;
  for (const auto& p : points) box.include(p.x, p.y);
  return box;
}

}  // namespace

std::vector<std::uint32_t> along_curve(const std::vector<numerics::Vec3<double>>& points) {
  const Rectangle box = box_of(points);
  return along_curve(points, box, box);
}

std::vector<std::uint32_t> along_curve(const std::vector<numerics::Vec3<double>>& points, const Rectangle& box, const Rectangle& within) {
  const auto spread = [](std::uint64_t v) {
    v = (v | (v << 16)) & 0x0000FFFF0000FFFF;
    v = (v | (v << 8)) & 0x00FF00FF00FF00FF;
    v = (v | (v << 4)) & 0x0F0F0F0F0F0F0F0F;
    v = (v | (v << 2)) & 0x3333333333333333;
    return (v | (v << 1)) & 0x5555555555555555;
  };
  // Finite for the least box too, so that nothing times 0 is NaN.
  const auto cells_per_mm = [](double low, double high) { return high > low ? std::min(0xFFFFFFFF / (high - low), 1e300) : 0; };
  const double columns_per_mm = cells_per_mm(box.low_x, box.high_x), rows_per_mm = cells_per_mm(box.low_y, box.high_y);
  const auto cell = [](double position) { return static_cast<std::uint32_t>(std::min(position, 4294967295.0)); };
  struct Key {
    std::uint64_t place;
    std::uint32_t point;
  };
  const auto is_within = [&](const numerics::Vec3<double>& p) { return within.contains(p.x, p.y); };
  std::vector<Key> keys;
  keys.reserve(static_cast<std::size_t>(std::count_if(points.begin(), points.end(), is_within)));
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    if (!is_within(points[i])) continue;
    const auto column = cell((points[i].x - box.low_x) * columns_per_mm), row = cell((points[i].y - box.low_y) * rows_per_mm);
    keys.push_back({spread(column) | spread(row) << 1, i});
  }
  std::sort(keys.begin(), keys.end(), [&](const Key& a, const Key& b) {
    if (a.place != b.place) return a.place < b.place;
    const auto &p = points[a.point], &q = points[b.point];
    return p.x != q.x ? p.x < q.x : p.y != q.y ? p.y < q.y : a.point < b.point;
  });
  std::vector<std::uint32_t> order(keys.size());
  std::transform(keys.begin(), keys.end(), order.begin(), [](const Key& key) { return key.point; });
  return order;
}

}  // namespace sagitta::scene
