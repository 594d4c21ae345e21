// SPDX-License-Identifier: Apache-2.0
// What draws and writes pictures. The libraries for that (Cairo, OpenEXR, libpng, and a score that they bring along) take longer
// to load than a small system takes to read and trace; so they are a module, libsagitta_pictures.so, loaded when the first picture
// is made.
#pragma once

#include "lib/output/chart.h"
#include "lib/output/exr.h"
#include "lib/output/figure.h"
#include "lib/output/raster.h"

namespace sagitta::tools {

struct Pictures {
  decltype(&output::render) render;
  decltype(&output::preview_part) preview_part;
  decltype(&output::write_exr) write_exr;
  decltype(&output::write_png) write_png;
  decltype(&output::render_chart) render_chart;
  decltype(&output::chart_svg) chart_svg;
};

// Null where the module cannot be loaded; the first time with a message that names the command. A command that is going to make
// pictures asks before it traces, so that nobody waits for hours to be told.
const Pictures* pictures(const char* command);

}  // namespace sagitta::tools
