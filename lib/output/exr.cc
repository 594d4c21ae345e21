// SPDX-License-Identifier: Apache-2.0
#include "lib/output/exr.h"

#include <OpenEXR/openexr.h>
#include <fmt/format.h>
#include <libdeflate.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <memory>
#include <new>
#include <set>
#include <stdexcept>

#include "lib/numerics/parallel.h"

namespace sagitta::output {
namespace {

static_assert(std::endian::native == std::endian::little, "pixels go into the file as they lie in memory");

constexpr int rows_of_chunk = 16;  // of ZIP compression
constexpr int packing_level = 4;   // of libdeflate: hardly slower than its fastest, 2, and of 8 % fewer bytes
constexpr std::size_t longest_short_name = 31, longest_name = 255;

std::size_t pixel_count(const ExrPart& part) { return static_cast<std::size_t>(part.width) * static_cast<std::size_t>(part.height); }

std::vector<const ExrChannel*> channels_in_order(const ExrPart& part) {
  std::vector<const ExrChannel*> channels;
  for (const ExrChannel& channel : part.channels) channels.push_back(&channel);
  std::sort(channels.begin(), channels.end(), [](const ExrChannel* a, const ExrChannel* b) { return a->name < b->name; });
  return channels;
}

// What is wrong with the parts, or "". Attributes are checked where they meet those of the format.
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

// Pixels from number `from` on, as they lie in the file.
template <class Number>
void copy_row(const std::vector<Number>& pixels, std::size_t from, std::span<std::uint32_t> row) {
  std::memcpy(row.data(), pixels.data() + from, row.size_bytes());
}
void copy_row(const ExrBytes& pixels, std::size_t from, std::span<std::uint32_t> row) {
  for (std::size_t i = 0; i < row.size(); ++i) row[i] = std::bit_cast<std::uint32_t>(pixels.values[pixels.bytes[(from + i) * pixels.step]]);
}

// Packs chunks of rows, in memory that it keeps from one to the next.
class ChunkPacker {
 public:
  // The chunk's pixels by ZIP where that makes them smaller, otherwise as they are: readers tell it by the size.
  std::string pack(const ExrPart& part, int first_row) {
    const std::size_t width = static_cast<std::size_t>(part.width);
    plain_.resize(width * part.channels.size() * static_cast<std::size_t>(std::min(rows_of_chunk, part.height - first_row)));
    std::span<std::uint32_t> left(plain_);
    const std::vector<const ExrChannel*> channels = channels_in_order(part);
    for (std::size_t from = static_cast<std::size_t>(first_row) * width; !left.empty(); from += width)
      for (const ExrChannel* channel : channels) {
        std::visit([&](const auto& pixels) { copy_row(pixels, from, left.first(width)); }, channel->pixels);
        left = left.subspan(width);
      }

    // The bytes of even places, then those of odd ones, each less the one before it, plus 128 (OpenEXR File Layout, ZIP).
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(plain_.data());
    const std::size_t size = 4 * plain_.size(), half = size / 2;
    differences_.resize(size);
    std::uint8_t* const even = differences_.data();
    std::uint8_t* const odd = even + half;
    even[0] = bytes[0];
    odd[0] = static_cast<std::uint8_t>(bytes[1] - bytes[size - 2] + 128);
    for (std::size_t i = 1; i < half; ++i) {
      even[i] = static_cast<std::uint8_t>(bytes[2 * i] - bytes[2 * i - 2] + 128);
      odd[i] = static_cast<std::uint8_t>(bytes[2 * i + 1] - bytes[2 * i - 1] + 128);
    }

    packed_.resize(size - 1);
    const std::size_t packed_size = libdeflate_zlib_compress(compressor_.get(), even, size, packed_.data(), packed_.size());
    return packed_size > 0 ? packed_.substr(0, packed_size) : std::string(reinterpret_cast<const char*>(bytes), size);
  }

 private:
  static libdeflate_compressor* new_compressor() {
    libdeflate_compressor* const made = libdeflate_alloc_compressor(packing_level);
    return made ? made : throw std::bad_alloc();
  }

  std::unique_ptr<libdeflate_compressor, decltype(&libdeflate_free_compressor)> compressor_{new_compressor(), &libdeflate_free_compressor};
  std::vector<std::uint32_t> plain_;
  std::vector<std::uint8_t> differences_;
  std::string packed_;
};

// OpenEXR's context, which writes into a string. What the library refuses is an exception with its text.
class Writer {
 public:
  Writer() {
    exr_context_initializer_t settings = EXR_DEFAULT_CONTEXT_INITIALIZER;
    settings.error_handler_fn = [](exr_const_context_t, exr_result_t, const char*) {};  // otherwise it prints
    settings.user_data = &file_;
    settings.write_fn = [](exr_const_context_t, void* file, const void* bytes, std::uint64_t size, std::uint64_t offset, exr_stream_error_func_ptr_t) {
      return put(*static_cast<std::string*>(file), bytes, size, offset);
    };
    check(exr_start_write(&context_, "in memory", EXR_WRITE_FILE_DIRECTLY, &settings));
  }
  ~Writer() { exr_finish(&context_); }
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;

  operator exr_context_t() const { return context_; }

