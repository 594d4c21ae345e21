// SPDX-License-Identifier: Apache-2.0
// Smooth surfaces fitted to points by least squares: for first order and for prediction, never for tracing.
#pragma once

#include <vector>

#include "lib/prescription/point_cloud.h"
#include "lib/surface/mesh.h"

namespace sagitta::scene {

// Some of the points, evenly through the list: up to 65536, enough to know where a cloud lies. No holes.
std::vector<numerics::Vec3<double>> sample_of(const std::vector<numerics::Vec3<double>>& points);

// The sphere (or plane) of surface/mesh.h (1), by linear least squares of its left side with the coefficient of q_z
// fixed: exact for points on a sphere or a plane. Relative to the centre, by the points of sample_of.
surface::BaseSphere fit_base_sphere(const std::vector<numerics::Vec3<double>>& points, const numerics::Vec3<double>& centre);

// Second derivatives of a sag at the local origin.
struct VertexCurvatures {
  double x, y;  // in the x-z section, in the y-z section
};

// Those of a quartic in (x, y), 15 terms, fitted to the points within half the
// beam's radius of the origin in (x, y), or the nearest 100 of them, whichever is more. Holes do not count.
// Where those points do not determine a quartic (all on one ring, say), twice as many are taken, and so on; where all
// do not, a quadratic (6 terms) takes its place; where they do not determine that either, the result is NaN.
VertexCurvatures vertex_curvatures(const prescription::PointCloud& cloud, double beam_radius);

}  // namespace sagitta::scene
