// SPDX-License-Identifier: Apache-2.0
// The data of the Clough-Tocher patches: gradients fitted to the points around each vertex.
//
// At a vertex V the cubic z_V + sum_{1<=a+b<=3} c_ab X^a Y^b, X = x - x_V, Y = y - y_V, is fitted by least squares to the
// points of its topological rings: two rings, and more until the points determine all 9 coefficients (cubic_fit.h). Its
// linear part is the gradient at V. The slope across an edge at its midpoint is the mean of what the cubics of its two ends
// say there. So the surface is exact for cubics; on smooth surfaces its sag is right to O(h^4) and its slope to O(h^3).
//
// Where points stand very near each other along a line (the innermost ring of a topographer), the rings are long and
// narrow: there all points within the longest edge count too.
//
// Where all points within reach do not determine a cubic a quadratic takes its place, then a plane: near lone facets, and
// where all points lie on few rings or lines.
#pragma once

#include <vector>

#include "lib/numerics/unset_array.h"
#include "lib/scene/triangulate.h"
#include "lib/surface/clough_tocher.h"

namespace sagitta::scene {

struct PatchFit {
  numerics::UnsetArray<surface::CloughTocherPatch> patches;  // one a facet
  // Of each vertex: a point that its cubic was fitted to, or the vertex itself, lies on the rim or on a hole. A patch with
  // no such corner would have the same bits in a larger mesh that has the same facets there.
  std::vector<char> reaches_rim;
};

// On `thread_count` threads (0: as many as the machine runs), with the same bits for any number.
PatchFit fit_patches(const surface::Mesh& mesh, int thread_count = 0);

}  // namespace sagitta::scene
