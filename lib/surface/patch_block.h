// SPDX-License-Identifier: Apache-2.0
// Where the lines of a block meet Clough-Tocher patches: the first steps of departure.h's iteration for all lines at once,
// while each stays on the patch of its flat hit, in the same third of it. That settles nearly all; the others are left to
// be met one by one.
//
// The results have the same bits as meet_from(): the same arithmetic in the same order, or none at all.
#pragma once

#include "lib/surface/clough_tocher.h"
#include "lib/surface/departure.h"
#include "lib/surface/facet_block.h"

namespace sagitta::surface {

// Places this far outside a patch count as inside: the same on both sides of an edge, and far above rounding.
inline constexpr double patch_slack = 1e-12;

// `crossings` holds the hits on the facets, and on return those on the patches; settled[i] tells for which lines.
[[gnu::always_inline]] inline void meet_patches(const CloughTocherPatch* patches, const BlockOfLines& lines, const FacetsOfBlock& flat,
                                                BlockOfCrossings& crossings, bool (&settled)[block_capacity]) {
  const int count = lines.count;
  const auto patch_of = [&](int i) -> const CloughTocherPatch& { return patches[flat.facet[i] == no_facet ? 0 : flat.facet[i]]; };
  constexpr int ahead = 16;  // lines, while whose patches are on their way from memory
  const auto ask_for = [&](int i) {
    const char* const patch = reinterpret_cast<const char*>(&patch_of(i));
    for (std::size_t byte = 0; byte < sizeof(CloughTocherPatch); byte += 64) __builtin_prefetch(patch + byte);
    __builtin_prefetch(patch + sizeof(CloughTocherPatch) - 1);  // a patch may begin anywhere in its first line
  };
  for (int i = 0; i < ahead && i < count; ++i) ask_for(i);

  // The patches as columns: their frames, then, when it is known which, the coefficients of the thirds.
  struct Frames {
    alignas(64) double x[block_capacity], y[block_capacity], m1_x[block_capacity], m1_y[block_capacity], m2_x[block_capacity], m2_y[block_capacity];
  } frame;
  for (int i = 0; i < count; ++i) {
    if (i + ahead < count) ask_for(i + ahead);
    const CloughTocherPatch& patch = patch_of(i);
    frame.x[i] = patch.x, frame.y[i] = patch.y;
    frame.m1_x[i] = patch.m1_x, frame.m1_y[i] = patch.m1_y, frame.m2_x[i] = patch.m2_x, frame.m2_y[i] = patch.m2_y;
  }
  const auto place_at = [&](int i, double x, double y) __attribute__((always_inline)) {
    return CloughTocherPatch::locate(x, y, frame.x[i], frame.y[i], frame.m1_x[i], frame.m1_y[i], frame.m2_x[i], frame.m2_y[i]);
  };
  alignas(64) std::int32_t third[block_capacity];
#pragma GCC ivdep
  for (int i = 0; i < count; ++i) third[i] = CloughTocherPatch::third_at(place_at(i, crossings.x[i], crossings.y[i]));
  struct Thirds {
    alignas(64) double b300[block_capacity], b030[block_capacity], b003[block_capacity], b210[block_capacity], b120[block_capacity],
        b201[block_capacity], b021[block_capacity], b111[block_capacity], b102[block_capacity], b012[block_capacity];
  } b;
  for (int i = 0; i < count; ++i) {
    const auto of = patch_of(i).third<double>(third[i]);
    b.b300[i] = of.b300, b.b030[i] = of.b030, b.b003[i] = of.b003, b.b210[i] = of.b210, b.b120[i] = of.b120;
    b.b201[i] = of.b201, b.b021[i] = of.b021, b.b111[i] = of.b111, b.b102[i] = of.b102, b.b012[i] = of.b012;
  }

  // departure.h, from the flat hit on, written in select form. A line is `done` with its result, `going`, or given up.
  alignas(64) double t[block_capacity], f[block_capacity], step[block_capacity];
  alignas(64) std::int32_t state[block_capacity];
  constexpr std::int32_t going = 0, done = 1, given_up = 2;
  constexpr double eps = std::numeric_limits<double>::epsilon();
  for (int i = 0; i < count; ++i) state[i] = going, t[i] = f[i] = step[i] = 0;
  constexpr int looks = 3;
  for (int look = 0; look < looks; ++look) {
    const bool first = look == 0;
#pragma GCC ivdep
    for (int i = 0; i < count; ++i) {
      const std::int32_t before = state[i];
      const double old_t = t[i], old_f = f[i], next = old_t + step[i];
      const double ox = crossings.x[i], oy = crossings.y[i], oz = crossings.z[i];
      const double dx = lines.l[i], dy = lines.m[i], dz = lines.n[i];
      const double x = ox + next * dx, y = oy + next * dy;
      const auto place = place_at(i, x, y);
      const CloughTocherPatch::Third<double> third_i{b.b300[i], b.b030[i], b.b003[i], b.b210[i], b.b120[i],
                                                     b.b201[i], b.b021[i], b.b111[i], b.b102[i], b.b012[i]};
      const auto sheet = CloughTocherPatch::evaluate(third_i, third[i], place, frame.m1_x[i], frame.m1_y[i], frame.m2_x[i], frame.m2_y[i]);
      const double new_f = oz + next * dz - sheet.z;
      const double slope = dz - dx * sheet.dz_dx - dy * sheet.dz_dy;
      const double rounding = eps * (std::abs(oz + next * dz) + std::abs(sheet.z));
      const double new_step = -new_f / slope;
      const double scale = std::abs(ox) + std::abs(oy) + std::abs(oz) + std::abs(next);
      const bool is_last = (std::abs(new_step) * (std::abs(dx) + std::abs(dy)) <= 4 * eps * scale) & (std::abs(new_step) <= scale);
      const bool at_rounding = std::abs(new_f) <= rounding;
      const double forward_slope = dz > 0 ? slope : -slope;
      const double last = at_rounding ? next : next + new_step;
      const auto end = place_at(i, ox + last * dx, oy + last * dy);
      const auto is_here = [](const CloughTocherPatch::Place<double>& at) {
        return (at.m[0] >= -patch_slack) & (at.m[1] >= -patch_slack) & (at.m[2] >= -patch_slack);
      };
      const bool falls = first | (std::abs(new_f) < std::abs(old_f));
      const double after = next + new_step;
      const bool in_bracket = first | (new_f * old_f > 0) | ((after - old_t) * (after - next) < 0);
      const bool here = is_here(place) & (CloughTocherPatch::third_at(place) == third[i]);
      const bool sound = here & falls & (slope - slope == 0) & (before == going);
      const bool ends = at_rounding | is_last;
      const bool arrives = sound & ends & (forward_slope > 0) & is_here(end);
      const bool goes_on = sound & !ends & in_bracket;
      state[i] = before != going ? before : arrives ? done : goes_on ? going : given_up;
      t[i] = arrives ? last : before == done ? old_t : next;
      f[i] = new_f;
      step[i] = new_step;
      crossings.slope_x[i] = before == done ? crossings.slope_x[i] : sheet.dz_dx;
      crossings.slope_y[i] = before == done ? crossings.slope_y[i] : sheet.dz_dy;
    }
    int still_going = 0;
    for (int i = 0; i < count; ++i) still_going += state[i] == going;
    if (still_going == 0) break;
  }
#pragma GCC ivdep
  for (int i = 0; i < count; ++i) {
    const bool is_done = (state[i] == done) & (crossings.status[i] == static_cast<std::int32_t>(Status::ok));
    const double last = is_done ? t[i] : 0;
    crossings.path[i] = is_done ? crossings.path[i] + last : crossings.path[i];
    crossings.x[i] = is_done ? crossings.x[i] + last * lines.l[i] : crossings.x[i];
    crossings.y[i] = is_done ? crossings.y[i] + last * lines.m[i] : crossings.y[i];
    crossings.z[i] = is_done ? crossings.z[i] + last * lines.n[i] : crossings.z[i];
  }
  for (int i = 0; i < count; ++i) settled[i] = state[i] == done;
}

}  // namespace sagitta::surface
