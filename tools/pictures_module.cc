// SPDX-License-Identifier: Apache-2.0
// All that the program knows of the module.
#include "tools/pictures.h"

namespace out = sagitta::output;

extern "C" const sagitta::tools::Pictures sagitta_pictures{&out::render, &out::preview_part, &out::write_exr, &out::write_png,
                                                           &out::render_chart, &out::chart_svg};
