// SPDX-License-Identifier: Apache-2.0
// Embree, the common library for rays and triangles, as a yardstick of the benchmarks: version 4 or 3, whichever the build
// has found, or none.
//
// It gets the facets of a mesh in single precision, its tree at the highest quality, without its robust mode; and rays that
// start 1 mm before ours, so that none starts behind the surface by rounding. They lie ready in Embree's own layout. All
// it has to do is to name for each ray the triangle, and where it is hit.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "lib/surface/mesh.h"
#include "lib/trace/ray_batch.h"

namespace sagitta::bench {

// "Embree 3.13.5"; empty where there is none.
std::string embree_version();

// The calls that it offers: the first takes one ray at a time, the others take coherent rays. None where it is absent.
std::vector<std::string> embree_calls();

class EmbreeRays {
 public:
  virtual ~EmbreeRays() = default;
  virtual void forget_hits() = 0;  // as before the first run
  virtual void run() = 0;          // only this is to be timed
  virtual std::int64_t hits() const = 0;
};
std::unique_ptr<EmbreeRays> embree_rays(const surface::Mesh& mesh, const trace::RayBatch& rays, const std::string& call);

}  // namespace sagitta::bench
