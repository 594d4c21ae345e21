// SPDX-License-Identifier: Apache-2.0
// A block of lines and their crossings with one surface, as columns: for shapes that meet many rays faster together than
// one by one. Such a shape has, besides meet(),
//
//   void meet_block(const BlockOfLines& lines, BlockOfCrossings& crossings) const;
//
// with the same bits as meet() for every line that travels.
#pragma once

#include <cstdint>

namespace sagitta::surface {

inline constexpr int block_capacity = 256;

struct BlockOfLines {
  int count = 0;
  alignas(64) double x[block_capacity], y[block_capacity], z[block_capacity];  // points of the lines
  alignas(64) double l[block_capacity], m[block_capacity], n[block_capacity];  // unit directions
  alignas(64) bool travels[block_capacity];                                    // the others are not to be met
};

// Path and point as in Crossing; the normal is (-slope_x, -slope_y, 1). Only where the status is ok.
struct BlockOfCrossings {
  alignas(64) double path[block_capacity], x[block_capacity], y[block_capacity], z[block_capacity];
  alignas(64) double slope_x[block_capacity], slope_y[block_capacity];
  alignas(64) std::int32_t status[block_capacity];
};

}  // namespace sagitta::surface
