// SPDX-License-Identifier: Apache-2.0
// The closed list of shapes. A new shape is one file and one line here. Those with a `kind` and `keys` are named in
// prescriptions; the interpolations of points all come from the kind `delaunay` of Facets, and a sphere is a conic of K = 0.
#pragma once

#include <cstddef>
#include <string>
#include <type_traits>
#include <variant>

#include "lib/surface/asphere.h"
#include "lib/surface/biconic.h"
#include "lib/surface/conic.h"
#include "lib/surface/facets.h"
#include "lib/surface/grid.h"
#include "lib/surface/patches.h"
#include "lib/surface/plane.h"
#include "lib/surface/radial.h"
#include "lib/surface/sphere.h"
#include "lib/surface/toroid.h"
#include "lib/surface/xy_polynomial.h"
#include "lib/surface/zernike.h"

namespace sagitta::surface {

using Shape = std::variant<Plane, Sphere, Conic, Asphere, Biconic, Toroid, XyPolynomial, Zernike, BicubicGrid, Facets, Patches, RadialPatches<RadialFunction::cubic>,
                           RadialPatches<RadialFunction::thin_plate>, RadialPatches<RadialFunction::multiquadric>>;

// Shapes that are met in lanes, by a formula.
template <class S>
inline constexpr bool has_closed_form = std::is_same_v<S, Plane> || std::is_same_v<S, Sphere> || std::is_same_v<S, Conic>;
template <class S>
inline constexpr bool is_analytic = !requires { S::is_made_of_data; };
template <class S>
inline constexpr bool has_unit_normals = requires { S::has_unit_normals; };

// What the shape is called among those that are traced.
inline std::string kernel_name(const Shape& shape) {
  return std::visit([]<class S>(const S& of) -> std::string {
    if constexpr (requires { of.kernel(); }) return std::string(of.kernel());
    else return std::string(S::kind);
  }, shape);
}

// The bytes that the shape holds or points to; 0 where there is nothing to know of it.
inline std::size_t data_bytes(const Shape& shape) {
  return std::visit([]<class S>(const S& of) -> std::size_t {
    if constexpr (requires { of.data_bytes(); }) return of.data_bytes();
    else return std::is_empty_v<S> ? 0 : sizeof(S);
  }, shape);
}

// The x-z second derivative of the sag at the local origin.
inline double vertex_curvature_x(const Shape& shape) {
  return std::visit([]<class S>(const S& of) {
    if constexpr (requires { of.vertex_curvature_x(); }) return of.vertex_curvature_x();
    else return of.vertex_curvature();
  }, shape);
}

// The shape of fewest operations that is the same surface: what departs from a conic by nothing is that conic, a biconic of
// equal sections too, a conic of K = 0 a sphere, one of curvature 0 a plane.
inline Shape least_form(const Shape& shape) {
  if (const auto* zernike = std::get_if<Zernike>(&shape); zernike && zernike->size_at_any_place == 0) return least_form(zernike->base);
  if (const auto* asphere = std::get_if<Asphere>(&shape); asphere && asphere->order == 0) return least_form(asphere->base);
  if (const auto* xy = std::get_if<XyPolynomial>(&shape); xy && xy->polynomial.degree < 0) return least_form(xy->base);
  if (const auto* biconic = std::get_if<Biconic>(&shape); biconic && biconic->is_conic()) return least_form(Conic{biconic->y.curvature, biconic->y.conic_constant});
  if (const auto* toroid = std::get_if<Toroid>(&shape); toroid && toroid->is_sphere()) return least_form(Conic{toroid->section.curvature, 0});
  if (const auto* conic = std::get_if<Conic>(&shape)) {
    if (conic->curvature == 0) return Plane{};
    if (conic->conic_constant == 0) return Sphere{conic->curvature};
  }
  return shape;
}

// Calls visit with a default value of every shape that prescriptions name, in order: visit(Plane{}), visit(Conic{}), ...
template <class Visit, class... Shapes>
void for_each_kind(const std::variant<Shapes...>&, Visit&& visit) {
  const auto visit_named = [&]<class S>(S shape) {
    if constexpr (requires { S::kind; }) visit(shape);
  };
  (visit_named(Shapes{}), ...);
}
template <class Visit>
void for_each_shape_kind(Visit&& visit) {
  for_each_kind(Shape{}, visit);
}

}  // namespace sagitta::surface
