// SPDX-License-Identifier: Apache-2.0
// Shapes made of points: from the checked parameters and the cloud to the surface that is traced, of all points or of as
// many as a beam needs.
#pragma once

#include <memory>
#include <optional>

#include "lib/prescription/diagnostics.h"
#include "lib/prescription/model.h"
#include "lib/scene/footprint.h"
#include "lib/scene/smooth.h"

namespace sagitta::scene {

// Its vertex curvature follows when the beam is known (compile.cc).
struct CompiledCloud {
  surface::Shape shape;
  std::shared_ptr<const prescription::PointCloud> cloud;  // with the heights that are traced
  std::optional<Smoothing> smoothing;
};
CompiledCloud compile_cloud(const prescription::Shape& given, numerics::Arena& arena, prescription::Findings& findings);

// The facets under a shape made of points; null for other shapes.
surface::Facets* facets_of(surface::Shape& shape);

// Whether part of the points can be enough: not where heights are smoothed, or a number is a mean over the whole mesh.
bool may_be_a_part(const prescription::Shape& given);

// The surface around the footprint of some lines. Lines that lie in the footprint have the same bits as with all points;
// lines that leave it have them too, or end as outside_data. None where this cannot be shown, or half of the points would be
// wanted, or something is wrong with the points.
struct PartOfCloud {
  surface::Shape shape;
  std::size_t used = 0;  // places that were triangulated
};
std::optional<PartOfCloud> compile_part(const prescription::Shape& given, const std::vector<Line>& lines, numerics::Arena& arena,
                                        prescription::Findings& findings);

}  // namespace sagitta::scene
