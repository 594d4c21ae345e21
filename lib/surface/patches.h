// SPDX-License-Identifier: Apache-2.0
// A smooth surface through measured points: a Clough-Tocher element (clough_tocher.h) on every facet.
//
// A ray is first sent to the flat facets (facets.h), which are within O(h^2) of the patches; from that hit it goes on to the
// patch over the facet. Where it leaves that patch, or one third of it, before it comes to the surface, the safeguarded
// iteration of departure.h takes over, stepping from triangle to triangle with (x, y): the surface is C1 there, so Newton's
// method converges as on any smooth surface. The normal is the patch's own gradient.
//
// Domain: the (x, y) of the facets. A ray whose flat hit, or whose hit on the patches, lies beyond the rim or in a hole ends
// as outside_data: nothing is extrapolated.
#pragma once

#include "lib/surface/departure.h"
#include "lib/surface/facets.h"
#include "lib/surface/patch_block.h"

namespace sagitta::surface {

struct Patches {
  static constexpr bool is_made_of_data = true;

  Facets facets;
  const CloughTocherPatch* patches = nullptr;  // one a facet

  static constexpr std::string_view kernel() { return "C1 patches"; }
  std::size_t data_bytes() const { return facets.data_bytes() + facets.mesh->facet_count * sizeof *patches; }
  double vertex_curvature() const { return facets.vertex_curvature(); }

  template <class T>
  T sag(const T& x, const T& y) const {
    Walker<T> walker{*this, facets.facet_at(x, y)};
    return walker.facet == no_facet ? not_a_number<T>() : walker.height(x, y).z;
  }
  template <class T>
  Gradient<T> gradient(const T& x, const T& y) const {
    Walker<T> walker{*this, facets.facet_at(x, y)};
    if (walker.facet == no_facet) return {not_a_number<T>(), not_a_number<T>()};
    const Height<T> h = walker.height(x, y);
    return {h.dz_dx, h.dz_dy};
  }
  template <class T>
  Crossing<T> meet(const Vec3<T>& p, const Vec3<T>& d) const {
    return meet_from_facet(facets.find(p, d), d);
  }

  [[gnu::always_inline]] void meet_block(const BlockOfLines& lines, BlockOfCrossings& crossings) const {
    FacetsOfBlock flat;
    facets.meet_block(lines, crossings, flat);
    bool settled[block_capacity];
    meet_patches(patches, lines, flat, crossings, settled);
    for (int i = 0; i < lines.count; ++i) {
      if (settled[i] || flat.facet[i] == no_facet) continue;
      const Facets::Hit<double> hit{flat.facet[i], crossings.path[i], {crossings.x[i], crossings.y[i], crossings.z[i]}};
      crossings.put(i, meet_across_patches(hit, Vec3<double>{lines.l[i], lines.m[i], lines.n[i]}));
    }
  }

 private:
  template <class T>
  Crossing<T> meet_from_facet(const Facets::Hit<T>& flat, const Vec3<T>& d) const {
    if (flat.facet == no_facet) return no_crossing<T>(Status::outside_data);
    const Facet& plane = facets.mesh->facets[flat.facet];
    const auto at = patches[flat.facet].arrive(flat.point.x, flat.point.y, d, T(plane.slope_x), T(plane.slope_y));
    if (at.is_sound) {
      const Vec3<T> normal{-at.dz_dx, -at.dz_dy, T(1)};
      return {flat.path + at.t, flat.point + at.t * d, normal, dot(normal, d), Status::ok};
    }
    return meet_across_patches(flat, d);
  }
  // From one patch or third to another, and wherever else the shortest way does not lead to the end.
  template <class T>
  Crossing<T> meet_across_patches(const Facets::Hit<T>& flat, const Vec3<T>& d) const {
    Walker<T> walker{*this, flat.facet};
    const Crossing<T> crossing = meet_from(flat.path, flat.point, !(d.z < T(0)), walker, d);
    if (crossing.status != Status::ok) return crossing;
    walker.go_to(crossing.point.x, crossing.point.y);
    return walker.beyond_rim ? no_crossing<T>(Status::outside_data) : crossing;
  }

  // Goes from facet to facet with (x, y), and remembers where it is.
  template <class T>
  struct Walker {
    const Patches& surface;
    std::uint32_t facet;
    bool beyond_rim = false;

    void go_to(const T& x, const T& y) {
      constexpr int longest_walk = 1000;
      beyond_rim = false;
      for (int step = 0;; ++step) {
        const auto m = surface.patches[facet].locate(x, y);
        const int edge = m.m0 < m.m1 ? (m.m0 < m.m2 ? 0 : 2) : (m.m1 < m.m2 ? 1 : 2);
        const T least = edge == 0 ? m.m0 : edge == 1 ? m.m1 : m.m2;
        if (!(least < -T(patch_slack))) return;
        const std::uint32_t next = surface.facets.mesh->facets[facet].neighbour[edge];
        if (next == no_facet || step >= longest_walk) {
          beyond_rim = true;
          return;
        }
        facet = next;
      }
    }
    Height<T> height(const T& x, const T& y) {
      using std::abs;
      go_to(x, y);
      const auto sheet = surface.patches[facet].evaluate(x, y, surface.facets.mesh->facets[facet]);
      return {sheet.z, sheet.dz_dx, sheet.dz_dy, abs(sheet.z)};
    }
  };
};

}  // namespace sagitta::surface
