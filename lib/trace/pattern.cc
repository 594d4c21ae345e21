// SPDX-License-Identifier: Apache-2.0
#include "lib/trace/pattern.h"

#include <charconv>
#include <cmath>
#include <numbers>
#include <random>

namespace sagitta::trace {
namespace {

std::vector<PupilPoint> hexapolar(std::int64_t at_least) {
  std::int64_t rings = 0;
  while (1 + 3 * rings * (rings + 1) < at_least) ++rings;
  const double count = static_cast<double>(1 + 3 * rings * (rings + 1));
  std::vector<PupilPoint> points{{0, 0}};
  points.reserve(static_cast<std::size_t>(count));
  for (std::int64_t ring = 1; ring <= rings; ++ring) {
    const double radius = std::sqrt((1 + 3 * static_cast<double>(ring * ring)) / count);
    for (std::int64_t i = 0; i < 6 * ring; ++i) {
      const double angle = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(6 * ring);
      points.push_back({radius * std::cos(angle), radius * std::sin(angle)});
    }
  }
  return points;
}

std::vector<PupilPoint> square_of(std::int64_t side) {
  std::vector<PupilPoint> points;
  for (std::int64_t j = 0; j < side; ++j)
    for (std::int64_t i = 0; i < side; ++i) {
      // odd integers over the side: symmetric to the last bit
      const double x = static_cast<double>(2 * i + 1 - side) / static_cast<double>(side);
      const double y = static_cast<double>(2 * j + 1 - side) / static_cast<double>(side);
      if (x * x + y * y <= 1) points.push_back({x, y});
    }
  return points;
}

std::vector<PupilPoint> square(std::int64_t at_least) {
  auto side = static_cast<std::int64_t>(std::sqrt(static_cast<double>(at_least) * 4 / std::numbers::pi)) - 2;
  std::vector<PupilPoint> points;
  do points = square_of(side = std::max<std::int64_t>(1, side + 1));
  while (static_cast<std::int64_t>(points.size()) < at_least);
  return points;
}

std::vector<PupilPoint> random(std::int64_t count, std::uint64_t seed) {
  // The generator's bits are the standard's; std::uniform_real_distribution's are not.
  std::mt19937_64 generator(seed);
  const auto uniform = [&] { return static_cast<double>(generator() >> 11) * 0x1p-53; };
  std::vector<PupilPoint> points;
  points.reserve(static_cast<std::size_t>(count));
  while (static_cast<std::int64_t>(points.size()) < count) {
    const double x = 2 * uniform() - 1, y = 2 * uniform() - 1;
    if (x * x + y * y <= 1) points.push_back({x, y});
  }
  return points;
}

std::vector<PupilPoint> fan(std::int64_t count, double along_x, double along_y) {
  if (count == 1) return {{0, 0}};
  std::vector<PupilPoint> points;
  for (std::int64_t i = 0; i < count; ++i) {
    const double s = static_cast<double>(2 * i - (count - 1)) / static_cast<double>(count - 1);
    points.push_back({s * along_x, s * along_y});
  }
  return points;
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

std::vector<PupilPoint> pupil_points(const Pattern& pattern, std::int64_t at_least) {
  switch (pattern.kind) {
    case PatternKind::hexapolar: return hexapolar(at_least);
    case PatternKind::square: return square(at_least);
    case PatternKind::random: return random(at_least, pattern.seed);
    case PatternKind::fan_x: return fan(at_least, 1, 0);
    case PatternKind::fan_y: return fan(at_least, 0, 1);
  }
  return {};
}

}  // namespace sagitta::trace
