// SPDX-License-Identifier: Apache-2.0
// A block of lines and their crossings with one surface, as columns: for shapes that meet many rays faster together than
// one by one. Such a shape has, besides meet(),
//
//   void meet_block(const BlockOfLines& lines, BlockOfCrossings& crossings) const;
//
// with the same bits as meet() for every line that travels. It may be a template of the number of doubles that the
// processor's vectors hold (a shape that is written in vectors); the others become vectors by the compiler.
#pragma once

#include <cstdint>

#include "lib/surface/crossing.h"

namespace sagitta::surface {

inline constexpr int block_capacity = 256;

struct BlockOfLines {
  int count = 0;
  alignas(64) double x[block_capacity], y[block_capacity], z[block_capacity];  // points of the lines
  alignas(64) double l[block_capacity], m[block_capacity], n[block_capacity];  // unit directions
  alignas(64) bool travels[block_capacity];                                    // the others are not to be met
};

// Path and point as in Crossing, only where the status is ok; the normal is (-slope_x, -slope_y, 1), that of a crossing that is
// put here too.
struct BlockOfCrossings {
  alignas(64) double path[block_capacity], x[block_capacity], y[block_capacity], z[block_capacity];
  alignas(64) double slope_x[block_capacity], slope_y[block_capacity];
  alignas(64) std::int32_t status[block_capacity];

  void put(int i, const Crossing<double>& crossing) {
    path[i] = crossing.path;
    x[i] = crossing.point.x, y[i] = crossing.point.y, z[i] = crossing.point.z;
    slope_x[i] = -crossing.normal.x, slope_y[i] = -crossing.normal.y;
    status[i] = static_cast<std::int32_t>(crossing.status);
  }
};

}  // namespace sagitta::surface
