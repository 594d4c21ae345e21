// SPDX-License-Identifier: Apache-2.0
// The founding paper's own way to the facet that a ray meets, kept as a baseline of what not to do: the vertex nearest to the ray is
// looked for among all of them, and of the facets only those around it are tried.
//
//   |(v - p) x d|^2 least,   v a vertex, p + t d the ray                                                            (1)
//   inside a facet v0, v1, v2:  (v0 - p) + u e1 + v e2 = t d,   u >= 0, v >= 0, u + v <= 1                           (2)
//
// It is wrong in two ways. The facet that the ray meets need not be at its nearest vertex: on uniform random points 4.8 % of
// axial rays find none, more on scans with tilted rays. And its time is that of all vertices for every ray. (The tracer's own way,
// a grid and a walk, is in surface/facet_location.h.)
//
// Source: Appl. Opt. (2009), section 2.A and eq. (5), its inside test ("and") corrected to (2); the solution of (2) is that of Moller and
// Trumbore, J. Graphics Tools 2, 21 (1997).
#pragma once

#include <cstdint>
#include <vector>

#include "lib/surface/crossing.h"
#include "lib/surface/mesh.h"

namespace sagitta::study {

class NearestVertex {
 public:
  // The mesh's arrays are looked at, not kept.
  explicit NearestVertex(const surface::Mesh& mesh);

  // The facet that is found; surface::no_facet where none of those around the nearest vertex has the ray.
  std::uint32_t facet_of(const numerics::Vec3<double>& p, const numerics::Vec3<double>& d) const;
  // The crossing with it; outside_data where there is none.
  surface::Crossing<double> meet(const numerics::Vec3<double>& p, const numerics::Vec3<double>& d) const;

 private:
  struct Hit {
    std::uint32_t facet = surface::no_facet;
    double path = 0;
  };
  Hit find(const numerics::Vec3<double>& p, const numerics::Vec3<double>& d) const;

  const surface::Mesh* mesh_;
  std::vector<std::uint32_t> first_, around_;  // the facets around vertex v: around_[first_[v]] to around_[first_[v + 1] - 1]
};

}  // namespace sagitta::study
