// SPDX-License-Identifier: Apache-2.0
// Which facets the lines of a block meet: the steps of facet_location.h, each for all lines before the next one, so that
// the memory that a step needs was asked for by the step before.
//
//   aim all lines                                     ask for their cells of the grid
//   take the cells' facets                            ask for the facets
//   judge all lines; those not inside go on a facet   ask for these; again, until none is left
#pragma once

#include "lib/surface/block.h"
#include "lib/surface/facet_location.h"

namespace sagitta::surface {

struct FacetsOfBlock {
  struct {
    alignas(64) double x[block_capacity], y[block_capacity], z[block_capacity], path[block_capacity];
  } o;  // AimedLine
  alignas(64) std::uint32_t facet[block_capacity];  // no_facet: none is met
  alignas(64) double path[block_capacity];          // from o
  alignas(64) double slope_x[block_capacity], slope_y[block_capacity];
};

[[gnu::always_inline]] inline AimedLine<double> line_of(const BlockOfLines& lines, const FacetsOfBlock& found, int i) {
  return {{found.o.x[i], found.o.y[i], found.o.z[i]}, {lines.l[i], lines.m[i], lines.n[i]}, found.o.path[i]};
}

[[gnu::always_inline]] inline void locate_block(const Mesh& mesh, const BlockOfLines& lines, FacetsOfBlock& found) {
  const int count = lines.count;
  alignas(64) std::int32_t cell[block_capacity];
  {
    const Mesh copy = mesh;  // read once, not again after every store
#pragma GCC ivdep
    for (int i = 0; i < count; ++i) {
      const Vec3<double> start{lines.x[i], lines.y[i], lines.z[i]}, d{lines.l[i], lines.m[i], lines.n[i]};
      const AimedLine<double> line = aim(copy, start, d);
      found.o.x[i] = line.o.x;
      found.o.y[i] = line.o.y;
      found.o.z[i] = line.o.z;
      found.o.path[i] = line.path;
    }
#pragma GCC ivdep
    for (int i = 0; i < count; ++i) cell[i] = copy.grid.cell(found.o.x[i], found.o.y[i]);
  }
  const Facet* const facets = mesh.facets;
  const std::uint32_t* const grid = mesh.grid.facets;
  for (int i = 0; i < count; ++i) __builtin_prefetch(grid + (cell[i] < 0 ? 0 : cell[i]));
  // Lines without a start look at facet 0, and forget what they see.
  alignas(64) std::uint32_t start[block_capacity];
  alignas(64) bool has_start[block_capacity];
  for (int i = 0; i < count; ++i) {
    const std::uint32_t facet = grid[cell[i] < 0 ? 0 : cell[i]];
    has_start[i] = (cell[i] >= 0) & (facet != no_facet) & lines.travels[i];
    start[i] = has_start[i] ? facet : 0;
    __builtin_prefetch(facets + start[i]);
  }

  // The first facets, as columns: one whole line of memory after the other is read, and none is waited for.
  alignas(64) double z[block_capacity], least[block_capacity];
  alignas(64) float x[block_capacity], y[block_capacity], u_x[block_capacity], u_y[block_capacity], v_x[block_capacity], v_y[block_capacity],
      guard[block_capacity];
  for (int i = 0; i < count; ++i) {
    const Facet& facet = facets[start[i]];
    z[i] = facet.z, found.slope_x[i] = facet.slope_x, found.slope_y[i] = facet.slope_y;
    x[i] = facet.x, y[i] = facet.y;
    u_x[i] = facet.u_x, u_y[i] = facet.u_y, v_x[i] = facet.v_x, v_y[i] = facet.v_y;
    guard[i] = facet.guard;
  }
  alignas(64) std::int32_t verdict[block_capacity];
  const double extent = mesh.extent;
#pragma GCC ivdep
  for (int i = 0; i < count; ++i) {
    const Facet facet{z[i], found.slope_x[i], found.slope_y[i], x[i], y[i], u_x[i], u_y[i], v_x[i], v_y[i], guard[i], {}};
    const Judgement<double> judged = judge(facet, line_of(lines, found, i), extent);
    found.path[i] = judged.path;
    least[i] = judged.least;
    verdict[i] = static_cast<std::int32_t>(judged.verdict);
  }

  // Those that are not on their first facet.
  std::int16_t going[block_capacity], lost[block_capacity];
  int going_count = 0, lost_count = 0;
  for (int i = 0; i < count; ++i) {
    const bool inside = has_start[i] & (verdict[i] == static_cast<std::int32_t>(Verdict::inside));
    found.facet[i] = inside ? start[i] : no_facet;
    going[going_count] = lost[lost_count] = static_cast<std::int16_t>(i);
    going_count += has_start[i] & !inside;
    lost_count += lines.travels[i] & !has_start[i];
  }
  const auto arrive = [&](int i, std::uint32_t facet, double path) {
    found.facet[i] = facet;
    found.path[i] = path;
    found.slope_x[i] = facets[facet].slope_x;
    found.slope_y[i] = facets[facet].slope_y;
  };
  Walk walks[block_capacity];
  const auto step = [&](int i, const Judgement<double>& judged) {  // true: there is a next facet
    const AimedLine<double> line = line_of(lines, found, i);
    if (!go_on(mesh, line, judged, walks[i])) {
      __builtin_prefetch(facets + walks[i].at);
      return true;
    }
    const double path = walks[i].at == no_facet ? 0 : path_to(mesh, walks[i].at, line);
    if (walks[i].at != no_facet && is_near(path, extent))
      arrive(i, walks[i].at, path);
    else
      lost[lost_count++] = static_cast<std::int16_t>(i);
    return false;
  };
  const auto keep = [&](auto&& goes_on) {
    int kept = 0;
    for (int k = 0; k < going_count; ++k)
      if (goes_on(going[k])) going[kept++] = going[k];
    going_count = kept;
  };
  keep([&](int i) {
    walks[i] = {start[i]};
    return step(i, {found.path[i], least[i], static_cast<Verdict>(verdict[i])});
  });
  while (going_count > 0)
    keep([&](int i) {
      const Judgement<double> judged = judge(facets[walks[i].at], line_of(lines, found, i), extent);
      if (judged.verdict != Verdict::inside) return step(i, judged);
      arrive(i, walks[i].at, judged.path);
      return false;
    });
  for (int k = 0; k < lost_count; ++k) {
    const int i = lost[k];
    AimedLine<double> line = line_of(lines, found, i);
    const auto [facet, path] = locate(mesh, line, [] {});
    if (facet == no_facet) continue;
    found.o.x[i] = line.o.x, found.o.y[i] = line.o.y, found.o.z[i] = line.o.z, found.o.path[i] = line.path;
    arrive(i, facet, path);
  }
}

}  // namespace sagitta::surface
