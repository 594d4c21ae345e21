// SPDX-License-Identifier: Apache-2.0
// A sheet of panels: maps with axes and colour bars, for a person to look at. Plain numbers and texts in, a picture out;
// what they mean is the caller's business.
//
// Every panel of a sheet has the same plot size (in pixels of the picture: 512 for a single panel, 384 for up to four
// in two columns, 256 otherwise), so three columns make a picture 1200 to 1300 pixels wide. Texts that are too long are
// wrapped or shrunk; nothing is cut off. A sheet holds at most 64 panels and 16 rows: with more rows it takes more
// columns, and the footer says how many panels are not shown.
//
// Values meet the picture's pixels like this: where the map is finer than the plot, a pixel shows the value of largest
// magnitude among those it covers (a lonely ray stays visible); where it is coarser, the nearest value.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lib/output/color_map.h"
#include "lib/output/raster.h"

namespace sagitta::output {

// Values row by row from the top (the largest y first). NaN: no data.
struct Map {
  int width = 0, height = 0;
  std::vector<float> values;  // width x height; otherwise, or without one finite value, the panel says `empty_note`
};

// Where the map lies on the two axes: the size of a map pixel and the middle of the map. In mm, or in `unit_mm = false`
// plain numbers (a unit pupil). A length axis whose middle is far from zero is labelled from that middle: "y − 2.3451 mm (µm)".
struct Axes {
  double pixel_width = 1, pixel_height = 1;
  double center_x = 0, center_y = 0;
  bool unit_mm = true;
  std::string x_label = "x", y_label = "y";
};

struct Range {
  double low = 0, high = 0;
};

// Drawn over the map, in the axes' units; the first of a panel solid, the others dashed. Labelled inside the plot.
struct Circle {
  double x = 0, y = 0, radius = 0;
  std::string label;
};

struct Panel {
  std::string title;
  std::vector<std::string> subtitle;  // lines
  Map map;
  Axes axes;
  ColorMap color_map = ColorMap::sequential;
  std::optional<Range> range;       // none: 0 (or the least positive value, if logarithmic) to the largest; +-largest if diverging
  bool log_scale = false;           // sequential maps of positive values
  bool zero_is_background = false;  // ray counts: a pixel without a ray stays white
  std::string quantity;             // the colour bar's label, "OPD"
  std::string unit;                 // and its unit, "waves"
  std::vector<Circle> circles;
  std::string empty_note = "no data";
};

struct Figure {
  std::string title;
  std::string footer;
  std::vector<Panel> panels;  // row by row
  int columns = 3;
};

// Empty only where there is no memory for it.
Raster render(const Figure& figure);

}  // namespace sagitta::output
