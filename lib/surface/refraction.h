// SPDX-License-Identifier: Apache-2.0
// Snell's law and reflection in vector form, for a normal n that need not be normalised.
//
//   d' = mu d + gamma n,    mu = index_before / index_after
//   gamma = s (1 - mu^2) / (w + mu |d.n|),   w = sqrt((1 - mu^2) |n|^2 + mu^2 (d.n)^2),   s = sign(d.n)          (1)
//
// w/|n| is the cosine of refraction: a negative radicand is total reflection and gives NaN. The textbook form
// gamma = (s w - mu d.n)/|n|^2 is (1) multiplied by its conjugate; (1) keeps its digits where the indices are nearly
// equal (1 - mu^2 -> 0) and costs one root and one division. 1 - mu^2 is formed as (n'-n)(n'+n)/n'^2.
// Where |n| = 1 the textbook form costs no division, and its loss, eps in gamma, is that of the sum mu d + gamma n itself.
//
//   reflection: d' = d - 2 (d.n)/|n|^2 n                                                                           (2)
//
// Errors: |d'| = 1 within 2 ulp if |d| = 1; the tangential component mu d - (...) within 2 ulp. The cosine of
// refraction has the error 4e-16 / cosine that the radicand's rounding forces near the critical angle.
//
// The conjugate and the Newton step for the length take a fifth of a step's time (tools/bench, stability_*). Without the conjugate an index ratio of
// 1 + 1e-12 leaves 4 digits of the deviation; without the step lengths drift by an ulp a surface, and paths with them.
//
// Source: Born and Wolf, Principles of Optics (7th ed. 1999), section 3.2.2; eq. (10) of the 2009 Applied Optics paper
// on Delaunay surfaces is the textbook form with misprints (v = n K.N, not K.N).
#pragma once

#include <cmath>

#include "lib/numerics/lanes.h"
#include "lib/numerics/vec3.h"

namespace sagitta::surface {

// The ratio of indices of one surface and wavelength, in the form that (1) needs.
template <class T>
struct IndexRatio {
  T mu;               // index_before / index_after
  T one_minus_mu_squared;

  static constexpr IndexRatio of(const T& index_before, const T& index_after) {
    return {index_before / index_after,
            (index_after - index_before) * (index_after + index_before) / (index_after * index_after)};
  }
};

// One step of Newton's iteration for 1/|d|: a direction within rounding of unit length comes within half an ulp or so, and
// errors of length, which would be errors of path, do not add up from surface to surface.
template <class T>
numerics::Vec3<T> with_unit_length(const numerics::Vec3<T>& d) {
  return (T(1.5) - T(0.5) * dot(d, d)) * d;
}

// `along` is d.n. NaN in every component: total reflection.
template <class T, bool has_unit_normal = false>
numerics::Vec3<T> refract(const numerics::Vec3<T>& d, const numerics::Vec3<T>& normal, const T& along,
                          const IndexRatio<T>& ratio) {
  using std::sqrt;
  const T mu = ratio.mu, q = ratio.one_minus_mu_squared;
  const T v = mu * along;
  const auto is_backward = along < T(0);
  T gamma;
  if constexpr (has_unit_normal) {
    const T w = sqrt(q + v * v);
    gamma = numerics::negate_where<T>(is_backward, w) - v;
  } else {
    const T w = sqrt(q * dot(normal, normal) + v * v);
    const T magnitude = q / (w + numerics::negate_where<T>(is_backward, v));  // (1)
    gamma = numerics::negate_where<T>(is_backward, magnitude);
  }
  return with_unit_length(mu * d + gamma * normal);
}

template <class T, bool has_unit_normal = false>
numerics::Vec3<T> reflect(const numerics::Vec3<T>& d, const numerics::Vec3<T>& normal, const T& along) {
  if constexpr (has_unit_normal) return with_unit_length(d - (T(2) * along) * normal);
  else return with_unit_length(d - (T(2) * along / dot(normal, normal)) * normal);  // (2)
}

}  // namespace sagitta::surface
