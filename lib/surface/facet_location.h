// SPDX-License-Identifier: Apache-2.0
// Which facet of a mesh a line meets.
//
// Seen from the middle of the mesh, the base sphere predicts a point o of the line near the facets, the grid gives a facet
// there, and a walk along the line goes on from it. The line meets the plane of a facet at
//   t = (z + slope . (O - x) - o_z)/along,   along = d_z - slope . d,   X = o + t d                                (1)
// and the weights of X (surface/mesh.h) tell whether it is on the facet: yes if all are above the guard, no if one is
// below minus the guard; then the walk crosses the edge opposite to it or, where X is far, takes a new facet from the
// grid at X. Between the two, where floats and the rounding of (1) cannot tell, an exact test decides:
//
// Seen along the line, every vertex v is a point of a plane across it,
//   v' = (right.(v - o), up.(v - o)),                                                                              (2)
// right, up, forward a right-handed frame, forward = +-d with z >= 0. The line passes through the facet (v0, v1, v2) in the
// sense of its forward side if all of
//   w0 = v1' x v2',   w1 = v2' x v0',   w2 = v0' x v1'                                                             (3)
// are >= 0 and their sum is > 0. No line is lost between facets: (2) depends on the vertex and the line alone, so all
// facets see the same v', only moved by rounding; w of the shared edge has the same bits and the opposite sign in the two
// facets; and since rounding is monotone, the sign of a w is that of the exact w of the rounded v', or it is zero, which
// counts as inside. Facets that close up around a point cover it at least once with positive area, so one takes the line.
//
// The walk is a shortcut, not the proof of a miss: where it comes to a rim, or takes too long, the tree of boxes gives
// every facet that the line may meet, (3) judges each, and of those it passes through the one nearest to the predicted
// point is taken.
//
// On an edge or a vertex several facets count as passed through; the one of the lowest number answers, whichever way the
// walk came. (A line may also pass through several facets apart from each other, where the surface is steeper than the line:
// a walk answers with the first that it comes to.)
//
// The guard. Stored floats are off by 2^-24 of themselves, the place (x, y) by 2^-24 of the extent E; X - x is below 2 E. So
// a weight is known to 2^-22 E (|u_x| + |u_y| + |v_x| + |v_y|), the guard of a facet, with room for a third more. The
// rounding of (1) needs less than that room while t is short (2^-6 E) and along > 2^-20 (1 + |slope_x| + |slope_y|):
// beyond these the exact test decides.
//
// Source: walks: Devillers, Pion and Teillaud, Int. J. Found. Comput. Sci. 13, 181 (2002). The watertight test: Woop, Benthin
// and Wald, J. Comput. Graph. Tech. 2, 65 (2013), with a rotation (Duff et al., J. Comput. Graph. Tech. 6, 1 (2017)) in
// place of their shear, and zero inside in place of a second precision.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

#include "lib/surface/crossing.h"
#include "lib/surface/mesh.h"

