// SPDX-License-Identifier: Apache-2.0
#include "lib/trace/beam.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "lib/trace/trace.h"

namespace sagitta::trace {

scene::Beam beam_of(RaySource source) {
  return [source = std::move(source)](const scene::Scene& so_far, int number) {
    scene::Scene open = so_far;
    for (scene::Surface& surface : open.surfaces) {
      surface.semi_diameter = std::numeric_limits<double>::infinity();
      surface.inner_semi_diameter = 0;
    }
    const auto& local_from_previous = open.surface(number).local_from_previous;
    std::vector<scene::Line> lines;
    source(open, [&](const LaunchedRays& launched) {
      RayBatch rays = launched.rays;
      for (int before = 1; before < number; ++before) trace_surface(open, open.wavelengths[launched.wavelength], before, rays);
      for (std::size_t i = 0; i < rays.size(); ++i)
        if (rays.ended[i] == 0) lines.push_back({local_from_previous * rays.position(i), local_from_previous.rotation * rays.direction(i)});
    });
    return lines;
  };
}

bool leaves_a_part(const std::vector<scene::CloudPart>& parts, const StatusCounts& rays) {
  return std::any_of(parts.begin(), parts.end(), [&](const scene::CloudPart& part) {
    return rays.endings.contains(ending(part.surface, surface::Status::outside_data));
  });
}

}  // namespace sagitta::trace
