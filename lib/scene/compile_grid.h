// SPDX-License-Identifier: Apache-2.0
// Surfaces of heights on a regular grid: the nodes' slopes and twists, and the nodes that rays pass over but end nowhere near (surface/grid.h).
//
// Where the file has no slopes they are differences of the nearest five heights along x and along y, and the twist those of the slopes along
// x: exact for polynomials of degree 4, right to O(h^4) of smooth surfaces, so that the bicubic is as right as it would be with exact slopes.
// Beside rims and holes the five lie to one side; where fewer stand in a row, it is as many as there are.
//
// Nodes without data have the mean of what the heights and slopes of their known neighbours, up to eight, predict; and so on inward, or outward
// beyond a round aperture.
#pragma once

#include "lib/numerics/arena.h"
#include "lib/prescription/model.h"
#include "lib/surface/grid.h"

namespace sagitta::scene {

surface::BicubicGrid grid_surface(const prescription::SagGrid& given, const surface::Conic& base, numerics::Arena& arena);

// Of a shape that has a grid.
surface::BicubicGrid compile_grid(const prescription::Shape& given, numerics::Arena& arena);

}  // namespace sagitta::scene