namespace sagitta::surface {

// A line as the mesh sees it: o is near the facets, relative to the mesh's centre, and stands at `path` of the line.
template <class T>
struct AimedLine {
  Vec3<T> o, d;
  T path;
};

// o is found from the point of the line nearest to the centre: a start far away costs its own rounding only. Where the line
// passes the base sphere by, or meets it far from all facets, that point is the best guess.
template <class T>
[[gnu::always_inline]] inline AimedLine<T> aim(const Mesh& mesh, const Vec3<T>& start, const Vec3<T>& d) {
  const Vec3<T> from_centre = start - numerics::vec3_cast<T>(mesh.centre);
  const T to_middle = -dot(from_centre, d);
  const Vec3<T> middle = from_centre + to_middle * d;
  const T predicted = mesh.base.path(middle, d);
  using std::abs;
  const T near = abs(predicted) <= T(4 * mesh.extent) ? predicted : T(0);  // NaN is not
  return {middle + near * d, d, to_middle + near};
}

// Whether a path from o is short, as it is where the prediction was good.
template <class T>
[[gnu::always_inline]] inline bool is_near(const T& path, const T& extent) {
  using std::abs;
  return abs(path) <= T(0x1p-6) * extent;
}

enum class Verdict : std::int32_t { beyond_0, beyond_1, beyond_2, inside, near_edge, grazing };

// (1): where the line meets the plane of a facet, and what the weights say.
template <class T>
struct Judgement {
  T path;   // from o
  T least;  // weight
  Verdict verdict;
};
template <class T>
[[gnu::always_inline]] inline Judgement<T> judge(const Facet& facet, const AimedLine<T>& line, const T& extent) {
  using std::abs;
  const T slope_x(facet.slope_x), slope_y(facet.slope_y);
  const T from_x = line.o.x - T(facet.x), from_y = line.o.y - T(facet.y);
  const T along = line.d.z - slope_x * line.d.x - slope_y * line.d.y;
  const T path = (T(facet.z) + slope_x * from_x + slope_y * from_y - line.o.z) / along;
  const T X = from_x + path * line.d.x, Y = from_y + path * line.d.y;
  const T w1 = T(facet.u_x) * X + T(facet.u_y) * Y, w2 = T(facet.v_x) * X + T(facet.v_y) * Y, w0 = T(1) - w1 - w2;
  const T least = w0 < w1 ? (w0 < w2 ? w0 : w2) : (w1 < w2 ? w1 : w2);
  const Verdict beyond = least == w0 ? Verdict::beyond_0 : least == w1 ? Verdict::beyond_1 : Verdict::beyond_2;
  const T forward = line.d.z < T(0) ? -along : along;
  const T guard(facet.guard);
  const bool sound = (forward > T(0x1p-20) * (T(1) + abs(slope_x) + abs(slope_y))) & is_near(path, extent);
  const Verdict verdict = !sound           ? Verdict::grazing
                          : least > guard  ? Verdict::inside
                          : least < -guard ? beyond
                                           : Verdict::near_edge;
  return {path, least, verdict};
}

// The exact test's weights (3) of a facet.
template <class T>
struct Weighed {
  std::uint32_t facet = no_facet;
  T w[3] = {T(0), T(0), T(0)};

  int least() const { return w[0] < w[1] ? (w[0] < w[2] ? 0 : 2) : (w[1] < w[2] ? 1 : 2); }
  bool inside() const { return w[0] >= T(0) && w[1] >= T(0) && w[2] >= T(0) && w[0] + w[1] + w[2] > T(0); }
};

// What is seen along a line.
template <class T>
struct View {
  Vec3<T> o, right, up;

  explicit View(const AimedLine<T>& line) : o(line.o) {
    const Vec3<T> f = line.d.z < T(0) ? -line.d : line.d;
    const T s = T(1) / (T(1) + f.z), xy = -(f.x * f.y * s);
    right = {T(1) - f.x * f.x * s, xy, -f.x};
    up = {xy, T(1) - f.y * f.y * s, -f.y};
  }
  Weighed<T> weigh(const Mesh& mesh, std::uint32_t facet) const {
    T x[3], y[3];
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3<T> v = numerics::vec3_cast<T>(mesh.vertices[mesh.corners[facet][i]] - mesh.centre) - o;
      x[i] = dot(right, v);  // (2)
      y[i] = dot(up, v);
    }
    return {facet, {x[1] * y[2] - y[1] * x[2], x[2] * y[0] - y[2] * x[0], x[0] * y[1] - y[0] * x[1]}};  // (3)
  }
};

// Of the facets that share the edge or the vertex which the line passes through, the one of the lowest number: around the
// vertex both ways, however many there are.
template <class T>
std::uint32_t lowest_of_touching(const Mesh& mesh, const View<T>& view, const Weighed<T>& passed) {
  std::uint32_t lowest = passed.facet;
  for (int i = 0; i < 3; ++i) {
    if (passed.w[i] != T(0)) continue;
    std::uint32_t before = passed.facet, at = mesh.facets[before].neighbour[i];
    for (std::uint32_t step = 0; at != no_facet && at != passed.facet && step < mesh.facet_count; ++step) {
      const Weighed<T> facet = view.weigh(mesh, at);
      if (!facet.inside()) break;
      lowest = at < lowest ? at : lowest;
      std::uint32_t next = no_facet;  // across its other edge that the line passes through
      for (int k = 0; k < 3; ++k)
        if (facet.w[k] == T(0) && mesh.facets[at].neighbour[k] != before) next = mesh.facets[at].neighbour[k];
      before = at;
      at = next;
    }
  }
  return lowest;
}

