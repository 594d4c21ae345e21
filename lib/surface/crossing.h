// SPDX-License-Identifier: Apache-2.0
// What every shape answers: its sag, the gradient of its sag, and where a ray meets it. The shapes' contract:
//
//   struct S {
//     static constexpr std::string_view kind;               // the key of the prescription, e.g. "conic"
//     static constexpr std::array keys;                     // its keys (numerics/key.h)
//     template <class P, class A> static S from(const P& parameters, A& arena);   // from checked parameters, or
//     static constexpr bool is_made_of_data = true;         // made by scene/compile from points
//     template <class T> T sag(T x, T y) const;             // mm; NaN outside the domain
//     template <class T> Gradient<T> gradient(T x, T y) const;
//     template <class T> Crossing<T> meet(Vec3<T> p, Vec3<T> d) const;
//     double vertex_curvature() const;                      // y-z second derivative of the sag at the local origin
//     double vertex_curvature_x() const;                    // x-z second derivative, where it may be another
//     std::string kernel() const;                           // its name in plans, where it is not `kind`
//     std::size_t data_bytes() const;                       // of the arrays it points to, where there are any
//   };
//
// T is double in the tracer, a 50-digit type in the rounding oracle. The parameters are doubles in both: they are
// taken as exact. Everything is in the surface's local frame, in mm. Shapes whose crossing has a closed form take several
// doubles as one T (numerics/lanes.h), and choose by select() there; one whose normals are unit vectors says so:
//
//     static constexpr bool has_unit_normals = true;
#pragma once

#include <limits>

#include "lib/numerics/lanes.h"
#include "lib/numerics/vec3.h"
#include "lib/surface/status.h"

namespace sagitta::surface {

using numerics::Vec3, numerics::negate_where, numerics::select;

// The gradient of the sag, (dz/dx, dz/dy).
template <class T>
struct Gradient {
  T x, y;
};

// The status of a crossing; of several in lanes, the status of each.
template <class T>
struct StatusIn {
  using Type = Status;
  static Status either(bool condition, Status yes, Status no) { return condition ? yes : no; }
  static T number(Status status) { return T(static_cast<int>(status)); }
};
template <class T>
  requires(requires(const double* from) { T::load(from); })
struct StatusIn<T> {
  struct Type {
    T numbers;
    friend auto operator==(const Type& a, Status b) { return a.numbers == StatusIn<double>::number(b); }
  };
  template <class Condition>
  static Type either(const Condition& condition, Status yes, Status no) {
    return {select<T>(condition, StatusIn<double>::number(yes), StatusIn<double>::number(no))};
  }
  static T number(const Type& status) { return status.numbers; }
};

// Where the line p + t d (|d| = 1) meets a surface.
template <class T>
struct Crossing {
  T path;           // t in mm, of either sign; NaN unless status is ok
  Vec3<T> point;    // p + t d, formed without the rounding of a long path; NaN likewise
  Vec3<T> normal;   // not normalised; its z component is positive (the side that light enters when it travels to +z is
                    // the side the normal does not point to)
  T along;          // d . normal, from the cheapest accurate source; its sign tells the side the ray comes from
  typename StatusIn<T>::Type status;
};

template <class T>
constexpr T not_a_number() {
  return std::numeric_limits<T>::quiet_NaN();
}

template <class T>
constexpr Crossing<T> no_crossing(Status status) {
  const T nan = not_a_number<T>();
  return {nan, {nan, nan, nan}, {nan, nan, nan}, nan, status};
}

}  // namespace sagitta::surface
