// SPDX-License-Identifier: Apache-2.0
// Reads a prescription (YAML, version 1), what it extends, and every file it names: text -> checked model, with all
// findings in one run.
#pragma once

#include <optional>
#include <string>

#include "lib/prescription/arithmetic.h"
#include "lib/prescription/diagnostics.h"
#include "lib/prescription/model.h"

namespace sagitta::prescription {

struct ReadResult {
  std::optional<Model> model;  // present exactly when there is no error among the findings
  Findings findings;
};

// Settings are of parameters that the prescription, or what it extends, declares.
ReadResult read_prescription(const std::string& file, const Settings& settings = {});

}  // namespace sagitta::prescription
