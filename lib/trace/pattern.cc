// SPDX-License-Identifier: Apache-2.0
#include "lib/trace/pattern.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>

namespace sagitta::trace {
namespace {

constexpr std::int64_t ring_stride = 16;

std::int64_t hexapolar_size(std::int64_t rings) { return 1 + 3 * rings * (rings + 1); }

std::int64_t hexapolar_rings(std::int64_t at_least) {
  std::int64_t rings = 0;
  while (hexapolar_size(rings) < at_least) ++rings;
  return rings;
}

// Odd integers over the side: symmetric to the last bit.
double square_coordinate(std::int64_t i, std::int64_t side) {
  return static_cast<double>(2 * i + 1 - side) / static_cast<double>(side);
}

bool in_disc(PupilPoint p) { return p.x * p.x + p.y * p.y <= 1; }

std::int64_t square_size(std::int64_t side) {
  std::int64_t count = 0;
  for (std::int64_t row = 0; row < side; ++row) {
    const double y = square_coordinate(row, side);
    // the first column inside the disc, from the closed form and then by the test that the stream itself makes
    auto column = static_cast<std::int64_t>((1 - std::sqrt(1 - y * y)) * static_cast<double>(side) / 2);
    column = std::max<std::int64_t>(0, column - 2);
    while (column < side - column && !in_disc({square_coordinate(column, side), y})) ++column;
    count += std::max<std::int64_t>(0, side - 2 * column);
  }
  return count;
}

std::int64_t square_side(std::int64_t at_least) {
  auto side = std::max<std::int64_t>(1, static_cast<std::int64_t>(std::sqrt(static_cast<double>(at_least) * 4 / std::numbers::pi)) - 2);
  while (square_size(side) < at_least) ++side;
  return side;
}

}  // namespace

std::optional<Pattern> parse_pattern(std::string_view text) {
  constexpr std::string_view random_prefix = "random:";
  if (text == "hexapolar") return Pattern{PatternKind::hexapolar};
  if (text == "square") return Pattern{PatternKind::square};
  if (text == "fan_x") return Pattern{PatternKind::fan_x};
  if (text == "fan_y") return Pattern{PatternKind::fan_y};
  if (text.starts_with(random_prefix)) {
    text.remove_prefix(random_prefix.size());
    Pattern result{PatternKind::random};
    const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), result.seed);
    if (fault == std::errc{} && end == text.data() + text.size()) return result;
  }
  return std::nullopt;
}

PupilStream::PupilStream(const Pattern& pattern, std::int64_t at_least)
    : pattern_(pattern), size_(at_least), generator_(pattern.seed) {
  if (pattern.kind == PatternKind::hexapolar) size_ = hexapolar_size(ring_ = first_ring_ = rings_ = hexapolar_rings(at_least));
  if (pattern.kind == PatternKind::square) size_ = square_size(side_ = square_side(at_least));
}

PupilPoint PupilStream::point() {
  switch (pattern_.kind) {
    case PatternKind::hexapolar: {
      if (ring_ > 0 && place_ == 6 * ring_) {
        place_ = 0;
        ring_ -= ring_stride;
        if (ring_ < 1) ring_ = --first_ring_ > rings_ - ring_stride ? first_ring_ : 0;
      }
      if (ring_ == 0) return {0, 0};
      const double radius = std::sqrt((1 + 3 * static_cast<double>(ring_ * ring_)) / static_cast<double>(size_));
      const double angle = 2 * std::numbers::pi * static_cast<double>(place_++) / static_cast<double>(6 * ring_);
      return {radius * std::cos(angle), radius * std::sin(angle)};
    }
    case PatternKind::square:
      for (;; ++place_) {
        if (place_ == side_) ++ring_, place_ = 0;
        const PupilPoint p{square_coordinate(place_, side_), square_coordinate(ring_, side_)};
        if (!in_disc(p)) continue;
        ++place_;
        return p;
      }
    case PatternKind::random: {
      // The generator's bits are the standard's; std::uniform_real_distribution's are not.
      const auto uniform = [&] { return static_cast<double>(generator_() >> 11) * 0x1p-53; };
      for (;;) {
        const double x = 2 * uniform() - 1, y = 2 * uniform() - 1;
        if (in_disc({x, y})) return {x, y};
      }
    }
    case PatternKind::fan_x:
    case PatternKind::fan_y: {
      const double s = size_ == 1 ? 0 : static_cast<double>(2 * given_ - (size_ - 1)) / static_cast<double>(size_ - 1);
      return pattern_.kind == PatternKind::fan_x ? PupilPoint{s, 0} : PupilPoint{0, s};
    }
  }
  return {};
}

std::vector<PupilPoint> PupilStream::next(std::int64_t most) {
  const std::int64_t count = std::min(most, size_ - given_);
  std::vector<PupilPoint> points;
  points.reserve(static_cast<std::size_t>(count));
  for (std::int64_t i = 0; i < count; ++i, ++given_) points.push_back(point());
  return points;
}

std::vector<PupilPoint> pupil_points(const Pattern& pattern, std::int64_t at_least) {
  PupilStream stream(pattern, at_least);
  return stream.next(stream.size());
}

}  // namespace sagitta::trace
