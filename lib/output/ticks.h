// SPDX-License-Identifier: Apache-2.0
// Where an axis has its ticks, and in which unit.
#pragma once

#include <string>
#include <vector>

namespace sagitta::output {

struct Ticks {
  std::vector<double> values;       // ascending, inside the interval; each the double nearest to its label
  std::vector<std::string> labels;  // exact; with a true minus sign (U+2212)
};

// Multiples of the smallest step out of 1, 2, 5 times a power of ten, not below smallest_step, of which at most `most`
// lie in [low, high]. Needs most >= 2 and finite low < high, apart by 1e-290; otherwise there is none.
Ticks linear_ticks(double low, double high, int most, double smallest_step = 0);

// Of a logarithmic axis, 0 < low < high: 1, 2, 5 times the powers of ten; where these are more than `most` >= 2, the
// powers alone, then every second, third ... of them. Linear ticks where the interval holds less than two. Labels
// below 0.001 and from 100 000 on are powers: "2×10⁵".
Ticks log_ticks(double low, double high, int most);

// Of a chart's logarithmic axis of a decade at least, 10 low <= high: where it is shorter than 2.5 decades, 1, 2, 5 times the
// powers of ten, and the other multiples as minor ticks without a label; else the powers, their multiples being minor; where
// the powers are more than `most` >= 2, every second, third ... of them, those between being minor. The labels are of one kind:
// plain numbers where all of them are from 0.001 to below 100 000, and else powers, "10⁻⁹" or "2×10⁵".
struct ChartTicks {
  Ticks major;
  std::vector<double> minor;
};
ChartTicks chart_ticks(double low, double high, int most);

// mm, µm or nm, by the size of what is shown.
struct LengthUnit {
  double per_mm = 1;
  const char* name = "mm";
};
LengthUnit length_unit(double extent_mm);

// Values that need more than five places are shown as multiples of a power of ten: 3e-7 as 3 with the factor "10⁻⁷".
struct Magnitude {
  double factor = 1;
  std::string label;  // "×10⁻⁷ ", or "" where the factor is 1
};
Magnitude magnitude(double largest);

}  // namespace sagitta::output
