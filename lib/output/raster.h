// SPDX-License-Identifier: Apache-2.0
// A picture as a person sees it: encoded sRGB, 8 bits a component, the top row first. Written as PNG, and as the part
// that lets any EXR viewer show something.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lib/output/color_map.h"
#include "lib/output/atomic_file.h"
#include "lib/output/exr.h"

namespace sagitta::output {

struct Raster {
  int width = 0, height = 0;
  std::vector<std::uint32_t> pixels;  // row by row, 0xRRGGBB
};

inline std::uint32_t pixel_of(Rgb8 color) { return std::uint32_t{color[0]} << 16U | std::uint32_t{color[1]} << 8U | color[2]; }

// The same picture gives the same bytes: no time stamp. An empty picture is an error.
//
// Source: Portable Network Graphics (PNG) Specification, 2nd edition, ISO/IEC 15948:2003.
WriteResult write_png(const std::string& path, const Raster& raster);

// The part "preview": channels R, G, B in linear light, 0 to 1, which is what EXR viewers expect. It refers to the picture,
// which must outlive it.
ExrPart preview_part(const Raster& raster);

}  // namespace sagitta::output
