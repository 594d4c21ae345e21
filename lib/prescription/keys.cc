// SPDX-License-Identifier: Apache-2.0
#include "lib/prescription/keys.h"

#include "lib/gradient_index/forms.h"
#include "lib/surface/shapes.h"

namespace sagitta::prescription {

const std::vector<ShapeKind>& shape_kinds() {
  static const std::vector<ShapeKind> kinds = [] {
    std::vector<ShapeKind> all;
    surface::for_each_shape_kind([&]<class Shape>(const Shape&) { all.push_back({Shape::kind, Shape::keys}); });
    return all;
  }();
  return kinds;
}

const std::vector<ShapeKind>& gradient_kinds() {
  static const std::vector<ShapeKind> kinds = [] {
    std::vector<ShapeKind> all;
    gradient_index::for_each_form([&]<class Form>(const Form&) { all.push_back({Form::kind, Form::keys}); });
    return all;
  }();
  return kinds;
}

}  // namespace sagitta::prescription
