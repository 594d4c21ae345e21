// SPDX-License-Identifier: Apache-2.0
// What a study file (YAML, `sagitta_study: 1`) says: a system, one of its surfaces, the variants of that surface to be measured, and the
// figures of a paper to stand beside them.
//
// A variant is its settings by key, as study_keys.h lists them: numbers and texts, every one with its value or its fallback, and those of
// `roughness` among them. `points_per_mm` has become `points_per_mm2`.
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lib/prescription/model.h"
#include "lib/prescription/parameters.h"

namespace sagitta::prescription {

// Printed of all variants that have these settings; of others there are none in `where`.
struct PublishedFigure {
  Parameters where;
  std::vector<std::pair<std::string, double>> values;  // by column of the study: "distance_mean_um"
  std::string note;
};

struct StudyFile {
  std::string file;
  std::string name, title, source;
  std::string about, notes;  // a paragraph a line
  Model system;
  int surface_number = 1;           // under study, and its field: those of variants that name no others
  std::size_t field = 0;
  std::vector<Parameters> variants;  // block by block; within one, keys in the order of study_keys.h, the last one fastest
  std::vector<PublishedFigure> paper;
};

// The number of the first surface of this name, from 1; none where no surface has it.
inline std::optional<int> surface_named(const Model& system, const std::string& name) {
  const auto found = std::find_if(system.surfaces.begin(), system.surfaces.end(), [&](const Surface& one) { return one.name == name; });
  if (found == system.surfaces.end()) return std::nullopt;
  return static_cast<int>(found - system.surfaces.begin()) + 1;
}

// Of a variant.
inline int surface_number_of(const StudyFile& study, const Parameters& variant) { return surface_named(study.system, variant.text("surface")).value_or(study.surface_number); }
inline std::size_t field_of(const Parameters& variant) { return static_cast<std::size_t>(variant.number("field")); }

inline bool has_settings(const Parameters& variant, const Parameters& where) {
  for (const auto& [key, value] : where.numbers)
    if (variant.number(key) != value) return false;
  for (const auto& [key, value] : where.texts)
    if (variant.text(key) != value) return false;
  return true;
}

}  // namespace sagitta::prescription
