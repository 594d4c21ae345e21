// SPDX-License-Identifier: Apache-2.0
// OpenEXR images of several parts: 32-bit FLOAT and UINT channels, scan lines, ZIP compression (lossless; NaN and
// infinity keep their bits). The same parts give the same bytes: no time stamp, no threads.
//
// Row 0 of a channel is the top row of the picture, and y grows downward, as in the file. So where a quantity has an
// axis that points up, row 0 holds its largest values.
//
// Every part has its own size, its data window (0, 0) - (width-1, height-1). The display window is the one of the first
// part in all parts: OpenEXR wants it shared.
//
// Refused, with a text that names the part: no part at all; two parts of one name; two channels or attributes of one
// name in a part, or attributes that OpenEXR itself sets ("compression"); a channel whose size is not width x height.
//
// Source: Technical Introduction to OpenEXR and OpenEXR File Layout, openexr.com, version 3.1.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "lib/output/atomic_file.h"

namespace sagitta::output {

// One plane of numbers, row by row from the top. The file holds a part's channels in the order of their names.
struct ExrChannel {
  std::string name;  // "Y", "wavefront.mask"
  std::variant<std::vector<float>, std::vector<std::uint32_t>> pixels;
};

struct ExrAttribute {
  std::string name;
  std::variant<std::string, int, float, double, std::array<float, 2>, std::array<float, 3>, std::vector<std::string>>
      value;
};

struct ExrPart {
  std::string name;
  int width = 0, height = 0;
  std::vector<ExrChannel> channels;
  std::vector<ExrAttribute> attributes;
};

// The parts in the given order, written whole or not at all.
WriteResult write_exr(const std::string& path, std::span<const ExrPart> parts);

}  // namespace sagitta::output
