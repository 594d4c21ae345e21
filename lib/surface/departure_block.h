// SPDX-License-Identifier: Apache-2.0
// Where the lines of a block meet a surface that departs from a base conic by a polynomial: the surface's own iteration
// (look_at), for many lines at once. Lines that it does not settle are met one by one.
//
// The polynomial is evaluated for `at_once` lines, as many as the processor's vectors hold: more would not stay in vectors.
// The surface has, besides meet(), whose bits these are,
//   Conic base;   Sum<T> sum_of_polynomial(x, y);   Approach<T> look_at(origin, d, approach, sum, is_first);   most_looks
#pragma once

#include <cstring>

#include "lib/surface/block.h"
#include "lib/surface/departure.h"

namespace sagitta::surface {

template <int at_once, class Surface>
[[gnu::always_inline]] inline void meet_departures(const Surface& surface, const BlockOfLines& lines, BlockOfCrossings& crossings) {
  constexpr int portion = 64;  // whose columns stay in the fastest memory
  using Several [[gnu::vector_size(at_once * sizeof(double))]] = double;
  struct {
    alignas(64) double path[portion]{}, x[portion]{}, y[portion]{}, z[portion]{}, t[portion]{}, old_t[portion]{}, g[portion]{}, state[portion]{};
    alignas(64) double slope_x[portion]{}, slope_y[portion]{}, p[portion]{}, p_x[portion]{}, p_y[portion]{}, l[portion]{}, m[portion]{}, n[portion]{};
  } of;
  using Approach = typename Surface::template Approach<double>;
  for (int begin = 0; begin < lines.count; begin += portion) {
    const int size = lines.count - begin < portion ? lines.count - begin : portion;
#pragma GCC ivdep
    for (int k = 0; k < size; ++k) {
      const int i = begin + k;
      const Vec3<double> d{lines.l[i], lines.m[i], lines.n[i]};
      const Crossing<double> start = surface.base.meet(Vec3<double>{lines.x[i], lines.y[i], lines.z[i]}, d);
      of.path[k] = start.path;  // NaN where the conic is missed: such a line settles nothing
      of.x[k] = start.point.x, of.y[k] = start.point.y, of.z[k] = start.point.z;
      of.l[k] = d.x, of.m[k] = d.y, of.n[k] = d.z;
      of.t[k] = of.old_t[k] = of.g[k] = of.slope_x[k] = of.slope_y[k] = 0;
      of.state[k] = start.path == start.path ? Approach::going : Approach::given_up;
    }
    for (int look = 0; look < Surface::most_looks; ++look) {
      for (int k = 0; k < size; k += at_once) {
        alignas(64) Several x, y, l, m, t;
        std::memcpy(&x, of.x + k, sizeof x), std::memcpy(&y, of.y + k, sizeof y);
        std::memcpy(&l, of.l + k, sizeof l), std::memcpy(&m, of.m + k, sizeof m), std::memcpy(&t, of.t + k, sizeof t);
        alignas(64) const auto sum = surface.template sum_of_polynomial<Several>(x + t * l, y + t * m);
        std::memcpy(of.p + k, &sum.value, sizeof sum.value);
        std::memcpy(of.p_x + k, &sum.along_x, sizeof sum.along_x), std::memcpy(of.p_y + k, &sum.along_y, sizeof sum.along_y);
      }
      const bool is_first = look == 0;
#pragma GCC ivdep
      for (int k = 0; k < size; ++k) {
        const Approach after = surface.look_at(Vec3<double>{of.x[k], of.y[k], of.z[k]}, Vec3<double>{of.l[k], of.m[k], of.n[k]},
                                               Approach{of.t[k], of.old_t[k], of.g[k], of.slope_x[k], of.slope_y[k], of.state[k]},
                                               typename Surface::template Sum<double>{of.p[k], of.p_x[k], of.p_y[k]}, is_first);
        of.t[k] = after.t, of.old_t[k] = after.old_t, of.g[k] = after.g;
        of.slope_x[k] = after.slope_x, of.slope_y[k] = after.slope_y;
        of.state[k] = after.state;
      }
      double least = Approach::arrived;
      for (int k = 0; k < size; ++k) least = of.state[k] < least ? of.state[k] : least;
      if (least > Approach::going) break;
    }
#pragma GCC ivdep
    for (int k = 0; k < size; ++k) {
      const int i = begin + k;
      crossings.path[i] = of.path[k] + of.t[k];
      crossings.x[i] = of.x[k] + of.t[k] * of.l[k];
      crossings.y[i] = of.y[k] + of.t[k] * of.m[k];
      crossings.z[i] = of.z[k] + of.t[k] * of.n[k];
      crossings.slope_x[i] = of.slope_x[k];
      crossings.slope_y[i] = of.slope_y[k];
    }
    for (int k = 0; k < size; ++k) {
      const int i = begin + k;
      crossings.status[i] = static_cast<std::int32_t>(Status::ok);
      if (of.state[k] == Approach::arrived || !lines.travels[i]) continue;
      crossings.put(i, surface.meet(Vec3<double>{lines.x[i], lines.y[i], lines.z[i]}, Vec3<double>{lines.l[i], lines.m[i], lines.n[i]}));
    }
  }
}

}  // namespace sagitta::surface
