// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "lib/output/marker_internal.h"

namespace sagitta::output {
namespace {

constexpr std::array<Rgb8, 7> colors{{{0, 114, 178}, {213, 94, 0}, {0, 158, 115}, {204, 121, 167}, {230, 159, 0}, {86, 180, 233}, {0, 0, 0}}};
constexpr std::size_t shape_count = 6;
constexpr double radius = 4.4;  // of a disc

// Of a regular polygon about the point; the first corner is at the top, and `turned` parts of an edge clockwise from there.
std::vector<Point> corners(Point at, int count, double size, double turned) {
  std::vector<Point> all;
  for (int k = 0; k < count; ++k) {
    const double angle = 6.283185307179586 * (k + turned) / count;
    all.push_back({at.x + size * std::sin(angle), at.y - size * std::cos(angle)});
  }
  return all;
}

}  // namespace

Marker::Marker(std::size_t series)
    : color_(colors[series % colors.size()]), shape_(static_cast<Shape>(series % shape_count)), is_filled_(series / shape_count % 2 == 0) {}

void Marker::draw(Canvas& canvas, Point at) const {
  // Where markers overlap, a white rim parts the filled ones.
  const Rgb8 inside = is_filled_ ? color_ : background, rim = is_filled_ ? background : color_;
  const double rim_width = is_filled_ ? 0.8 : 1.5;
  const auto polygon = [&](int count, double size, double turned) { canvas.polygon(corners(at, count, size, turned), inside, rim_width, rim); };
  switch (shape_) {  // sizes that look alike
    case Shape::disc: return canvas.disc(at, radius, inside, rim_width, rim);
    case Shape::square: return polygon(4, 1.25 * radius, 0.5);
    case Shape::triangle: return polygon(3, 1.35 * radius, 0);
    case Shape::diamond: return polygon(4, 1.35 * radius, 0);
    case Shape::triangle_down: return polygon(3, 1.35 * radius, 0.5);
    case Shape::cross: break;
  }
  const std::vector<Point> ends = corners(at, 4, 1.25 * radius, is_filled_ ? 0.5 : 0);
  for (const auto& [width, color] : {std::pair{3.8, background}, std::pair{2.0, color_}})
    for (const std::size_t k : {0U, 1U}) canvas.line(ends[k].x, ends[k].y, ends[k + 2].x, ends[k + 2].y, width, color);
}

}  // namespace sagitta::output
