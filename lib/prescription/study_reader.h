// SPDX-License-Identifier: Apache-2.0
// Reads a study file (YAML, version 1) and the prescription that it names: text -> variants multiplied out, with all findings in one run.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lib/prescription/diagnostics.h"
#include "lib/prescription/study_file.h"

namespace sagitta::prescription {

struct StudyReadResult {
  std::optional<StudyFile> study;  // present exactly when there is no error among the findings
  Findings findings;
};

// At most so many variants and printed figures in one file.
inline constexpr std::size_t most_variants = 10'000, most_figures = 200;

StudyReadResult read_study(const std::string& file);

// Where the root of a YAML file has a key, `sagitta_study` of a study or `sagitta` of a prescription; none where it has not, or is no YAML.
std::optional<Place> place_of_root_key(const std::string& file, std::string_view key);

// The file of a study: `name` itself where there is such a file, else systems/studies/NAME.yaml on the search path; none where there is neither.
std::optional<std::string> find_study(const std::string& name);
// Those names, in the folders of the search path, sorted.
std::vector<std::string> study_names();

}  // namespace sagitta::prescription
