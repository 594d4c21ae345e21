// SPDX-License-Identifier: Apache-2.0
// The data of the Clough-Tocher patches: gradients fitted to the points around each vertex.
//
// At a vertex V the cubic z_V + sum_{1<=a+b<=3} c_ab X^a Y^b, X = x - x_V, Y = y - y_V, is fitted by least squares to the
// points of its topological rings: two rings, and more until the points determine all 9 coefficients (the smallest pivot of
// the scaled matrix is above 1e-3 of the largest). Its linear part is the gradient at V. The slope across an edge at its midpoint is the
// mean of what the cubics of its two ends say there. So the surface is exact for cubics; on smooth surfaces its sag is
// right to O(h^4) and its slope to O(h^3).
//
// Where all points within reach do not determine a cubic a quadratic takes its place, then a plane: near lone facets, and
// where all points lie on few rings or lines.
#pragma once

#include <vector>

#include "lib/scene/triangulate.h"
#include "lib/surface/clough_tocher.h"

namespace sagitta::scene {

// One patch for every facet of the mesh.
std::vector<surface::CloughTocherPatch> fit_patches(const surface::Mesh& mesh);

}  // namespace sagitta::scene
