// SPDX-License-Identifier: Apache-2.0
// The coefficients of the radial basis functions of surface/radial.h: one linear system a facet.
#pragma once

#include <vector>

#include "lib/scene/triangulate.h"
#include "lib/surface/radial.h"

namespace sagitta::scene {

struct RadialOptions {
  int rings = 2;        // of nodes around the facet's corners
  double shape_mm = 0;  // of the multiquadric; 0: the mean length of the mesh's edges in (x, y)
};

template <surface::RadialFunction function>
struct RadialFit {
  std::vector<typename surface::RadialPatches<function>::Patch> patches;  // one a facet
  std::vector<std::uint32_t> nodes;
  std::vector<double> weights;
  double shape_squared = 0;
  // Of each facet: a node lies on the rim or on a hole. Another facet's interpolant would have the same bits in a larger mesh
  // that has the same facets there, for the same shape.
  std::vector<char> reaches_rim;
};

// (1) and (2) of radial.h, solved by LU with full pivoting after scaling to the size of the neighbourhood. The system is
// singular to rounding where nodes stand much nearer to each other than the shape parameter of a multiquadric, as on a
// ring near the apex: there the smallest of all solutions is taken (complete orthogonal decomposition), which misses the
// nodes by rounding of the terms. With no nodes but the corners the facet stays flat.
template <surface::RadialFunction function>
RadialFit<function> fit_radial(const surface::Mesh& mesh, const RadialOptions& options);

double mean_edge_length(const surface::Mesh& mesh);

}  // namespace sagitta::scene
