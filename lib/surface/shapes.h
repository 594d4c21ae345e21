// SPDX-License-Identifier: Apache-2.0
// The closed list of shapes. A new shape is one file and one line here.
#pragma once

#include <variant>

#include "lib/surface/conic.h"
#include "lib/surface/facets.h"
#include "lib/surface/plane.h"
#include "lib/surface/zernike.h"

namespace sagitta::surface {

using Shape = std::variant<Plane, Conic, Zernike, Facets>;

// Calls visit with a default value of every kind of shape, in order: visit(Plane{}), visit(Conic{}), ...
template <class Visit, class... Shapes>
void for_each_kind(const std::variant<Shapes...>&, Visit&& visit) {
  (visit(Shapes{}), ...);
}
template <class Visit>
void for_each_shape_kind(Visit&& visit) {
  for_each_kind(Shape{}, visit);
}

}  // namespace sagitta::surface
