// SPDX-License-Identifier: Apache-2.0
// The plots of a study, and the orders that are fitted in them.
#pragma once

#include <string>
#include <vector>

#include "lib/output/chart.h"
#include "lib/study/order.h"
#include "tools/study_table.h"

namespace sagitta::tools {

// A law error = a h^order, h = density^(-1/2), of one series.
struct FittedOrder {
  std::string series, quantity;
  study::Order order;
};

struct StudyPlot {
  std::string file;  // without its ending: "error-density-angle"
  output::Chart chart;
  std::vector<FittedOrder> orders;
};

// Those for which there is something to draw.
std::vector<StudyPlot> plots_of(const prescription::StudyFile& study, const std::vector<StudyRow>& rows);

}  // namespace sagitta::tools
