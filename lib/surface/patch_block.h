// SPDX-License-Identifier: Apache-2.0
// Where the lines of a block meet Clough-Tocher patches: on the third of the patch over their flat hit, for many lines at
// once. That settles nearly all; the others are left to be met one by one.
#pragma once

#include <cstring>

#include "lib/surface/clough_tocher.h"
#include "lib/surface/facet_block.h"

namespace sagitta::surface {

// Patches as columns of their numbers.
struct PatchColumns {
  static constexpr int capacity = 32;
  static constexpr std::size_t number_count = sizeof(CloughTocherPatch) / sizeof(double);
  alignas(64) double numbers[number_count][capacity];

  // Four patches, at i to i + 3, four numbers of each at a time, which a processor's vectors turn into four columns.
  [[gnu::always_inline]] void put(int i, const CloughTocherPatch* const (&patches)[4]) {
    using Four [[gnu::vector_size(32)]] = double;
    for (std::size_t k = 0; k < number_count; k += 4) {
      alignas(32) Four of[4];
      for (int j = 0; j < 4; ++j) std::memcpy(&of[j], reinterpret_cast<const char*>(patches[j]) + k * sizeof(double), sizeof of[j]);
      const Four low_01 = __builtin_shufflevector(of[0], of[1], 0, 4, 2, 6), high_01 = __builtin_shufflevector(of[0], of[1], 1, 5, 3, 7);
      const Four low_23 = __builtin_shufflevector(of[2], of[3], 0, 4, 2, 6), high_23 = __builtin_shufflevector(of[2], of[3], 1, 5, 3, 7);
      alignas(32) const Four columns[4]{__builtin_shufflevector(low_01, low_23, 0, 1, 4, 5), __builtin_shufflevector(high_01, high_23, 0, 1, 4, 5),
                            __builtin_shufflevector(low_01, low_23, 2, 3, 6, 7), __builtin_shufflevector(high_01, high_23, 2, 3, 6, 7)};
      for (std::size_t j = 0; j < 4; ++j) std::memcpy(&numbers[k + j][i], &columns[j], sizeof columns[j]);
    }
  }
  [[gnu::always_inline]] CloughTocherPatch at(int i) const {
    const auto& n = numbers;
    return {n[0][i], n[1][i], n[2][i],  n[3][i],  n[4][i],  n[5][i],  n[6][i],  n[7][i],
            n[8][i], n[9][i], n[10][i], n[11][i], n[12][i], n[13][i], n[14][i], n[15][i]};
  }
};

// `crossings` holds the hits on the facets, and on return those on the patches; settled[i] tells for which lines.
[[gnu::always_inline]] inline void meet_patches(const CloughTocherPatch* patches, const BlockOfLines& lines, const FacetsOfBlock& flat,
                                                BlockOfCrossings& crossings, bool (&settled)[block_capacity]) {
  // A few at a time stay in the fastest memory, while the next ones are on their way to it.
  constexpr int portion = PatchColumns::capacity;
  PatchColumns columns;
  alignas(64) std::int64_t is_sound[portion];  // as wide as all that stands beside it in the loop
  const int count = lines.count;
  const auto patch_of = [&](int i) __attribute__((always_inline)) { return patches + (i >= count || flat.facet[i] == no_facet ? 0 : flat.facet[i]); };
  const auto ask_for = [&](int begin) {
    for (int i = begin; i < begin + portion; ++i) {
      const char* const patch = reinterpret_cast<const char*>(patch_of(i));
      __builtin_prefetch(patch);
      __builtin_prefetch(patch + 64);
    }
  };
  ask_for(0);
  for (int begin = 0; begin < count; begin += portion) {
    const int size = count - begin < portion ? count - begin : portion;
    ask_for(begin + portion);
    for (int k = 0; k < size; k += 4) columns.put(k, {patch_of(begin + k), patch_of(begin + k + 1), patch_of(begin + k + 2), patch_of(begin + k + 3)});
#pragma GCC ivdep
    for (int k = 0; k < size; ++k) {
      const int i = begin + k;
      const Vec3<double> d{lines.l[i], lines.m[i], lines.n[i]};
      const auto at = columns.at(k).arrive(crossings.x[i], crossings.y[i], d, crossings.slope_x[i], crossings.slope_y[i]);
      const double t = at.is_sound ? at.t : 0;
      crossings.path[i] = crossings.path[i] + t;
      crossings.x[i] = crossings.x[i] + t * d.x;
      crossings.y[i] = crossings.y[i] + t * d.y;
      crossings.z[i] = crossings.z[i] + t * d.z;
      crossings.slope_x[i] = at.is_sound ? at.dz_dx : crossings.slope_x[i];
      crossings.slope_y[i] = at.is_sound ? at.dz_dy : crossings.slope_y[i];
      is_sound[k] = at.is_sound;
    }
    for (int k = 0; k < size; ++k) settled[begin + k] = is_sound[k];
  }
}

}  // namespace sagitta::surface
