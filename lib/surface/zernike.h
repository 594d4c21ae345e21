// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "lib/numerics/key.h"
#include "lib/surface/conic.h"

namespace sagitta::surface {

struct Zernike {
  static constexpr std::string_view kind = "zernike";
  static constexpr std::array keys{
      numerics::Key{.name = "radius_mm", .meaning = "vertex radius of the base conic",
                    .range = numerics::nonzero_or_infinite, .fallback = std::numeric_limits<double>::infinity()},
      numerics::Key{.name = "conic_constant", .meaning = "K of the base conic: 0 sphere, -1 paraboloid"},
      numerics::Key{.name = "normalization_radius_mm", .meaning = "radius at which rho = 1", .required = true,
                    .range = numerics::positive},
      numerics::Key{.name = "indexing", .kind = numerics::ValueKind::text, .meaning = "order and normalisation of the terms",
                    .required = true, .choices = "osa|noll|fringe"},
      numerics::Key{.name = "coefficients_um", .kind = numerics::ValueKind::indexed,
                    .meaning = "coefficient of each term: {index: value} or a list from the first", .required = true}};
};

}  // namespace sagitta::surface