// The path from o to a facet that the line meets: to its plane. Where that is nearly parallel to the line, or the facet so
// thin that its plane says little, the path is kept between those at which the line comes over the facet and leaves it.
template <class T>
T path_to(const Mesh& mesh, std::uint32_t facet, const AimedLine<T>& line) {
  const Judgement<T> judged = judge(mesh.facets[facet], line, T(mesh.extent));
  if (judged.verdict != Verdict::grazing) return judged.path;
  const auto corner = [&](int i) { return numerics::vec3_cast<T>(mesh.vertices[mesh.corners[facet][i % 3]] - mesh.centre); };
  const T infinity = std::numeric_limits<T>::infinity();
  T first = -infinity, last = infinity;
  for (int i = 0; i < 3; ++i) {
    const Vec3<T> from = corner(i), edge = corner(i + 1) - from, to_o = line.o - from;
    const T inside = edge.x * to_o.y - edge.y * to_o.x, inward = edge.x * line.d.y - edge.y * line.d.x;
    if (inward > T(0) && first < -inside / inward) first = -inside / inward;
    if (inward < T(0) && last > -inside / inward) last = -inside / inward;
  }
  if (!(first <= last)) return (first + last) / T(2);  // rounding has turned a thin facet inside out
  if (!(judged.path >= first)) return first > -infinity ? first : T(0);
  return judged.path <= last ? judged.path : last;
}

// All facets that the line may meet, by the tree of boxes: of those it passes through, the one whose crossing is nearest
// to o.
template <class T, class Visited>
std::uint32_t search(const Mesh& mesh, const AimedLine<T>& line, Visited&& visited) {
  using Double = Vec3<double>;
  const Double o = numerics::vec3_cast<double>(line.o), d = numerics::vec3_cast<double>(line.d);
  if (!(dot(o, o) < std::numeric_limits<double>::infinity()) || !(dot(d, d) < std::numeric_limits<double>::infinity())) return no_facet;
  // A direction of 0 becomes 1e-300: the quotients stay numbers, and no slab is missed.
  const auto inverse = [](double v) { return 1 / (std::abs(v) < 1e-300 ? 1e-300 : v); };
  const double from[3] = {o.x, o.y, o.z}, per[3] = {inverse(d.x), inverse(d.y), inverse(d.z)};
  const auto meets = [&](const Box& box) {
    double first = -std::numeric_limits<double>::infinity(), last = -first;
    for (int i = 0; i < 3; ++i) {
      const double one = (box.low[i] - from[i]) * per[i], other = (box.high[i] - from[i]) * per[i];
      const double enter = one < other ? one : other, leave = one < other ? other : one;
      first = first < enter ? enter : first;
      last = last > leave ? leave : last;
    }
    return first <= last;
  };

  const View<T> view(line);
  std::uint32_t nearest = no_facet;
  T least_distance{};
  const auto look_into = [&](std::uint32_t leaf) {
    const std::uint32_t begin = leaf * Mesh::leaf_size, end = begin + Mesh::leaf_size;
    for (std::uint32_t f = begin; f < end && f < mesh.facet_count; ++f) {
      visited();
      const Weighed<T> facet = view.weigh(mesh, f);
      if (!facet.inside()) continue;
      const T path = path_to(mesh, f, line);
      const T distance = path < T(0) ? -path : path;
      if (nearest != no_facet && !(distance < least_distance)) continue;
      nearest = f;
      least_distance = distance;
    }
  };

  // Levels begin at these boxes; the root is the last level's only one.
  constexpr int most_levels = 16;
  std::uint32_t level_begin[most_levels + 1] = {0}, level_size[most_levels];
  int levels = 0;
  for (std::uint32_t size = (mesh.facet_count + Mesh::leaf_size - 1) / Mesh::leaf_size;; size = (size + Mesh::branching - 1) / Mesh::branching) {
    level_size[levels] = size;
    level_begin[levels + 1] = level_begin[levels] + size;
    ++levels;
    if (size <= 1) break;
  }
  struct Place {
    int level;
    std::uint32_t index;
  };
  Place stack[most_levels * Mesh::branching];
  int waiting = 0;
  stack[waiting++] = {levels - 1, 0};
  while (waiting > 0) {
    const Place at = stack[--waiting];
    if (!meets(mesh.boxes[level_begin[at.level] + at.index])) continue;
    if (at.level == 0) {
      look_into(at.index);
      continue;
    }
    const std::uint32_t begin = at.index * Mesh::branching;
    for (std::uint32_t i = Mesh::branching; i-- > 0;)  // taken from the stack in their order
      if (begin + i < level_size[at.level - 1]) stack[waiting++] = {at.level - 1, begin + i};
  }
  return nearest == no_facet ? no_facet : lowest_of_touching(mesh, view, view.weigh(mesh, nearest));
}

