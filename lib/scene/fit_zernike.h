// SPDX-License-Identifier: Apache-2.0
// From measured points to a surface of a base conic with Zernike terms, by least squares.
//
//   z(x, y) = conic(r; c, K) + sum_j C_j Z_j(x/R, y/R)                                                             (1)
//
// c, K  of the conic that fits the points best with its vertex free along z (scene/fit_conic.h)
// R     normalisation radius, mm: only points with hypot(x, y) <= R (and its rounding) are used
// C_j   coefficients, um
//
// The height of the conic's vertex goes into the piston term, so (1) stands at the points' own z. The terms are fitted to
// what the conic leaves: min_C sum_i (z_i - (1))^2 over the points, each counted once, holes not. Householder QR in
// blocks with scaled columns: memory does not grow with the points.
//
// The frame is the surface's local frame, that of the prescription and of PointCloud: x to the examiner's left, y up, z
// into the eye, the origin where the surface's vertex is placed.
//
// Condition number: largest over smallest singular value of the matrix of the terms at the points, columns scaled to length
// 1. 1 to 3 for points all over the circle. An error of the points can be enlarged so much in a single combination of
// coefficients, so beyond 1000 the terms count as not told apart, and the fit is refused with what is missing: points,
// rings, a sector, the middle, or else the terms are too many. Refused too are points that end before 0.8 R: the terms would
// be extrapolated.
//
// Source: numerics/zernike_basis.h for Z_j; G. Golub and C. Van Loan, Matrix Computations (4th ed., 2013), chapter 5, for
// QR and the scaling of columns.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "lib/numerics/zernike_basis.h"
#include "lib/prescription/model.h"
#include "lib/prescription/point_cloud.h"

namespace sagitta::scene {

struct ZernikeSurfaceRequest {
  int terms = 36;        // 1 to most_zernike_terms(indexing), from the indexing's first index on
  double radius_mm = 3;  // R
  numerics::ZernikeIndexing indexing = numerics::ZernikeIndexing::osa;
};

// 1326, all of order 50 (fringe: 37).
int most_zernike_terms(numerics::ZernikeIndexing indexing);

struct ZernikeSurface {
  double sphere_radius_mm = 0, sphere_vertex_mm = 0, sphere_rms_um = 0;  // best-fit sphere; a plane's radius is infinite
  double radius_mm = 0, conic_constant = 0;                              // of (1)
  bool conic_is_sphere = false;                                          // the points tell no conic constant from -100 to 100
  double vertex_mm = 0, conic_rms_um = 0;                                // of the conic alone, its vertex free along z
  double normalization_radius_mm = 0;
  numerics::ZernikeIndexing indexing = numerics::ZernikeIndexing::osa;
  std::vector<double> coefficients_um;  // from the indexing's first index on
  double rms_um = 0, peak_to_valley_um = 0;  // of the residual z - (1) over the points
  double condition_number = 0;
  std::size_t point_count = 0;      // points used
  prescription::PointCloud points;  // those within R, in the file's order; holes too
};

struct ZernikeSurfaceResult {
  std::optional<ZernikeSurface> surface;
  std::string reason, hint;  // why there is none, and what to do
};

ZernikeSurfaceResult fit_zernike_surface(const prescription::PointCloud& cloud, const ZernikeSurfaceRequest& request);

// The surface as a prescription has it: kind "zernike" with all its parameters.
prescription::Shape zernike_shape(const ZernikeSurface& surface);

}  // namespace sagitta::scene
