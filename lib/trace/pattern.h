// SPDX-License-Identifier: Apache-2.0
// Patterns of points over the unit disc of the pupil.
//
//   hexapolar     the centre and rings of 6, 12, 18, ... points; ring i has the radius sqrt((1 + 3 i^2)/count), so that
//                 every point stands for the same area. From the outermost ring inwards, every 16th, then those that are left,
//                 the centre last: so the first rays reach about as far as all will, and what lies inside needs no further look
//   square        the points of a square grid, centred on cells, that lie in the disc
//   random:SEED   uniform over the disc; the same points for the same seed on every machine
//   fan_x, fan_y  evenly from -1 to 1 along x or y, rim included
//
// Hexapolar and square take the smallest pattern of at least the asked number of points, so the number differs.
#pragma once

#include <cstdint>
#include <optional>
#include <random>
#include <string_view>
#include <vector>

#include "lib/trace/launch.h"

namespace sagitta::trace {

enum class PatternKind { hexapolar, square, random, fan_x, fan_y };

struct Pattern {
  PatternKind kind = PatternKind::hexapolar;
  std::uint64_t seed = 0;
};

// "hexapolar", "square", "random:7", "fan_x", "fan_y"; none for anything else.
std::optional<Pattern> parse_pattern(std::string_view text);

// The points of a pattern, in order and in portions, so that any number of them takes little memory.
class PupilStream {
 public:
  PupilStream(const Pattern& pattern, std::int64_t at_least);  // at_least >= 1

  std::int64_t size() const { return size_; }
  // The next points, `most` of them or the rest; none at the end.
  std::vector<PupilPoint> next(std::int64_t most);

 private:
  PupilPoint point();

  Pattern pattern_;
  std::int64_t size_ = 0, given_ = 0;
  std::int64_t ring_ = 0, place_ = 0;  // hexapolar: the ring and the place on it; square: the row and the column
  std::int64_t rings_ = 0, first_ring_ = 0;  // hexapolar: how many, and where the present sweep began
  std::int64_t side_ = 0;              // square: points a side
  std::mt19937_64 generator_;
};

// All of them at once.
std::vector<PupilPoint> pupil_points(const Pattern& pattern, std::int64_t at_least);

}  // namespace sagitta::trace
