// SPDX-License-Identifier: Apache-2.0
// What `sagitta fit` says: a fitted Zernike surface as table, JSON, fragment of a prescription, EXR part and figure.
// Everything is in the surface's local frame, and says so.
#pragma once

#include <optional>
#include <string>

#include "lib/output/exr.h"
#include "lib/output/figure.h"
#include "lib/scene/fit_zernike.h"
#include "lib/scene/fit_zernike_map.h"

namespace sagitta::output {

struct FitReport {
  std::string file, version;  // of the points; of the program
  scene::ZernikeSurface surface;
  std::optional<scene::ResidualMap> map;  // none in a build without a triangulation
};

std::string fit_text(const FitReport& report);
std::string fit_json(const FitReport& report);

// The shape in YAML's flow style, 17 digits: `zernike: {...}` and a line end. It can be pasted into a surface of a
// prescription, be that written as {...} or as lines.
std::string fit_shape(const FitReport& report);
// The same as a file, with a head comment that tells where it comes from.
std::string fit_fragment(const FitReport& report);

// Of the map, which is there. The part `residual`, its channel Y in um: measured z minus fitted z, NaN where there is none.
ExrPart residual_part(const FitReport& report);
Figure residual_figure(const FitReport& report);

}  // namespace sagitta::output
