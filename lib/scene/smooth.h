// SPDX-License-Identifier: Apache-2.0
// Smooth heights near measured ones: of all surfaces that leave the points by no more than a given rms, the smoothest.
//
// With z_i the measured heights, s_i the smoothed ones, d = s - b the departure from the best-fit sphere b
// (cloud_fit.h), and d_xx, d_xy, d_yy its second derivatives,
//   minimise  sum_i (s_i - z_i)^2 + lambda * integral (d_xx^2 + 2 d_xy^2 + d_yy^2) dx dy,                          (1)
// lambda > 0 such that  sqrt(mean (s_i - z_i)^2) = rms:                                                            (2)
// the thin-plate smoothing spline with its parameter by the discrepancy principle. Heights in mm, lambda in mm^2.
//
// On the triangulation the second derivatives at a vertex are linear functionals of the departures there and around it: a
// quadratic through the vertex, by least squares over its topological rings, one ring, and more until they determine it
// (the smallest pivot of the scaled matrix, in the principal axes of those points, above 1e-3 of the largest). The integral is their sum over the vertices, each
// weighted by a third of its facets' area: d^T P d, P sparse. So (1) is the linear system
//   (1 + lambda P) d = z - b,                                                                                      (3)
// by sparse Cholesky decomposition. The rms (2) rises with lambda. One decomposition, at lambda0, tells the rms at every
// lambda not too far from it: with A = (1 + lambda0 P)^-1, y = z - b, k = lambda/lambda0,
//   sum (s_i - z_i)^2 = y^T g(A) y,   g(a) = (k (1 - a) / (a + k (1 - a)))^2,                                       (4)
// and Lanczos' method on A from y gives the nodes and weights of Gauss quadrature for that form. So lambda is found in a
// few decompositions, each at the lambda that the one before tells.
//
// As lambda grows (3) goes to the plane (in d) of least squares, one for every connected piece of the mesh: the smoothest
// there is. Where the rms asked for is more than that leaves, this limit is the answer. Pieces too small to have second
// derivatives stay as they are. Where a vertical line misses the sphere, b = 0.
//
// Only heights move; turning the points about z turns the result. Relative error of the rms (2): 1e-6, or as near as
// rounding lets it come where lambda is near its limit; the residuals given are those of the heights given.
//
// Source: C. H. Reinsch, Numer. Math. 10, 177 (1967); V. A. Morozov, Soviet Math. Dokl. 7, 414 (1966); G. Wahba, Spline
// Models for Observational Data, SIAM (1990), ch. 2.4, 4; (4): G. H. Golub and G. Meurant, Matrices, Moments and
// Quadrature with Applications, Princeton (2010), ch. 6, 15.
#pragma once

#include <optional>
#include <vector>

#include "lib/surface/mesh.h"

namespace sagitta::scene {

// What smoothing did to the points of a surface; mm.
struct Smoothing {
  double requested = 0;                       // the rms of (2)
  double residual_rms = 0, residual_max = 0;  // of s - z
  double lambda = 0;                          // mm^2; infinite at the limit
};

struct SmoothedHeights {
  std::vector<double> z;  // of every vertex, mm
  Smoothing effect;
};

// rms > 0 in mm. None where the numbers of the system (3) leave the range of doubles.
std::optional<SmoothedHeights> smooth(const surface::Mesh& mesh, double rms);

}  // namespace sagitta::scene
