// SPDX-License-Identifier: Apache-2.0
// study.md, the page of a study that a person reads.
#pragma once

#include <string>
#include <vector>

#include "tools/study_charts.h"

namespace sagitta::tools {

// Of the rows that are measured; the plots are linked as PLOT.svg beside the page.
std::string study_page(const prescription::StudyFile& study, const std::vector<StudyRow>& rows, const std::vector<StudyPlot>& plots);

}  // namespace sagitta::tools
