// SPDX-License-Identifier: Apache-2.0
#include "lib/output/raster.h"

#include <libdeflate.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstring>
#include <limits>
#include <string_view>

#include "lib/output/color_map.h"
#include "lib/output/deflate.h"

namespace sagitta::output {
namespace {

// The bytes of a number, the highest first.
std::string big_endian(std::size_t number) {
  std::string bytes;
  for (const unsigned shift : {24U, 16U, 8U, 0U}) bytes.push_back(static_cast<char>(number >> shift & 0xFFU));
  return bytes;
}

std::string chunk(std::string_view type, std::string_view data) {
  const std::uint32_t checksum = libdeflate_crc32(libdeflate_crc32(0, type.data(), type.size()), data.data(), data.size());
  std::string bytes = big_endian(data.size());
  return bytes.append(type).append(data) + big_endian(checksum);
}

// The rows, each with a zero before it: as they are, not filtered. In a drawing pixels are like their neighbours or quite unlike;
// differences would only hide what repeats.
std::string packed(const Raster& raster) {
  constexpr std::size_t rows_of_block = 64;
  const std::size_t line_size = 3 * static_cast<std::size_t>(raster.width) + 1;
  ZlibStream stream(3, line_size);
  std::vector<std::uint8_t> lines((rows_of_block + 1) * line_size);  // the line above the block, then the block
  const auto row_count = static_cast<std::size_t>(raster.height);
  for (std::size_t first = 0; first < row_count; first += rows_of_block) {
    const std::size_t rows = std::min(rows_of_block, row_count - first);
    for (std::size_t row = 0; row < rows; ++row) {
      const std::uint32_t* pixel = raster.pixels.data() + (first + row) * static_cast<std::size_t>(raster.width);
      std::uint8_t* to = lines.data() + (row + 1) * line_size + 1;
      for (int i = 0; i < raster.width; ++i, ++pixel, to += 3)
        to[0] = static_cast<std::uint8_t>(*pixel >> 16U), to[1] = static_cast<std::uint8_t>(*pixel >> 8U), to[2] = static_cast<std::uint8_t>(*pixel);
    }
    if (first == 0)
      stream.add({lines.data() + line_size, rows * line_size});
    else
      stream.add({lines.data(), (rows + 1) * line_size}, line_size);
    std::memcpy(lines.data(), lines.data() + rows * line_size, line_size);
  }
  return stream.finish();
}

}  // namespace

WriteResult write_png(const std::string& path, const Raster& raster) {
  if (raster.width < 1 || raster.height < 1 ||
      raster.pixels.size() != static_cast<std::size_t>(raster.width) * static_cast<std::size_t>(raster.height))
    return {path + ": the picture is empty"};
  const std::string data = packed(raster);
  if (data.size() > std::numeric_limits<std::int32_t>::max()) return {path + ": the picture is too large for PNG"};
  constexpr char kind[] = {8, 2, 0, 0, 0};  // 8 bits, RGB; the only compression, the only filters, not interlaced
  const std::string size = big_endian(static_cast<std::size_t>(raster.width)) + big_endian(static_cast<std::size_t>(raster.height));
  return write_file(path, "\x89PNG\r\n\x1A\n" + chunk("IHDR", size + std::string(kind, sizeof kind)) + chunk("sRGB", std::string(1, '\0')) +
                              chunk("IDAT", data) + chunk("IEND", ""));
}

ExrPart preview_part(const Raster& raster) {
  std::array<float, 256> linear{};
  for (std::size_t i = 0; i < linear.size(); ++i)
    linear[i] = static_cast<float>(linear_from_srgb(static_cast<double>(i) / 255));

  ExrPart part{"preview", raster.width, raster.height, {}, {}};
  static_assert(std::endian::native == std::endian::little, "blue is a pixel's first byte");
  const std::span bytes(reinterpret_cast<const std::uint8_t*>(raster.pixels.data()), 4 * raster.pixels.size());
  for (std::size_t component = 0; component < 3; ++component)
    part.channels.push_back({std::string(1, "BGR"[component]), ExrBytes{bytes.subspan(std::min(component, bytes.size())), 4, linear}});
  return part;
}

}  // namespace sagitta::output