// How a walk goes on.
struct Walk {
  static constexpr int most_steps = 200;  // far more than any that does not go in circles
  static constexpr int most_leaps = 4;
  static constexpr double leap_below = -2;  // where the least weight is less, the facet is far away
  std::uint32_t at = no_facet;
  int steps = 0, leaps = 0;
};

// One facet further; an exact test where the judgement does not tell which. Returns true where the walk has ended: on the
// facet that is met, or on none.
template <class T>
bool go_on(const Mesh& mesh, const AimedLine<T>& line, const Judgement<T>& judged, Walk& walk) {
  if (judged.verdict == Verdict::inside) return true;
  if ((judged.least < T(Walk::leap_below) || !is_near(judged.path, T(mesh.extent))) && walk.leaps < Walk::most_leaps) {
    // far from here: not across one edge after another, but to the grid's facet there
    ++walk.leaps;
    const std::uint32_t there = mesh.grid.facet_near(double(line.o.x + judged.path * line.d.x), double(line.o.y + judged.path * line.d.y));
    if (there != no_facet && there != walk.at) {
      walk.at = there;
      return false;
    }
  }
  int across = static_cast<int>(judged.verdict);
  if (judged.verdict == Verdict::near_edge || judged.verdict == Verdict::grazing) {
    const View<T> view(line);
    const Weighed<T> weighed = view.weigh(mesh, walk.at);
    if (weighed.inside()) {
      walk.at = lowest_of_touching(mesh, view, weighed);
      return true;
    }
    across = weighed.least();
    if (!(weighed.w[across] < T(0))) walk.steps = Walk::most_steps;  // seen edge-on, or not a number: no way on
  }
  walk.at = walk.steps++ < Walk::most_steps ? mesh.facets[walk.at].neighbour[across] : no_facet;
  return walk.at == no_facet;
}

// The facet that the line meets, and the path to it from o.
template <class T>
struct Located {
  std::uint32_t facet = no_facet;  // no_facet: none is met
  T path{};
};
// `visited` is called once for every facet that is tested. Where o proves to be far from the facet, it is moved there, and
// all is done once more: what is seen from afar is rounded.
template <class T, class Visited>
Located<T> locate(const Mesh& mesh, AimedLine<T>& line, Visited&& visited) {
  for (int aims = 1;; ++aims) {
    Walk walk{mesh.grid.facet_near(double(line.o.x), double(line.o.y))};
    while (walk.at != no_facet) {
      visited();
      if (go_on(mesh, line, judge(mesh.facets[walk.at], line, T(mesh.extent)), walk)) break;
    }
    const std::uint32_t facet = walk.at != no_facet ? walk.at : search(mesh, line, visited);
    if (facet == no_facet) return {};
    const T path = path_to(mesh, facet, line);
    if (is_near(path, T(mesh.extent)) || aims == 2) return {facet, path};
    line.o = line.o + path * line.d;
    line.path = line.path + path;
  }
}

}  // namespace sagitta::surface
