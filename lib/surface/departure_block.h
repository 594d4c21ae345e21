// SPDX-License-Identifier: Apache-2.0
// Where the lines of a block meet a surface that departs from a base conic by a polynomial: the surface's own iteration
// (look_at), for as many lines at a time as T holds. Lines that it does not settle are met one by one.
//
// The surface has, besides meet(), whose bits these are,
//   Conic base;   Sum<T> sum_of_polynomial(x, y);   Approach<T> look_at(origin, d, approach, sum, is_first);   most_looks
//   passes_no_other(origin, d, approach)
#pragma once

#include "lib/numerics/instruction_set.h"
#include "lib/surface/block.h"
#include "lib/surface/departure.h"

namespace sagitta::surface {

// Lines i and on, as T holds; whether the iteration has arrived is in the status.
template <class T, class Surface>
void look_at_lines(const Surface& surface, const BlockOfLines& lines, int i, BlockOfCrossings& crossings) {
  using Approach = typename Surface::template Approach<T>;
  const Vec3<T> d{T::load(lines.l + i), T::load(lines.m + i), T::load(lines.n + i)};
  const Crossing<T> start = surface.base.meet(Vec3<T>{T::load(lines.x + i), T::load(lines.y + i), T::load(lines.z + i)}, d);
  const Vec3<T>& origin = start.point;
  const T going(Approach::going), arrived(Approach::arrived), given_up(Approach::given_up);
  Approach now{};
  now.state = select<T>(start.status == Status::ok, going, given_up);
  for (int look = 0; look < Surface::most_looks; ++look) {
    now = surface.look_at(origin, d, now, surface.template sum_of_polynomial<T>(origin.x + now.t * d.x, origin.y + now.t * d.y), look == 0);
    if (all(now.state > going)) break;
  }
  const Vec3<T> point = origin + now.t * d;
  T(start.path + now.t).store(crossings.path + i);
  point.x.store(crossings.x + i), point.y.store(crossings.y + i), point.z.store(crossings.z + i);
  now.slope_x.store(crossings.slope_x + i), now.slope_y.store(crossings.slope_y + i);
  const T ok(static_cast<int>(Status::ok)), unsettled(static_cast<int>(Status::not_converged));
  select<T>((now.state == arrived) & surface.passes_no_other(origin, d, now), ok, unsettled).store(crossings.status + i);
}

template <class Surface>
void meet_departures(const Surface& surface, const BlockOfLines& lines, BlockOfCrossings& crossings) {
  numerics::with_chosen_instructions_flat([&]<int n>() {
    using T = numerics::TwiceLanes<n>;
    static_assert(block_capacity % (2 * n) == 0);
    for (int i = 0; i < lines.count; i += 2 * n) look_at_lines<T>(surface, lines, i, crossings);
  });
  for (int i = 0; i < lines.count; ++i)
    if (crossings.status[i] != static_cast<std::int32_t>(Status::ok) && lines.travels[i])
      crossings.put(i, surface.meet(Vec3<double>{lines.x[i], lines.y[i], lines.z[i]}, Vec3<double>{lines.l[i], lines.m[i], lines.n[i]}));
}

}  // namespace sagitta::surface
