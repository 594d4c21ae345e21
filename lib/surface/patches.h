// SPDX-License-Identifier: Apache-2.0
// A smooth surface through measured points: a Clough-Tocher element (clough_tocher.h) on every facet.
//
// A ray is first sent to the flat facets (facets.h), which are within O(h^2) of the patches; from that hit the safeguarded
// iteration of departure.h goes to the patches, stepping from triangle to triangle with (x, y). The surface is C1 there, so
// Newton's method converges as on any smooth surface. The normal is the patch's own gradient.
//
// Domain: the (x, y) of the facets. A ray whose flat hit, or whose hit on the patches, lies beyond the rim or in a hole ends
// as outside_data: nothing is extrapolated.
#pragma once

#include "lib/surface/clough_tocher.h"
#include "lib/surface/departure.h"
#include "lib/surface/facets.h"

namespace sagitta::surface {

struct Patches {
  static constexpr bool is_made_of_data = true;

  Facets facets;
  const CloughTocherPatch* patches = nullptr;  // one a facet

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
    const auto flat = facets.find(p, d);
    if (flat.facet == no_facet) return no_crossing<T>(Status::outside_data);
    Walker<T> walker{*this, flat.facet};
    const Crossing<T> crossing = meet_from(flat.path, flat.point, d.z > T(0), walker, d);
    if (crossing.status != Status::ok) return crossing;
    walker.height(crossing.point.x, crossing.point.y);
    return walker.beyond_rim ? no_crossing<T>(Status::outside_data) : crossing;
  }

 private:
  // Goes from facet to facet with (x, y), and remembers where it is.
  template <class T>
  struct Walker {
    const Patches& surface;
    std::uint32_t facet;
    bool beyond_rim = false;

    Height<T> height(const T& x, const T& y) {
      using std::abs;
      // A place this far outside counts as inside: the same on both sides of an edge, and far above rounding.
      const T slack(-1e-12);
      constexpr int longest_walk = 1000;
      beyond_rim = false;
      for (int step = 0;; ++step) {
        const CloughTocherPatch& patch = surface.patches[facet];
        const auto place = patch.locate(x, y);
        const T* m = place.m;
        const int least = m[0] < m[1] ? (m[0] < m[2] ? 0 : 2) : (m[1] < m[2] ? 1 : 2);
        const std::uint32_t next = surface.facets.mesh->facets[facet].neighbour[least];
        if (m[least] < slack && next != no_facet && step < longest_walk) {
          facet = next;
          continue;
        }
        beyond_rim = m[least] < slack;
        const auto sheet = patch.evaluate(place);
        return {sheet.z, sheet.dz_dx, sheet.dz_dy, abs(sheet.z)};
      }
    }
  };
};

}  // namespace sagitta::surface
