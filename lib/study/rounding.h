// SPDX-License-Identifier: Apache-2.0
// What rounding does to the answers of a system: every ray of a sample is traced in double, as `trace` does, and in 50 digits by
// the same templates, and the two are told apart surface by surface.
//
// E_k is the exact ray behind surface k, D_k that of the tracer, and X_k goes on exactly from D_k to the image:
//   error at k         D_k - E_k
//   own error of k     D_k - (one exact step from D_(k-1)):  what surface k itself has lost                         (1)
//   share of k         X_k - X_(k-1),   X_0 from the launched ray:  what that is worth in the image                 (2)
// The shares add up to the image's error, X_last - E_image: (2) is a telescope sum, and needs no derivative.
//
// Wavefronts: OPD by (3) of analysis/wavefront.h, for X_k and E with the chief ray's own X_k and E.
//
// The numbers of the compiled scene (indices, curvatures, frames, points, patches) are taken as exact: what is proven is rounding, not a
// formula. Dummies that the tracer passes by have no share.
//
// Digits lost: log10 of the worst own error of place or path, in units of 2^-52 times the scale, or of direction, in units of 2^-52; not below 0. The
// scale is the largest distance of a vertex from the next, or the entrance pupil's semi-diameter. Where digits are lost: the largest of some factors
// by which geometry enlarges rounding, at the ray that loses most,
//   near-grazing incidence 1/cos I;  near the critical angle 1/cos I';  steep surface sqrt(1 + |grad z|^2);  long distance |t|/scale;
//   strong curvature |c| scale;  ill-conditioned facet 1/sin(its smallest angle);
//   radial functions that cancel, sum of their sizes/scale;  edge of a facet, within rounding, where the slope jumps;  index ratio near 1, where nothing else is to blame.
//
// A ray in a gradient-index medium is exact to 1e-25 mm here; what the tracer's tolerance leaves of it is an error of its own, at the surface that ends the medium.
//
// Bounds: what rounding can do at most to one ray at one surface, from the counts of roundings and the geometry at that ray's own crossing
// (rounding_bound_internal.h: distances, cosines before and behind, curvatures, the sizes of the terms of the surface's equation). An own
// error beyond its bound is not the geometry's doing: it is a fault of the tracer, or of the bound. Where a gradient-index medium ends, it is an estimate: the tolerance of each step and
// its rounding, times what the ray's variations grow by from there (gradient_bound_internal.h).
//
// Source: the model of computation is Higham, Accuracy and Stability of Numerical Algorithms (2nd ed., 2002), chapter 1.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "lib/scene/scene.h"
#include "lib/surface/status.h"

namespace sagitta::study {

// Of sizes; 0 where there is none. What is no number is the worst there is.
class Spoiled {
 public:
  void add(double given) {
    const double size = given == given ? given : std::numeric_limits<double>::infinity();
    worst_ = size > worst_ ? size : worst_;
    squares_ += size * size;
    ++count_;
  }
  double worst() const { return worst_; }
  double rms() const { return count_ > 0 ? std::sqrt(squares_ / static_cast<double>(count_)) : 0; }
  std::int64_t count() const { return count_; }

 private:
  double worst_ = 0, squares_ = 0;
  std::int64_t count_ = 0;
};

struct SurfaceRounding {
  Spoiled position_mm, direction_rad, opl_mm;              // errors behind it, in its frame
  Spoiled own_position_mm, own_direction_rad, own_opl_mm;  // (1)
  Spoiled share_mm, share_waves;                           // (2), of the place in the image, of the OPD
  Spoiled bound_position_mm, bound_direction_rad, bound_opl_mm;  // of the own errors, ray by ray
  double of_bound = 0;                                     // worst own error in units of its own ray's bound
  bool is_estimate = false;                                // these bounds: a gradient-index medium begins or ends there
  std::int64_t without_bound = 0;                          // rays of which the analysis says nothing: the hit as a whole is uncertain
  double digits_lost = 0;
  std::string cause;                                       // "" where less than one digit is lost
};

// A ray that ends differently.
struct Disagreement {
  std::size_t field = 0, wavelength = 0;
  double pupil_x = 0, pupil_y = 0;
  surface::Status status = surface::Status::ok, exact_status = surface::Status::ok;
  int surface = 0, exact_surface = 0;  // that ended it; 0: none
  bool is_on_rim = false;              // of an aperture, within the tolerance of a position
};

struct FieldRounding {
  std::size_t field = 0, wavelength = 0;
  std::int64_t rays = 0, arrived = 0;
  Spoiled position_mm, opd_waves;  // in the image
  std::int64_t without_opd = 0;    // rays that arrive and miss the reference sphere, in double and exactly
  std::string no_wavefront;        // why there is no OPD
};

struct Rounding {
  double scale_mm = 0;
  std::vector<SurfaceRounding> surfaces;  // [0] is the launch, [k] surface k
  Spoiled opd_formula_waves;              // what (3)'s own rounding adds
  std::vector<FieldRounding> fields;      // field by field, its wavelengths in order
  std::vector<Disagreement> disagreements;
  std::int64_t rays = 0;
};

struct RoundingRequest {
  std::int64_t rays = 100;               // at least, per field and wavelength
  double position_tolerance_mm = 1e-9;   // for Disagreement::is_on_rim
  int thread_count = 0;                  // 0: as many as the machine runs; the same numbers for any
};
Rounding rounding_of(const scene::Scene& scene, const RoundingRequest& request);

}  // namespace sagitta::study
