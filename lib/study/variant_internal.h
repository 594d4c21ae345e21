// SPDX-License-Identifier: Apache-2.0
// What compiling a system with other points takes, in every kind of study.
#pragma once

#include <string>
#include <vector>

#include "lib/prescription/diagnostics.h"

namespace sagitta::study {

// Of surfaces made of points, the default first.
std::vector<std::string> interpolations();

// Why a system was not compiled.
std::string first_error(const prescription::Findings& findings);

}  // namespace sagitta::study
