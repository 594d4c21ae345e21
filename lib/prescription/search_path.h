// SPDX-License-Identifier: Apache-2.0
// Where files named in a prescription are looked for, in this order: beside the prescription, in $SAGITTA_DATA, beside
// the executable (../share/sagitta), in the source tree of the build.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lib/prescription/diagnostics.h"

namespace sagitta::prescription {

// The folders, in order; `beside` is the folder of the file that names another.
std::vector<std::string> search_folders(const std::string& beside);

// The first of them that holds `name` (a relative path such as "systems/cornea.xyz" or "materials/N-BK7.yml"); an
// absolute `name` is taken as it is.
std::optional<std::string> find_file(const std::string& name, const std::string& beside);

// The same for a file that is named at `place`; an error there where it is in none of the folders.
std::optional<std::string> find_named_file(const std::string& name, const Place& place, Findings& findings);

}  // namespace sagitta::prescription
