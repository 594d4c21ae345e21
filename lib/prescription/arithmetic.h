// SPDX-License-Identifier: Apache-2.0
// The parameters of a system, and the values that are computed from them: `parameters: {accommodation_D: 0}` and
// `radius_mm: = 12.0 - 0.4 * accommodation_D`.
//
// Every scalar of the tree that begins with '=' is evaluated once, before the model is read; readers of numbers then take
// the result as if it stood there (value_reader.h), and readers of texts take the text. Parameters that nobody uses are
// errors where they are declared in the file itself or set from outside; one of a base may lose its use by what the file
// changes.
//
// Errors: a parameter that is no name or no finite number; more than 100 of them; a setting of one that is not declared.
#pragma once

#include <string>
#include <vector>

#include "lib/prescription/diagnostics.h"
#include "lib/prescription/expression.h"
#include "lib/prescription/yaml_tree.h"

namespace sagitta::prescription {

inline constexpr int most_parameters = 100;

// Values of parameters in place of those that the prescription declares.
using Settings = std::vector<ParameterValue>;

// Where a finding about a setting stands: on the command line.
Place place_of_setting(const std::string& name);

struct ComputedTree {
  YamlNode::Pointer root;
  std::vector<ParameterValue> parameters;  // in the order of their declaration
};

// `root` is a prescription with what it extends, `file` the one that was asked for.
ComputedTree with_arithmetic(const YamlNode::Pointer& root, const std::string& file, const Settings& settings, Findings& findings);

}  // namespace sagitta::prescription
