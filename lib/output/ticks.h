// SPDX-License-Identifier: Apache-2.0
// Where an axis has its ticks, and in which unit.
#pragma once

#include <string>
#include <vector>

namespace sagitta::output {

struct Ticks {
  std::vector<double> values;  // ascending, inside the interval; each the double nearest to its decimal
  int decimals = 0;            // that show them exactly
};

// Multiples of the smallest step out of 1, 2, 5 times a power of ten, not below smallest_step, of which at most `most`
// lie in [low, high]. Needs finite low < high and most >= 2; otherwise there is none.
Ticks linear_ticks(double low, double high, int most, double smallest_step = 0);

// Of a logarithmic axis, 0 < low < high: powers of ten, thinned to every second, third ... until at most `most` are
// left; their doubles and fives too where there are less than two. Falls back to linear ticks within less than an octave.
Ticks log_ticks(double low, double high, int most);

// "−0.5": fixed, with a true minus sign (U+2212).
std::string tick_label(double value, int decimals);

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
