// SPDX-License-Identifier: Apache-2.0
// Reads one medium from a file in refractiveindex.info's YAML format, and finds media by name in materials/.
#pragma once

#include <optional>
#include <string>

#include "lib/medium/medium.h"
#include "lib/prescription/diagnostics.h"

namespace sagitta::prescription {

// The medium in `file`, named after the file. Findings are about that file.
std::optional<medium::Medium> read_material(const std::string& file, Findings& findings);

// "air", or the file materials/NAME.yml in the search path. An unknown name is an error at `named_at` with the nearest
// known name as the hint; errors inside the file are followed by a note "named here" at `named_at`.
std::optional<medium::Medium> find_material(const std::string& name, const Place& named_at, Findings& findings);

}  // namespace sagitta::prescription
