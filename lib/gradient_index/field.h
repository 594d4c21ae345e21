// SPDX-License-Identifier: Apache-2.0
// What every form of a gradient-index medium answers: the refractive index n at a place and how it changes there. The contract:
//
//   struct G {
//     static constexpr std::string_view kind;               // the key of the prescription, e.g. "selfoc"
//     static constexpr std::array keys;                     // its keys (numerics/key.h); `index` is one of them
//     template <class P, class A> static G from(const P& parameters, A& arena);   // from checked parameters
//     double index;                                         // n where the form says; dispersion shifts it
//     template <class T> InMedium<T> at(const Vec3<T>& place) const;   // any numbers where there is no such medium
//     template <class T> T index_at(const Vec3<T>& place) const;       // n, without the root of n^2 where that is not needed
//   };
//
// Places are in mm in the local frame of the surface that the medium follows, from its vertex. T is a double in the tracer, a 50-digit
// type where its errors are measured, a Dual in the first order; parameters are taken as exact.
#pragma once

#include <cmath>

#include "lib/numerics/vec3.h"

namespace sagitta::gradient_index {

using numerics::Vec3;

template <class T>
struct InMedium {
  T squared_index;  // n^2
  Vec3<T> pull;     // n grad n = grad(n^2)/2, 1/mm: the acceleration of a ray (transfer.h)
};

// The distance from (0, 0, centre_z), squared, for the forms about a centre.
template <class T>
struct FromCentre {
  Vec3<T> offset;
  T squared;
};
template <class T>
FromCentre<T> from_centre(const Vec3<T>& place, double centre_z) {
  const Vec3<T> offset{place.x, place.y, place.z - T(centre_z)};
  return {offset, dot(offset, offset)};
}

}  // namespace sagitta::gradient_index