  static void check(exr_result_t result) {
    if (result == EXR_ERR_OUT_OF_MEMORY) throw std::bad_alloc();
    if (result != EXR_ERR_SUCCESS) throw std::invalid_argument(fmt::format("OpenEXR: {}", exr_get_default_error_message(result)));
  }

  std::string take_file() { return std::move(file_); }

 private:
  // No exception passes through the library, which is C.
  static std::int64_t put(std::string& file, const void* bytes, std::uint64_t size, std::uint64_t offset) try {
    if (file.size() < offset + size) file.resize(offset + size);
    std::memcpy(file.data() + offset, bytes, size);
    return static_cast<std::int64_t>(size);
  } catch (const std::bad_alloc&) {
    return -1;
  }

  exr_context_t context_ = nullptr;
  std::string file_;
};

// Where an attribute goes: calls the library's function for its type.
struct AttributeSetter {
  exr_context_t context;
  int part;
  const char* name;

  exr_result_t operator()(const std::string& value) const { return exr_attr_set_string(context, part, name, value.c_str()); }
  exr_result_t operator()(int value) const { return exr_attr_set_int(context, part, name, value); }
  exr_result_t operator()(float value) const { return exr_attr_set_float(context, part, name, value); }
  exr_result_t operator()(double value) const { return exr_attr_set_double(context, part, name, value); }
  exr_result_t operator()(const std::array<float, 2>& value) const {
    const exr_attr_v2f_t vector{{{value[0], value[1]}}};
    return exr_attr_set_v2f(context, part, name, &vector);
  }
  exr_result_t operator()(const std::array<float, 3>& value) const {
    const exr_attr_v3f_t vector{{{value[0], value[1], value[2]}}};
    return exr_attr_set_v3f(context, part, name, &vector);
  }
  exr_result_t operator()(const std::vector<std::string>& values) const {
    std::vector<const char*> texts;
    for (const std::string& value : values) texts.push_back(value.c_str());
    texts.push_back(nullptr);  // not one of them: for none, too, the library wants a place
    return exr_attr_set_string_vector(context, part, name, static_cast<std::int32_t>(values.size()), texts.data());
  }
};

// The part's header, with the display window of `first`.
void add_part(const Writer& writer, const ExrPart& part, const ExrPart& first) {
  const auto window = [](const ExrPart& shown) { return exr_attr_box2i_t{{{{0, 0}}}, {{{shown.width - 1, shown.height - 1}}}}; };
  const exr_attr_box2i_t display_window = window(first), data_window = window(part);
  const exr_attr_v2f_t middle{};
  int number = 0;
  Writer::check(exr_add_part(writer, part.name.c_str(), EXR_STORAGE_SCANLINE, &number));
  Writer::check(exr_initialize_required_attr(writer, number, &display_window, &data_window, 1, &middle, 1, EXR_LINEORDER_INCREASING_Y, EXR_COMPRESSION_ZIP));
  for (const ExrChannel& channel : part.channels) {
    const bool is_unsigned = std::holds_alternative<std::vector<std::uint32_t>>(channel.pixels);
    Writer::check(exr_add_channel(writer, number, channel.name.c_str(), is_unsigned ? EXR_PIXEL_UINT : EXR_PIXEL_FLOAT, EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1));
  }
  for (const ExrAttribute& attribute : part.attributes) {
    const char* const name = attribute.name.c_str();
    if (attribute.name.empty() || attribute.name.size() > longest_name)
      throw std::invalid_argument(fmt::format("part '{}': an attribute without a name, or with one that is too long", part.name));
    const exr_attribute_t* present = nullptr;
    if (attribute.name == "chunkCount" || exr_get_attribute_by_name(writer, number, name, &present) == EXR_ERR_SUCCESS)
      throw std::invalid_argument(fmt::format("part '{}': attribute '{}' is given twice or is OpenEXR's own", part.name, attribute.name));
    Writer::check(std::visit(AttributeSetter{writer, number, name}, attribute.value));
  }
}

bool has_long_names(std::span<const ExrPart> parts) {
  const auto is_long = [](const auto& named) { return named.name.size() > longest_short_name; };
  return std::any_of(parts.begin(), parts.end(), [&](const ExrPart& part) {
    return std::any_of(part.channels.begin(), part.channels.end(), is_long) || std::any_of(part.attributes.begin(), part.attributes.end(), is_long);
  });
}

std::string encode(std::span<const ExrPart> parts, int thread_count) {
  Writer writer;
  Writer::check(exr_set_longname_support(writer, has_long_names(parts)));
  for (const ExrPart& part : parts) add_part(writer, part, parts[0]);
  Writer::check(exr_write_header(writer));

  struct Chunk {
    int part, first_row;
    std::string pixels;
  };
  std::vector<Chunk> chunks;
  for (std::size_t i = 0; i < parts.size(); ++i)
    for (int row = 0; row < parts[i].height; row += rows_of_chunk) chunks.push_back({static_cast<int>(i), row, {}});
  numerics::share_blocks(chunks.size(), thread_count, [&] {
    return [&, packer = ChunkPacker()](std::size_t i) mutable {
      chunks[i].pixels = packer.pack(parts[static_cast<std::size_t>(chunks[i].part)], chunks[i].first_row);
    };
  });
  for (const Chunk& chunk : chunks)
    Writer::check(exr_write_scanline_chunk(writer, chunk.part, chunk.first_row, chunk.pixels.data(), chunk.pixels.size()));
  return writer.take_file();
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
