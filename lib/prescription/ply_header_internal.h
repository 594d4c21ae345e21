// SPDX-License-Identifier: Apache-2.0
// The header of a PLY file (Turk, The PLY Polygon File Format, Stanford 1994), as far as points need it:
//   ply / format ascii|binary_little_endian|binary_big_endian 1.0 / element NAME COUNT / property TYPE NAME / end_header
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <optional>
#include <vector>

#include "lib/prescription/cloud_formats_internal.h"

namespace sagitta::prescription {

enum class PlyType : std::uint8_t { integer8, integer16, integer32, float32, float64 };  // integers of either sign
std::size_t size_of(PlyType type);

struct PlyHeader {
  bool is_text = false;
  std::endian order = std::endian::native;
  std::uint64_t lines_before = 0, bytes_before = 0;  // of the elements between the header and the vertices
  std::uint64_t vertex_count = 0;
  bool has_elements_after = false;                   // behind the vertices; their parts may have any length
  std::vector<PlyType> properties;                   // of a vertex, in the order of the file
  std::array<std::size_t, 3> coordinate{};           // which of them are x, y, z: float32 or float64

  std::size_t offset(std::size_t property) const {  // in bytes, within a vertex; of the end for property = their count
    std::size_t sum = 0;
    for (std::size_t i = 0; i < property; ++i) sum += size_of(properties[i]);
    return sum;
  }
  std::size_t vertex_size() const { return offset(properties.size()); }
};

// Reads up to the end of the line end_header. None, with errors, where no points can be read behind it.
std::optional<PlyHeader> read_ply_header(LineReader& lines, CloudErrors& errors);

}  // namespace sagitta::prescription
