// SPDX-License-Identifier: Apache-2.0
// What every command begins with: read the prescription and print what there is to say about it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lib/prescription/arithmetic.h"
#include "lib/prescription/model.h"
#include "lib/scene/compile.h"

namespace sagitta::tools {

// None, after printing every finding to standard error, where there is an error. With parameters, the name of the system tells their
// values, in whatever is made of it: "Arizona eye, accommodation_D = 4".
struct LoadedModel : std::optional<prescription::Model> {
  int status = 0;  // where there is none, the exit status: 2 where it has not a parameter that is set, which is wrong usage; else 1
};
LoadedModel load_model(const std::string& file, const prescription::Settings& settings = {});
std::optional<scene::CompileResult> load_scene(const prescription::Model& model, const scene::Beam& beam = {});

// Replaces the wavelengths of a model (its primary one stays); false, with a message that begins with "sagitta `who`: ",
// where a medium does not reach one of them.
bool set_wavelengths(prescription::Model& model, const std::vector<double>& wavelengths_nm, const std::string& who);

// Prints the findings to standard error, each once however often the program comes upon it; false where there is an error among them.
bool report(const prescription::Findings& findings);

}  // namespace sagitta::tools
