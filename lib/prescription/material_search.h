// SPDX-License-Identifier: Apache-2.0
// Finds media by name: in files of their own, and in glass catalogues.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lib/prescription/agf_reader.h"
#include "lib/prescription/diagnostics.h"
#include "lib/prescription/material_reader.h"

namespace sagitta::prescription {

// The first of: "air"; the file NAME.yml beside the file of `named_at`; the catalogues in their order; materials/NAME.yml in the search
// path. So what a prescription brings along or names counts, and not what happens to be shipped. Names are case-sensitive and hold
// no path. An unknown name is an error at `named_at` with the nearest known name as the hint; what is wrong inside a file is followed
// by a note "named here" at `named_at`. Where catalogues are given and another place has the name with an index that differs
// by more than 1e-6 in the range of both, a note says which counts.
std::optional<Material> find_material(const std::string& name, const Place& named_at, Findings& findings, std::span<const AgfCatalog> catalogs = {});

// The names of all media in the search path and the catalogues, in a fixed order, each once.
std::vector<std::string> known_materials(const std::string& beside, std::span<const AgfCatalog> catalogs = {});

}  // namespace sagitta::prescription
