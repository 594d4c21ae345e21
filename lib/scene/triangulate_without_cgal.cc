// SPDX-License-Identifier: Apache-2.0
// In place of triangulate_cgal.cc, for a program that is free of the GPL.
#include "lib/scene/delaunay.h"

namespace sagitta::scene {

std::vector<RawFacet> delaunay(const std::vector<numerics::Vec3<double>>&) { return {}; }

std::string_view triangulator() { return {}; }

}  // namespace sagitta::scene
