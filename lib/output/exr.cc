// SPDX-License-Identifier: Apache-2.0
#include "lib/output/exr.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <map>
#include <new>
#include <set>
#include <stdexcept>

#include "lib/numerics/parallel.h"
#include "lib/output/deflate.h"

namespace sagitta::output {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers go into the file as they lie in memory");

constexpr int rows_of_chunk = 16;  // of ZIP compression
constexpr std::size_t longest_short_name = 31, longest_name = 255;

// Numbers one after another.
template <class... Number>
std::string bytes_of(Number... numbers) {
  std::string bytes;
  (bytes.append(reinterpret_cast<const char*>(&numbers), sizeof numbers), ...);
  return bytes;
}

// A type's name in the file, and the value.
struct Encoded {
  const char* type;
  std::string value;
};

Encoded encoded(const std::string& value) { return {"string", value}; }
Encoded encoded(int value) { return {"int", bytes_of(value)}; }
Encoded encoded(float value) { return {"float", bytes_of(value)}; }
Encoded encoded(double value) { return {"double", bytes_of(value)}; }
Encoded encoded(const std::array<float, 2>& value) { return {"v2f", bytes_of(value)}; }
Encoded encoded(const std::array<float, 3>& value) { return {"v3f", bytes_of(value)}; }
Encoded encoded(const std::vector<std::string>& values) {
  Encoded result{"stringvector", {}};
  for (const std::string& value : values) result.value += bytes_of(static_cast<std::int32_t>(value.size())) + value;
  return result;
}

std::size_t pixel_count(const ExrPart& part) { return static_cast<std::size_t>(part.width) * static_cast<std::size_t>(part.height); }

int chunk_count(const ExrPart& part) { return (part.height + rows_of_chunk - 1) / rows_of_chunk; }

std::vector<const ExrChannel*> channels_in_order(const ExrPart& part) {
  std::vector<const ExrChannel*> channels;
  for (const ExrChannel& channel : part.channels) channels.push_back(&channel);
  std::sort(channels.begin(), channels.end(), [](const ExrChannel* a, const ExrChannel* b) { return a->name < b->name; });
  return channels;
}

// What is wrong with the parts, or "". Attributes are checked where the header that they meet is made.
std::string fault(std::span<const ExrPart> parts) {
  if (parts.empty()) return "no part to write";
  std::set<std::string> part_names;
  for (const ExrPart& part : parts) {
    if (part.name.empty()) return "a part without a name";
    if (!part_names.insert(part.name).second) return fmt::format("two parts are named '{}'", part.name);
    if (part.width < 1 || part.height < 1)
      return fmt::format("part '{}': {} x {} pixels", part.name, part.width, part.height);
    if (part.channels.empty()) return fmt::format("part '{}': no channel", part.name);
    std::set<std::string> channel_names;
    for (const ExrChannel& channel : part.channels) {
      if (channel.name.empty()) return fmt::format("part '{}': a channel without a name", part.name);
      if (channel.name.size() > longest_name) return fmt::format("part '{}': a channel's name is too long", part.name);
      if (!channel_names.insert(channel.name).second)
        return fmt::format("part '{}': two channels are named '{}'", part.name, channel.name);
      const std::size_t count = std::visit([](const auto& pixels) { return pixels.size(); }, channel.pixels);
      if (count != pixel_count(part))
        return fmt::format("part '{}': channel '{}' holds {} pixels, not {} x {}", part.name, channel.name, count,
                           part.width, part.height);
    }
  }
  return {};
}

struct Header {
  std::string bytes;
  bool has_long_names = false;
};

// The attributes by name, those of the format among them. The display window is the one of `first`.
Header header(const ExrPart& part, const ExrPart& first) {
  constexpr std::int32_t zero = 0, one = 1, unsigned_pixels = 0, float_pixels = 2;
  constexpr char zip = 3, increasing_y = 0;
  Header result;
  std::string channels;
  for (const ExrChannel* channel : channels_in_order(part)) {
    const bool is_unsigned = std::holds_alternative<std::vector<std::uint32_t>>(channel->pixels);
    channels += channel->name + '\0' + bytes_of(is_unsigned ? unsigned_pixels : float_pixels, zero, one, one);  // not sampled
    result.has_long_names |= channel->name.size() > longest_short_name;
  }
  std::map<std::string, Encoded> attributes{{"channels", {"chlist", channels + '\0'}},
                                            {"chunkCount", encoded(chunk_count(part))},
                                            {"compression", {"compression", bytes_of(zip)}},
                                            {"dataWindow", {"box2i", bytes_of(zero, zero, part.width - 1, part.height - 1)}},
                                            {"displayWindow", {"box2i", bytes_of(zero, zero, first.width - 1, first.height - 1)}},
                                            {"lineOrder", {"lineOrder", bytes_of(increasing_y)}},
                                            {"name", encoded(part.name)},
                                            {"pixelAspectRatio", encoded(1.0F)},
                                            {"screenWindowCenter", encoded(std::array<float, 2>{})},
                                            {"screenWindowWidth", encoded(1.0F)},
                                            {"type", encoded(std::string("scanlineimage"))}};
  for (const ExrAttribute& attribute : part.attributes) {
    if (attribute.name.empty() || attribute.name.size() > longest_name)
      throw std::invalid_argument(fmt::format("part '{}': an attribute without a name, or with one that is too long", part.name));
    const auto value = std::visit([](const auto& plain) { return encoded(plain); }, attribute.value);
    if (!attributes.emplace(attribute.name, value).second)
      throw std::invalid_argument(fmt::format("part '{}': attribute '{}' is given twice or is OpenEXR's own", part.name, attribute.name));
    result.has_long_names |= attribute.name.size() > longest_short_name;
  }
  for (const auto& [name, attribute] : attributes)
    result.bytes += name + '\0' + attribute.type + '\0' + bytes_of(static_cast<std::int32_t>(attribute.value.size())) + attribute.value;
  result.bytes += '\0';
  return result;
}

// The first and third byte of a pixel, and the others.
struct Halves {
  std::uint16_t first, second;
};
Halves halves(std::uint32_t pixel) {
  const auto even_bytes = [](std::uint32_t four) { return static_cast<std::uint16_t>((four & 0xFFU) | (four >> 8U & 0xFF00U)); };
  return {even_bytes(pixel), even_bytes(pixel >> 8U)};
}

// The pixels' halves, as a function of the pixel's number.
template <class Number>
auto halves_of(const std::vector<Number>& pixels) {
  return [data = pixels.data()](std::size_t i) { return halves(std::bit_cast<std::uint32_t>(data[i])); };
}
auto halves_of(const ExrBytes& pixels) {
  std::array<Halves, 256> of_byte{};
  for (std::size_t i = 0; i < of_byte.size(); ++i) of_byte[i] = halves(std::bit_cast<std::uint32_t>(pixels.values[i]));
  return [of_byte, data = pixels.bytes.data(), step = pixels.step](std::size_t i) { return of_byte[data[i * step]]; };
}

// Packs chunks of rows, in memory that it keeps from one to the next.
class ChunkPacker {
 public:
  // The chunk as it stands in the file.
  std::string pack(const ExrPart& part, int part_number, int first_row) {
    const int rows = std::min(rows_of_chunk, part.height - first_row);
    const std::size_t width = static_cast<std::size_t>(part.width);
    // All first halves, all second ones; then each byte is replaced by its difference from the one before.
    const std::size_t half = width * static_cast<std::size_t>(rows) * part.channels.size();
    split_.resize(2 * half);
    differences_.resize(4 * half);
    std::size_t channel_start = 0;
    for (const ExrChannel* channel : channels_in_order(part)) {
      std::visit(
          [&](const auto& pixels) {
            const auto halves_of_pixel = halves_of(pixels);
            for (int row = 0; row < rows; ++row) {
              const std::size_t from = static_cast<std::size_t>(first_row + row) * width;
              std::uint16_t* first = split_.data() + channel_start + static_cast<std::size_t>(row) * width * part.channels.size();
              for (std::size_t i = 0; i < width; ++i) {
                const Halves pixel = halves_of_pixel(from + i);
                first[i] = pixel.first;
                first[half + i] = pixel.second;
              }
            }
          },
          channel->pixels);
      channel_start += width;
    }
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(split_.data());
    std::uint8_t* const differences = differences_.data();
    differences[0] = bytes[0];
    for (std::size_t i = 1; i < 4 * half; ++i) differences[i] = static_cast<std::uint8_t>(bytes[i] - bytes[i - 1] + 128);

    // A pixel to the left is two bytes back, the row above one row of all channels.
    ZlibStream stream(2, 2 * width * part.channels.size());
    stream.add(differences_);
    std::string packed = stream.finish();
    if (packed.size() >= 4 * half) packed = unpacked(half);
    return bytes_of(part_number, first_row, static_cast<std::int32_t>(packed.size())) + packed;
  }

