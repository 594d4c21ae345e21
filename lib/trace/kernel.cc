// SPDX-License-Identifier: Apache-2.0
#include "lib/trace/kernel.h"

#include <type_traits>

#include "lib/numerics/instruction_set.h"
#include "lib/surface/refraction.h"

namespace sagitta::trace {
namespace {

using numerics::InstructionSet, numerics::instruction_set;

enum class Deflection { none, refract, reflect };

// The surface's plain numbers, read once per block.
struct Setting {
  numerics::RigidTransform<double> local_from_previous;
  double index_before;
  surface::IndexRatio<double> ratio;
  double outer_squared, inner_squared;
  int surface_number;
};

// Rays from the frame before into the surface's own.
template <bool centred>
[[gnu::always_inline]] inline void to_local(const Setting& setting, Vec3<double>& start, Vec3<double>& d) {
  if constexpr (centred) {
    start.z += setting.local_from_previous.translation.z;
  } else {
    start = setting.local_from_previous * start;
    d = setting.local_from_previous.rotation * d;
  }
}

// A shape whose crossings with the block's rays are known already.
struct Met {
  const surface::BlockOfCrossings* crossings;

  [[gnu::always_inline]] surface::Crossing<double> at(int i, const Vec3<double>& d) const {
    const surface::BlockOfCrossings& at = *crossings;
    const double a = at.slope_x[i], b = at.slope_y[i];
    return {at.path[i], {at.x[i], at.y[i], at.z[i]}, {-a, -b, 1}, d.z - a * d.x - b * d.y, static_cast<Status>(at.status[i])};
  }
};

template <class Shape>
[[gnu::always_inline]] inline surface::Crossing<double> meet_one(const Shape& shape, const Vec3<double>& start, const Vec3<double>& d, int i) {
  if constexpr (std::is_same_v<Shape, Met>)
    return shape.at(i, d);
  else
    return shape.meet(start, d);
}

template <bool centred, int doubles_in_vector, class Shape>
[[gnu::always_inline]] inline void meet_block(const Shape& shape, const Setting& setting, const RayColumns& rays,
                                              const int ray_count, surface::BlockOfCrossings& crossings) {
  surface::BlockOfLines lines;
  lines.count = ray_count;
#pragma GCC ivdep
  for (int i = 0; i < ray_count; ++i) {
    Vec3<double> start{rays.x[i], rays.y[i], rays.z[i]}, d{rays.l[i], rays.m[i], rays.n[i]};
    to_local<centred>(setting, start, d);
    lines.x[i] = start.x, lines.y[i] = start.y, lines.z[i] = start.z;
    lines.l[i] = d.x, lines.m[i] = d.y, lines.n[i] = d.z;
  }
  for (int i = 0; i < ray_count; ++i) lines.travels[i] = rays.ended[i] == 0;
  if constexpr (requires { shape.template meet_block<doubles_in_vector>(lines, crossings); })
    shape.template meet_block<doubles_in_vector>(lines, crossings);
  else
    shape.meet_block(lines, crossings);
}

template <bool centred, Deflection deflection, class Shape>
[[gnu::always_inline]] inline void advance_block(const Shape& shape, const Setting& setting, const RayColumns& rays,
                                                 const int ray_count) {
#pragma GCC ivdep
  for (int i = 0; i < ray_count; ++i) {
    const std::int32_t ended = rays.ended[i];
    const double opl = rays.opl[i];
    const bool travels = ended == 0;
    Vec3<double> start{rays.x[i], rays.y[i], rays.z[i]}, d{rays.l[i], rays.m[i], rays.n[i]};
    const Vec3<double> old_start = start, old_d = d;
    to_local<centred>(setting, start, d);

    const surface::Crossing<double> crossing = meet_one(shape, start, d, i);
    const bool met = crossing.status == Status::ok;
    const Vec3<double> hit = crossing.point;
    const double r_squared = hit.x * hit.x + hit.y * hit.y;
    const bool open = (r_squared <= setting.outer_squared) & !(r_squared < setting.inner_squared);

    Vec3<double> out = d;
    if constexpr (deflection == Deflection::refract)
      out = surface::refract(d, crossing.normal, crossing.along, setting.ratio);
    if constexpr (deflection == Deflection::reflect) out = surface::reflect(d, crossing.normal, crossing.along);
    const bool transmitted = out.x == out.x;  // not NaN

    const bool moves = travels & met, turns = moves & open & transmitted;
    rays.x[i] = moves ? hit.x : travels ? start.x : old_start.x;
    rays.y[i] = moves ? hit.y : travels ? start.y : old_start.y;
    rays.z[i] = moves ? hit.z : travels ? start.z : old_start.z;
    rays.l[i] = turns ? out.x : travels ? d.x : old_d.x;
    rays.m[i] = turns ? out.y : travels ? d.y : old_d.y;
    rays.n[i] = turns ? out.z : travels ? d.z : old_d.z;
    rays.opl[i] = moves ? opl + setting.index_before * crossing.path : opl;
    const Status why_not = !met ? crossing.status : !open ? Status::clipped : Status::total_reflection;
    rays.ended[i] = turns | !travels ? ended : ending(setting.surface_number, why_not);
  }
}

// The same body for each instruction set. Without contraction all give the same bits. A function that the compiler did
// not draw in is an ordinary one for every machine, so nothing can trap.
template <bool centred, Deflection deflection, class Shape>
[[gnu::noinline]] void advance_for_any(const Shape shape, const Setting setting, const RayColumns rays, const int ray_count) {
  advance_block<centred, deflection>(shape, setting, rays, ray_count);
}
template <bool centred, class Shape>
[[gnu::noinline]] void meet_for_any(const Shape shape, const Setting setting, const RayColumns rays, const int ray_count,
                  surface::BlockOfCrossings& crossings) {
  meet_block<centred, 2>(shape, setting, rays, ray_count, crossings);
}
#if defined(__x86_64__)
template <bool centred, Deflection deflection, class Shape>
[[gnu::target("arch=x86-64-v3")]] void advance_for_v3(const Shape shape, const Setting setting, const RayColumns rays,
                                                      const int ray_count) {
  advance_block<centred, deflection>(shape, setting, rays, ray_count);
}
template <bool centred, Deflection deflection, class Shape>
[[gnu::target("arch=x86-64-v4")]] void advance_for_v4(const Shape shape, const Setting setting, const RayColumns rays,
                                                      const int ray_count) {
  advance_block<centred, deflection>(shape, setting, rays, ray_count);
}
template <bool centred, class Shape>
[[gnu::target("arch=x86-64-v3")]] void meet_for_v3(const Shape shape, const Setting setting, const RayColumns rays,
                                                   const int ray_count, surface::BlockOfCrossings& crossings) {
  meet_block<centred, 4>(shape, setting, rays, ray_count, crossings);
}
template <bool centred, class Shape>
[[gnu::target("arch=x86-64-v4")]] void meet_for_v4(const Shape shape, const Setting setting, const RayColumns rays,
                                                   const int ray_count, surface::BlockOfCrossings& crossings) {
  meet_block<centred, 8>(shape, setting, rays, ray_count, crossings);
}
#endif

// Shapes that meet a block at once.
template <class Shape>
concept MeetsBlocks = requires(const Shape& shape, surface::BlockOfLines& lines, surface::BlockOfCrossings& crossings) {
  shape.meet_block(lines, crossings);
};

// Shapes with a closed form become vectors; an iteration or a search runs ray by ray, where wider registers do not help.
template <class Shape>
inline constexpr bool has_closed_form =
    std::is_same_v<Shape, surface::Plane> || std::is_same_v<Shape, surface::Conic> || std::is_same_v<Shape, Met>;

template <bool centred, class Shape>
void meet_with_chosen_instructions(const Shape& shape, const Setting& setting, const RayColumns& rays, int ray_count,
                                   surface::BlockOfCrossings& crossings) {
#if defined(__x86_64__)
  switch (instruction_set()) {
    case InstructionSet::x86_64_v4: return meet_for_v4<centred>(shape, setting, rays, ray_count, crossings);
    case InstructionSet::x86_64_v3: return meet_for_v3<centred>(shape, setting, rays, ray_count, crossings);
    case InstructionSet::any: break;
  }
#endif
  meet_for_any<centred>(shape, setting, rays, ray_count, crossings);
}

template <bool centred, Deflection deflection, class Shape>
void choose_instructions(const Shape& shape, const Setting& setting, const RayColumns& rays, int ray_count) {
#if defined(__x86_64__)
  if constexpr (has_closed_form<Shape>) {
    switch (instruction_set()) {
      case InstructionSet::x86_64_v4: return advance_for_v4<centred, deflection>(shape, setting, rays, ray_count);
      case InstructionSet::x86_64_v3: return advance_for_v3<centred, deflection>(shape, setting, rays, ray_count);
      case InstructionSet::any: break;
    }
  }
#endif
  advance_for_any<centred, deflection>(shape, setting, rays, ray_count);
}

template <bool centred, class Shape>
void choose_deflection(Deflection deflection, const Shape& shape, const Setting& setting, const RayColumns& rays,
                       int ray_count) {
  if constexpr (MeetsBlocks<Shape>) {
    surface::BlockOfCrossings crossings;
    meet_with_chosen_instructions<centred>(shape, setting, rays, ray_count, crossings);
    return choose_deflection<centred>(deflection, Met{&crossings}, setting, rays, ray_count);
  } else switch (deflection) {
    case Deflection::none: return choose_instructions<centred, Deflection::none>(shape, setting, rays, ray_count);
    case Deflection::refract: return choose_instructions<centred, Deflection::refract>(shape, setting, rays, ray_count);
    case Deflection::reflect: return choose_instructions<centred, Deflection::reflect>(shape, setting, rays, ray_count);
  }
}

}  // namespace

void advance(const scene::Surface& surface, int surface_number, double index_before, double index_after,
             const RayColumns& rays, int ray_count) {
  const Setting setting{surface.local_from_previous,
                        index_before,
                        surface::IndexRatio<double>::of(index_before, index_after),
                        surface.semi_diameter * surface.semi_diameter,
                        surface.inner_semi_diameter * surface.inner_semi_diameter,
                        surface_number};
  const Deflection deflection = surface.image                 ? Deflection::none
                                : surface.mirror              ? Deflection::reflect
                                : index_before == index_after ? Deflection::none
                                                              : Deflection::refract;
  std::visit(
      [&](const auto& shape) {
        if (surface.centred)
          choose_deflection<true>(deflection, shape, setting, rays, ray_count);
        else
          choose_deflection<false>(deflection, shape, setting, rays, ray_count);
      },
      surface.shape);
}

}  // namespace sagitta::trace
