// SPDX-License-Identifier: Apache-2.0
// Which facets the lines of a block meet: the steps of facet_location.h, each for all lines before the next one, so that
// the memory that a step needs was asked for by the step before, and arithmetic becomes vectors.
//
//   aim all lines                                     ask for their cells of the grid
//   take the cells' facets                            ask for the facets
//   judge all lines; those not inside go on a facet   ask for these; again, until few are left, which go one by one
//
// Which lines are inside nothing could predict: lists of those that go on are written without branches.
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

// Facets as columns, but for their slopes, and what judge() says of them.
struct JudgedFacets {
  alignas(64) double z[block_capacity], least[block_capacity];
  alignas(64) float x[block_capacity], y[block_capacity], u_x[block_capacity], u_y[block_capacity], v_x[block_capacity], v_y[block_capacity],
      guard[block_capacity];
  alignas(64) std::int32_t verdict[block_capacity];

  [[gnu::always_inline]] void put(int k, const Facet& facet) {
    z[k] = facet.z;
    x[k] = facet.x, y[k] = facet.y;
    u_x[k] = facet.u_x, u_y[k] = facet.u_y, v_x[k] = facet.v_x, v_y[k] = facet.v_y;
    guard[k] = facet.guard;
  }
  // Line k by facet k.
  template <class Line>
  [[gnu::always_inline]] void judge_all(int count, const double* slope_x, const double* slope_y, double extent, double* path, const Line& line) {
#pragma GCC ivdep
    for (int k = 0; k < count; ++k) {
      const Facet facet{z[k], slope_x[k], slope_y[k], x[k], y[k], u_x[k], u_y[k], v_x[k], v_y[k], guard[k], {}};
      const Judgement<double> judged = judge(facet, line(k), extent);
      path[k] = judged.path;
      least[k] = judged.least;
      verdict[k] = static_cast<std::int32_t>(judged.verdict);
    }
  }
  Judgement<double> at(int k, double path) const { return {path, least[k], static_cast<Verdict>(verdict[k])}; }
};

// Numbers of lines.
struct LineList {
  std::int32_t line[block_capacity];
  int count = 0;
  void add_if(bool wanted, int i) {
    line[count] = i;
    count += wanted;
  }
};

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
  const double extent = mesh.extent;
  for (int i = 0; i < count; ++i) __builtin_prefetch(grid + (cell[i] < 0 ? 0 : cell[i]));
  Walk walks[block_capacity];
  alignas(64) std::uint32_t start[block_capacity];
  const auto or_any = [](std::uint32_t facet) { return facet == no_facet ? 0 : facet; };  // what it says is forgotten
  for (int i = 0; i < count; ++i) {
    const std::uint32_t facet = grid[cell[i] < 0 ? 0 : cell[i]];
    start[i] = ((cell[i] >= 0) & lines.travels[i]) ? facet : no_facet;
    __builtin_prefetch(facets + or_any(start[i]));
  }

  JudgedFacets judged;
  for (int i = 0; i < count; ++i) {
    const Facet& facet = facets[or_any(start[i])];
    judged.put(i, facet);
    found.slope_x[i] = facet.slope_x, found.slope_y[i] = facet.slope_y;
  }
  judged.judge_all(count, found.slope_x, found.slope_y, extent, found.path, [&](int i) __attribute__((always_inline)) { return line_of(lines, found, i); });
