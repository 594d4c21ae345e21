// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "lib/prescription/diagnostics.h"
#include "lib/prescription/medium_reader.h"
#include "lib/prescription/model.h"
#include "lib/prescription/yaml_tree.h"

namespace sagitta::prescription {

// The list `surfaces`, with the rules that hold between its surfaces: at least two, exactly one stop, a thickness on
// all but the last.
std::vector<Surface> read_surfaces(const YamlNode& list, MediumReader& media, Findings& findings);

}  // namespace sagitta::prescription
