// SPDX-License-Identifier: Apache-2.0
// The plane z = 0. A line parallel to it misses. t = -z / N: one division, no root.
#pragma once

#include <array>

#include "lib/numerics/key.h"
#include "lib/surface/crossing.h"

namespace sagitta::surface {

struct Plane {
  static constexpr bool has_unit_normals = true;
  static constexpr std::string_view kind = "plane";
  static constexpr std::array<numerics::Key, 0> keys{};

  template <class Parameters, class Arena>
  static Plane from(const Parameters&, Arena&) {
    return {};
  }

  double vertex_curvature() const { return 0; }

  template <class T>
  T sag(const T&, const T&) const {
    return T(0);
  }
  template <class T>
  Gradient<T> gradient(const T&, const T&) const {
    return {T(0), T(0)};
  }
  template <class T>
  Crossing<T> meet(const Vec3<T>& p, const Vec3<T>& d) const {
    const T t = -p.z / d.z;
    const auto hit = t - t == T(0);  // neither NaN nor infinite
    return {select<T>(hit, t, not_a_number<T>()), {p.x + t * d.x, p.y + t * d.y, T(0)}, {T(0), T(0), T(1)}, d.z,
            StatusIn<T>::either(hit, Status::ok, Status::missed)};
  }
};

}  // namespace sagitta::surface