 private:
  // The chunk's pixels as they are, for a chunk that packing would not make smaller.
  std::string unpacked(std::size_t half) const {
    std::string bytes;
    for (std::size_t i = 0; i < half; ++i) {
      const unsigned even = split_[i], odd = split_[half + i];
      bytes += bytes_of(static_cast<std::uint32_t>((even & 0xFFU) | (odd & 0xFFU) << 8U | (even >> 8U) << 16U | (odd >> 8U) << 24U));
    }
    return bytes;
  }

  std::vector<std::uint16_t> split_;
  std::vector<std::uint8_t> differences_;
};

std::string encode(std::span<const ExrPart> parts, int thread_count) {
  constexpr std::int32_t magic = 20000630, version = 2, long_names = 0x400, multi_part = 0x1000;
  std::string headers;
  bool has_long_names = false;
  struct Place {
    int part, first_row;
  };
  std::vector<Place> places;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const Header made = header(parts[i], parts[0]);
    headers += made.bytes;
    has_long_names |= made.has_long_names;
    for (int row = 0; row < parts[i].height; row += rows_of_chunk) places.push_back({static_cast<int>(i), row});
  }
  headers += '\0';

  std::vector<std::string> chunks(places.size());
  numerics::share_blocks(places.size(), thread_count, [&] {
    return [&, packer = ChunkPacker()](std::size_t i) mutable {
      chunks[i] = packer.pack(parts[static_cast<std::size_t>(places[i].part)], places[i].part, places[i].first_row);
    };
  });

  std::string file = bytes_of(magic, version | multi_part | (has_long_names ? long_names : 0)) + headers;
  std::uint64_t offset = file.size() + sizeof offset * chunks.size();
  for (const std::string& chunk : chunks) {
    file += bytes_of(offset);
    offset += chunk.size();
  }
  file.reserve(offset);
  for (const std::string& chunk : chunks) file += chunk;
  return file;
}

}  // namespace

WriteResult write_exr(const std::string& path, std::span<const ExrPart> parts, int thread_count) {
  if (std::string what = fault(parts); !what.empty()) return {path + ": " + what};
  try {
    return write_file(path, encode(parts, thread_count));
  } catch (const std::invalid_argument& wrong) {
    return {path + ": " + wrong.what()};
  } catch (const std::bad_alloc&) {
    return {path + ": not enough memory"};
  }
}

}  // namespace sagitta::output
