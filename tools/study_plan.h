// SPDX-License-Identifier: Apache-2.0
// What of a study is still to be measured, in which order, and how long it will take.
#pragma once

#include <optional>
#include <vector>

#include "tools/study_table.h"

namespace sagitta::tools {

struct PlannedVariant {
  StudyRow* row;
  study::Variant variant;
  int surface_number;
  std::size_t field;
  double seconds;  // about how long it will take, with its exact rays where the one before has others
};

// The subject of a variant; it stays while variants of the same surface and field come one after the other.
class CurrentSubject {
 public:
  explicit CurrentSubject(const prescription::StudyFile& study) : study_(&study) {}
  study::Subject& of(const PlannedVariant& planned);

 private:
  const prescription::StudyFile* study_;
  int surface_number_ = 0;
  std::size_t field_ = 0;
  std::optional<study::Subject> subject_;
};

// The rows that are not measured; those of the same surface, field, exact rays and rough points come one after the other. Measures a small variant of
// each kind, some tenths of a second, to know how long they will take (study/price.h). Variants of 0 threads get `thread_count`.
std::vector<PlannedVariant> plan_of(const prescription::StudyFile& study, std::vector<StudyRow>& rows, int thread_count);

}  // namespace sagitta::tools
