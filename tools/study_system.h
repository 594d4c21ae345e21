// SPDX-License-Identifier: Apache-2.0
// A study of how the answers of a system settle (lib/study/sampling.h): what it is written as.
#pragma once

#include <string>
#include <vector>

#include "lib/output/chart.h"
#include "lib/output/records.h"
#include "lib/prescription/model.h"
#include "lib/study/advice.h"
#include "tools/commands.h"

namespace sagitta::tools {

// sagitta study --system SYSTEM.yaml -o DIR.
int study_system(const StudyOptions& options);

// True where the root of a file has the key of the other kind, `sagitta_study` of a study and `sagitta` of a system: then it says so, with the command that is meant.
bool is_of_the_other_kind(const std::string& file, const std::string& key, const std::string& what, const std::string& meant);

struct SystemStudy {
  const prescription::Model& model;
  const study::Sampling& sampling;
  std::vector<study::Curve> curves;
  std::vector<study::CloudChange> changes;
  std::vector<study::ToleranceChange> tolerances;
  std::vector<std::string> advice;  // and what has no answer
  std::string truth_note;
};

// "3 fields, 1 wavelength".
std::string fields_of(const prescription::Model& model);

// A row for every answer, setting, field and wavelength.
output::Records system_records(const SystemStudy& study);

struct SystemPlot {
  std::string file;  // without its ending: "spot-rays"
  output::Chart chart;
};
std::vector<SystemPlot> system_plots(const SystemStudy& study);

std::string system_page(const SystemStudy& study, const std::vector<SystemPlot>& plots);

}  // namespace sagitta::tools
