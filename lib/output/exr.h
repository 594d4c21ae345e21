// SPDX-License-Identifier: Apache-2.0
// OpenEXR images of several parts: 32-bit FLOAT and UINT channels, scan lines, ZIP compression (lossless; NaN and
// infinity keep their bits). The same parts give the same bytes, by any number of threads: no time stamp.
//
// Row 0 of a channel is the top row of the picture, and y grows downward, as in the file. So where a quantity has an
// axis that points up, row 0 holds its largest values.
//
// Every part has its own size, its data window (0, 0) - (width-1, height-1). The display window is the one of the first
// part in all parts: OpenEXR wants it shared.
//
// Refused, with a text that names the part: no part at all; two parts of one name; two channels or attributes of one
// name in a part, or attributes of the format itself ("compression"); names of more than 255 characters; a channel whose size
// is not width x height.
//
// Written by OpenEXR's library in C. Its chunks are packed here, by libdeflate: the library's own zlib would take most of the
// time of a whole trace's pictures.
//
// Source: Technical Introduction to OpenEXR and OpenEXR File Layout, openexr.com, version 3.1.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "lib/output/atomic_file.h"

namespace sagitta::output {

// One component of an 8-bit picture that lies elsewhere, and outlives this: pixel i is values[bytes[step i]].
struct ExrBytes {
  std::span<const std::uint8_t> bytes;  // from the first pixel's on
  std::size_t step = 1;
  std::array<float, 256> values{};

  std::size_t size() const { return (bytes.size() + step - 1) / step; }
};

// One plane of numbers, row by row from the top. The file holds a part's channels in the order of their names.
struct ExrChannel {
  std::string name;  // "Y", "wavefront.mask"
  std::variant<std::vector<float>, std::vector<std::uint32_t>, ExrBytes> pixels;
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

// The parts in the given order, written whole or not at all. thread_count 0: as many threads as the machine runs.
WriteResult write_exr(const std::string& path, std::span<const ExrPart> parts, int thread_count = 1);

}  // namespace sagitta::output
