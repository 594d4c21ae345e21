// SPDX-License-Identifier: Apache-2.0
#include "lib/output/raster.h"

#include <png.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>

#include "lib/output/color_map.h"

namespace sagitta::output {

WriteResult write_png(const std::string& path, const Raster& raster) {
  if (raster.width < 1 || raster.height < 1 ||
      raster.pixels.size() != static_cast<std::size_t>(raster.width) * static_cast<std::size_t>(raster.height))
    return {path + ": the picture is empty"};
  std::vector<std::uint8_t> components(3 * raster.pixels.size());
  std::uint8_t* to = components.data();
  for (const std::uint32_t pixel : raster.pixels)
    for (const unsigned shift : {16U, 8U, 0U}) *to++ = static_cast<std::uint8_t>(pixel >> shift);

  // "Fast" rows are not filtered. In a drawing pixels are like their neighbours or quite unlike; differences would only hide what repeats.
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(raster.width);
  image.height = static_cast<png_uint_32>(raster.height);
  image.format = PNG_FORMAT_RGB;
  image.flags = PNG_IMAGE_FLAG_FAST;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
  std::string file(size, '\0');
  if (!png_image_write_to_memory(&image, file.data(), &size, 0, components.data(), 0, nullptr)) return {path + ": " + image.message};
  file.resize(size);
  return write_file(path, file);
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
