// SPDX-License-Identifier: Apache-2.0
// The Delaunay triangulation of points in (x, y), where the build has one, and the order of points in which it is made fast.
//
// Source: exact predicates and insertion by CGAL 5.5; the order is Morton's (IBM, 1966).
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "lib/numerics/vec3.h"
#include "lib/scene/rectangle.h"

namespace sagitta::scene {

// One facet of the whole triangulation: corners are indices of the points, anticlockwise; neighbour[i] is across the edge
// opposite to corner[i], surface::no_facet across the hull.
struct RawFacet {
  std::array<std::uint32_t, 3> corner, neighbour;
};

// The numbers of the points along Morton's curve over their bounding box (2^32 cells a side), on which what is near in
// (x, y) is mostly near; within a cell by x, then y, then number. So points at one place follow each other. Coordinates
// are finite.
std::vector<std::uint32_t> along_curve(const std::vector<numerics::Vec3<double>>& points);
// The same curve over `box`, and of the points those `within` a rectangle only: in the order that they have among all.
std::vector<std::uint32_t> along_curve(const std::vector<numerics::Vec3<double>>& points, const Rectangle& box, const Rectangle& within);

// The facets of points that are distinct in (x, y) and in the order of along_curve (in another it takes a time that grows
// with their square). None if all lie on a straight line. The facets are a function of the set of points: of those on a
// common circle, too, no order of insertion decides (ties are broken by the order of x, then y).
std::vector<RawFacet> delaunay(const std::vector<numerics::Vec3<double>>& points);

// What delaunay() is made with, such as "CGAL 5.5.1"; empty in a build without (SAGITTA_CGAL of CMakeLists.txt), where it finds
// no facet of any points. CMake links one of two files, and nothing else differs.
std::string_view triangulator();

}  // namespace sagitta::scene
