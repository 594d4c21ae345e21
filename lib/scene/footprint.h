// SPDX-License-Identifier: Apache-2.0
// Where lines can meet a surface made of points, known before it is triangulated; and whether part of its facets is all that
// they need.
//
// The facets lie between the lowest and the highest of the points, so a line meets them only over the piece of it that lies
// between these heights; the footprint is the rectangle of (x, y) around all these pieces, and a margin.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "lib/scene/rectangle.h"
#include "lib/scene/scene.h"
#include "lib/surface/mesh.h"

namespace sagitta::scene {

struct Line {
  Vec3<double> point, direction;
};

// The lines of a job's rays in the frame of surface `number`, as they come to it; the surfaces before it are there. More
// lines than there will be rays do no harm; of many rays a sample serves that bounds them to within the margin.
using Beam = std::function<std::vector<Line>(const Scene& so_far, int number)>;

// A surface of whose points a part was triangulated.
struct CloudPart {
  int surface = 0;                   // its number
  std::size_t points = 0, used = 0;  // of the cloud; triangulated
};

struct Footprint {
  Rectangle places;
  Rectangle tangents;  // of the lines: dx/dz, dy/dz
};

// The margin is a share of the longer side. None where there is no line, or one is parallel to (x, y).
inline constexpr double footprint_margin = 1.0 / 32;
std::optional<Footprint> footprint_of(const std::vector<Line>& lines, double low_z, double high_z);

// True if the facets cover the whole footprint, and a facet's width around it for smooth patches that are met beside their
// flat facet, and if all lines of the footprint cross every facet there in the sense of its forward side: then each line meets
// these facets once, by whatever way they are searched, and no other facet of the cloud.
bool settles(const surface::Mesh& mesh, const Footprint& footprint);

}  // namespace sagitta::scene
