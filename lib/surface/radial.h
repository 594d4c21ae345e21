// SPDX-License-Identifier: Apache-2.0
// The radial basis functions of the founding paper: on every facet an interpolant of its own, through the points of the
// facet and of the rings around it.
//
//   S(x, y) = a + b X + c Y + sum_j w_j phi(r_j),   X = x - x0, Y = y - y0,   r_j = |(x, y) - (x_j, y_j)|              (1)
//   sum w_j = sum w_j X_j = sum w_j Y_j = 0,   S(x_j, y_j) = z_j                                                     (2)
//   cubic phi = r^3,   thin plate phi = r^2 ln r,   multiquadric phi = sqrt(r^2 + shape^2)                             (3)
//
// The linear tail makes planes exact. Two facets have different points, so their interpolants differ along the common edge:
// the surface jumps there (0.05 to 1.4 um on a cornea at 7 points/mm), and tilted rays can meet both sheets or none. A ray
// takes the hit that lies on the facet of its interpolant; where it passes between two sheets, through the gap's wall, it
// takes that of the facet it came to last, which goes on beyond its edge by as much as the jump.
//
// With the three corners alone (rings: 0) the conditions (2) leave w = 0: flat facets.
//
// Source: the 2009 Applied Optics paper, eq. (7), with two rings of nodes; R. L. Hardy, J. Geophys. Res. 76, 1905 (1971);
// J. Duchon, Lect. Notes Math. 571, 85 (1977).
#pragma once

#include "lib/surface/departure.h"
#include "lib/surface/facets.h"

namespace sagitta::surface {

enum class RadialFunction { cubic, thin_plate, multiquadric };

template <RadialFunction function>
struct RadialPatches {
  static constexpr bool is_made_of_data = true;

  // One per facet: weights[first ...] of nodes[first ...], then the tail.
  struct Patch {
    std::uint32_t first, node_count;
    double x, y;      // (x0, y0)
    double a, b, c;   // of (1)
  };

  Facets facets;
  const Patch* patches = nullptr;
  const std::uint32_t* nodes = nullptr;  // vertices of the mesh
  const double* weights = nullptr;
  double shape_squared = 0;  // mm^2

  static constexpr std::string_view kernel() {
    return function == RadialFunction::cubic ? "cubic patches" : function == RadialFunction::thin_plate ? "thin-plate patches" : "multiquadric patches";
  }
  std::size_t data_bytes() const {
    const std::uint32_t count = facets.mesh->facet_count;
    const std::size_t node_count = count == 0 ? 0 : patches[count - 1].first + patches[count - 1].node_count;
    return facets.data_bytes() + count * sizeof *patches + node_count * (sizeof *nodes + sizeof *weights);
  }
  double vertex_curvature() const { return facets.vertex_curvature(); }

  // phi and (dphi/dr)/r as functions of r^2.
  template <class T>
  struct Value {
    T phi, slope_over_r;
  };
  template <class T>
  static Value<T> radial(const T& r2, const T& shape2) {
    using std::log;
    using std::sqrt;
    if constexpr (function == RadialFunction::cubic) {
      const T r = sqrt(r2);
      return {r2 * r, T(3) * r};
    } else if constexpr (function == RadialFunction::thin_plate) {
      if (r2 == T(0)) return {T(0), T(0)};  // the limits of r^2 ln r and of its gradient r (2 ln r + 1)
      const T ln = log(r2) / T(2);
      return {r2 * ln, T(2) * ln + T(1)};
    } else {
      const T root = sqrt(r2 + shape2);
      return {root, T(1) / root};
    }
  }

  // The interpolant of one facet, wherever (x, y) is.
  template <class T>
  Height<T> height_of(std::uint32_t facet, const T& x, const T& y) const {
    using std::abs;
    const Patch& patch = patches[facet];
    const T X = x - T(patch.x), Y = y - T(patch.y);
    T z = T(patch.a) + T(patch.b) * X + T(patch.c) * Y, z_x(patch.b), z_y(patch.c), size = abs(z);
    for (std::uint32_t k = patch.first; k < patch.first + patch.node_count; ++k) {
      const auto& node = facets.mesh->vertices[nodes[k]];
      const T dx = x - T(node.x), dy = y - T(node.y), w(weights[k]);
      const Value<T> value = radial<T>(dx * dx + dy * dy, T(shape_squared));
      z += w * value.phi;
      z_x += w * value.slope_over_r * dx;
      z_y += w * value.slope_over_r * dy;
      size += abs(w * value.phi);
    }
    return {z, z_x, z_y, size};
  }

  template <class T>
  T sag(const T& x, const T& y) const {
    const std::uint32_t facet = facets.facet_at(x, y);
    return facet == no_facet ? not_a_number<T>() : height_of(facet, x, y).z;
  }
  template <class T>
  Gradient<T> gradient(const T& x, const T& y) const {
    const std::uint32_t facet = facets.facet_at(x, y);
    if (facet == no_facet) return {not_a_number<T>(), not_a_number<T>()};
    const Height<T> h = height_of(facet, x, y);
    return {h.dz_dx, h.dz_dy};
  }

  template <class T>
  Crossing<T> meet(const Vec3<T>& p, const Vec3<T>& d) const {
    const auto flat = facets.find(p, d);
    if (flat.facet == no_facet) return no_crossing<T>(Status::outside_data);
    struct OneFacet {
      const RadialPatches& surface;
      std::uint32_t facet;
      Height<T> height(const T& x, const T& y) const { return surface.height_of(facet, x, y); }
    };
    constexpr int most_facets = 32;  // from the flat hit the smooth one is a fraction of a facet away
    std::uint32_t facet = flat.facet, before = no_facet;
    for (int step = 0; step < most_facets; ++step) {
      const Crossing<T> crossing = meet_from(flat.path, flat.point, !(d.z < T(0)), OneFacet{*this, facet}, d);
      if (crossing.status != Status::ok) return crossing;
      const std::uint32_t next = facets.next_toward(facet, crossing.point.x, crossing.point.y);
      if (next == facet || next == before) return crossing;  // on the facet, or in the gap between two
      if (next == no_facet) return no_crossing<T>(Status::outside_data);
      before = facet;
      facet = next;
    }
    return no_crossing<T>(Status::not_converged);
  }
};

}  // namespace sagitta::surface