#pragma GCC ivdep
  for (int i = 0; i < count; ++i) found.facet[i] = judged.verdict[i] == static_cast<std::int32_t>(Verdict::inside) ? start[i] : no_facet;

  LineList outside, going, lost;
  for (int i = 0; i < count; ++i) outside.add_if(found.facet[i] == no_facet, i);
  const auto arrive = [&](int i, std::uint32_t facet, double path) {
    found.facet[i] = facet;
    found.path[i] = path;
    found.slope_x[i] = facets[facet].slope_x;
    found.slope_y[i] = facets[facet].slope_y;
  };
  // One facet further, if there is one.
  const auto step = [&](int i, const Judgement<double>& said) {
    Walk& walk = walks[i];
    const bool is_plain = (static_cast<std::int32_t>(said.verdict) < 3) & (said.least >= Walk::leap_below) & (walk.steps < Walk::most_steps);
    bool ends = false;
    if (__builtin_expect(is_plain, true)) {
      walk.at = facets[walk.at].neighbour[static_cast<std::int32_t>(said.verdict)];
      ++walk.steps;
    } else {
      const AimedLine<double> line = line_of(lines, found, i);
      ends = go_on(mesh, line, said, walk);
      const double path = ends && walk.at != no_facet ? path_to(mesh, walk.at, line) : 0;
      if (!is_near(path, extent)) walk.at = no_facet;  // o is far from it: locate() moves o there
      if (ends && walk.at != no_facet) arrive(i, walk.at, path);
    }
    __builtin_prefetch(facets + or_any(walk.at));
    lost.add_if(walk.at == no_facet, i);
    going.add_if((walk.at != no_facet) & !ends, i);
  };
  for (int k = 0; k < outside.count; ++k) {
    const int i = outside.line[k];
    walks[i] = {start[i]};
    if (start[i] != no_facet) step(i, judged.at(i, found.path[i]));
    else lost.add_if(lines.travels[i], i);
  }

  constexpr int few = 8;
  while (going.count >= few) {
    struct {
      alignas(64) double x[block_capacity], y[block_capacity], z[block_capacity], l[block_capacity], m[block_capacity], n[block_capacity];
      alignas(64) double slope_x[block_capacity], slope_y[block_capacity], path[block_capacity];
    } of;
    for (int k = 0; k < going.count; ++k) {
      const int i = going.line[k];
      const Facet& facet = facets[walks[i].at];
      judged.put(k, facet);
      of.slope_x[k] = facet.slope_x, of.slope_y[k] = facet.slope_y;
      of.x[k] = found.o.x[i], of.y[k] = found.o.y[i], of.z[k] = found.o.z[i];
      of.l[k] = lines.l[i], of.m[k] = lines.m[i], of.n[k] = lines.n[i];
    }
    judged.judge_all(going.count, of.slope_x, of.slope_y, extent, of.path, [&](int k) __attribute__((always_inline)) {
      return AimedLine<double>{{of.x[k], of.y[k], of.z[k]}, {of.l[k], of.m[k], of.n[k]}, 0};
    });
    LineList places;  // in the columns
    for (int k = 0; k < going.count; ++k) {
      const int i = going.line[k];
      const bool inside = judged.verdict[k] == static_cast<std::int32_t>(Verdict::inside);
      found.facet[i] = inside ? walks[i].at : no_facet;
      found.path[i] = of.path[k];
      found.slope_x[i] = of.slope_x[k], found.slope_y[i] = of.slope_y[k];
      places.add_if(!inside, k);
    }
    going.count = 0;  // it is written behind where it is read: at most one entry for each that was read
    for (int k = 0; k < places.count; ++k) {
      const int at = places.line[k];
      step(going.line[at], judged.at(at, of.path[at]));
    }
  }
  while (going.count > 0) {
    const int waiting = going.count;
    going.count = 0;
    for (int k = 0; k < waiting; ++k) {
      const int i = going.line[k];
      const Judgement<double> said = judge(facets[walks[i].at], line_of(lines, found, i), extent);
      if (said.verdict == Verdict::inside) arrive(i, walks[i].at, said.path);
      else step(i, said);
    }
  }
  for (int k = 0; k < lost.count; ++k) {
    const int i = lost.line[k];
    AimedLine<double> line = line_of(lines, found, i);
    const auto [facet, path] = locate(mesh, line, [] {});
    if (facet == no_facet) continue;
    found.o.x[i] = line.o.x, found.o.y[i] = line.o.y, found.o.z[i] = line.o.z, found.o.path[i] = line.path;
    arrive(i, facet, path);
  }
}

}  // namespace sagitta::surface
