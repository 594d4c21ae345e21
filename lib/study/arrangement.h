// SPDX-License-Identifier: Apache-2.0
// Where the points of a cloud lie in (x, y): over the disc of a given radius about the origin, at a given density.
//
//   regular    a square grid of spacing h = density^(-1/2). It is moved by (sqrt 2 - 1, sqrt 3 - 1) h off the origin: neither a
//              point nor the middle of a cell or of its side lies on an axis or a diagonal of symmetry of the rays, and rays in
//              symmetric places meet different places of their cells
//   jittered   the same grid, each point moved uniformly within its own cell (side h about it)
//   random     density times area points, uniform over the disc (a Poisson process of a given number)
//   rings      a Placido device: rings at radius k/rings, k = 1 ... rings, without the apex, each with the same meridians, the
//              first on +x. Their numbers are given, or follow from the density with 7.5 meridians a ring (24 x 180)
//
// Symbols: mm, points per mm^2. The same places on every machine for a seed; regular and rings have no use for one. A density or
// radius that is not positive gives no places.
//
// Source: regular, jittered and random are the arrangements of the founding paper's section 3.A (Appl. Opt., 2009); the rings are
// those of its section 3.C.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace sagitta::study {

enum class ArrangementKind { regular, jittered, random, rings };
inline constexpr std::array<std::string_view, 4> arrangement_names{"regular", "jittered", "random", "rings"};
inline std::string_view name_of(ArrangementKind kind) { return arrangement_names[static_cast<std::size_t>(kind)]; }
std::optional<ArrangementKind> arrangement_named(std::string_view name);

struct Arrangement {
  ArrangementKind kind = ArrangementKind::regular;
  double points_per_mm2 = 0;
  int rings = 0, meridians = 0;  // of the kind rings, both or none: then they stand for the density
  bool operator==(const Arrangement&) const = default;
};

struct Site {
  double x, y;
};

// How far one point lies from the next, by the density: h; of rings the distance of one ring from the next over a disc of this radius.
double spacing_of(const Arrangement& arrangement, double radius);
std::vector<Site> sites_over_disc(const Arrangement& arrangement, double radius, std::uint64_t seed);

}  // namespace sagitta::study
