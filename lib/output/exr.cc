// SPDX-License-Identifier: Apache-2.0
#include "lib/output/exr.h"

#include <ImfChannelList.h>
#include <ImfDoubleAttribute.h>
#include <ImfFloatAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfIntAttribute.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfStringAttribute.h>
#include <ImfStringVectorAttribute.h>
#include <ImfVecAttribute.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <exception>
#include <set>

namespace sagitta::output {
namespace {

// The file in memory: it is small beside the arrays it is made of, and reaches the disk whole or not at all.
class MemoryStream : public Imf::OStream {
 public:
  explicit MemoryStream(const std::string& name) : Imf::OStream(name.c_str()) {}

  void write(const char data[], int count) override {
    const std::size_t end = position_ + static_cast<std::size_t>(count);
    if (end > bytes_.size()) bytes_.resize(end);
    std::memcpy(bytes_.data() + position_, data, static_cast<std::size_t>(count));
    position_ = end;
  }
  std::uint64_t tellp() override { return position_; }
  void seekp(std::uint64_t position) override { position_ = position; }

  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
  std::size_t position_ = 0;
};

// One overload for each alternative of ExrAttribute::value.
void insert(Imf::Header& header, const char* name, const std::string& value) {
  header.insert(name, Imf::StringAttribute(value));
}
void insert(Imf::Header& header, const char* name, int value) { header.insert(name, Imf::IntAttribute(value)); }
void insert(Imf::Header& header, const char* name, float value) { header.insert(name, Imf::FloatAttribute(value)); }
void insert(Imf::Header& header, const char* name, double value) { header.insert(name, Imf::DoubleAttribute(value)); }
void insert(Imf::Header& header, const char* name, const std::array<float, 2>& value) {
  header.insert(name, Imf::V2fAttribute({value[0], value[1]}));
}
void insert(Imf::Header& header, const char* name, const std::array<float, 3>& value) {
  header.insert(name, Imf::V3fAttribute({value[0], value[1], value[2]}));
}
void insert(Imf::Header& header, const char* name, const std::vector<std::string>& value) {
  header.insert(name, Imf::StringVectorAttribute(value));
}

Imf::PixelType pixel_type(const std::vector<float>&) { return Imf::FLOAT; }
Imf::PixelType pixel_type(const std::vector<std::uint32_t>&) { return Imf::UINT; }

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
    const std::size_t expected = static_cast<std::size_t>(part.width) * static_cast<std::size_t>(part.height);
    std::set<std::string> channel_names;
    for (const ExrChannel& channel : part.channels) {
      if (channel.name.empty()) return fmt::format("part '{}': a channel without a name", part.name);
      if (!channel_names.insert(channel.name).second)
        return fmt::format("part '{}': two channels are named '{}'", part.name, channel.name);
      const std::size_t count = std::visit([](const auto& pixels) { return pixels.size(); }, channel.pixels);
      if (count != expected)
        return fmt::format("part '{}': channel '{}' holds {} pixels, not {} x {}", part.name, channel.name, count,
                           part.width, part.height);
    }
  }
  return {};
}

std::string encode(const std::string& path, std::span<const ExrPart> parts) {
  std::vector<Imf::Header> headers;
  headers.reserve(parts.size());
  for (const ExrPart& part : parts) {
    Imf::Header header(part.width, part.height);
    header.setName(part.name);
    header.setType(Imf::SCANLINEIMAGE);
    header.compression() = Imf::ZIP_COMPRESSION;
    header.zipCompressionLevel() = 1;  // half the time, for a fifth more bytes
    for (const ExrChannel& channel : part.channels)
      header.channels().insert(
          channel.name,
          Imf::Channel(std::visit([](const auto& pixels) { return pixel_type(pixels); }, channel.pixels)));
    for (const ExrAttribute& attribute : part.attributes) {
      if (header.find(attribute.name) != header.end())
        throw std::invalid_argument(
            fmt::format("part '{}': attribute '{}' is given twice or is OpenEXR's own", part.name, attribute.name));
      std::visit([&](const auto& value) { insert(header, attribute.name.c_str(), value); }, attribute.value);
    }
    headers.push_back(header);
  }

  MemoryStream stream(path);
  {
    constexpr bool share_display_window = true;
    constexpr int thread_count = 0;
    Imf::MultiPartOutputFile file(stream, headers.data(), static_cast<int>(headers.size()), share_display_window,
                                  thread_count);
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const ExrPart& part = parts[i];
      Imf::FrameBuffer buffer;
      for (const ExrChannel& channel : part.channels)
        std::visit(
            [&](const auto& pixels) {
              // Slices are read only when a file is written, whatever the pointer's type says.
              char* data = const_cast<char*>(reinterpret_cast<const char*>(pixels.data()));
              buffer.insert(channel.name, Imf::Slice(pixel_type(pixels), data, sizeof pixels[0],
                                                     sizeof pixels[0] * static_cast<std::size_t>(part.width)));
            },
            channel.pixels);
      Imf::OutputPart output(file, static_cast<int>(i));
      output.setFrameBuffer(buffer);
      output.writePixels(part.height);
    }
  }  // the file's end writes the tables of offsets
  return stream.bytes();
}

}  // namespace

WriteResult write_exr(const std::string& path, std::span<const ExrPart> parts) {
  if (std::string what = fault(parts); !what.empty()) return {path + ": " + what};
  try {
    return write_file(path, encode(path, parts));
  } catch (const std::exception& exception) {  // the OpenEXR library's, or no memory
    return {path + ": " + exception.what()};
  }
}

}  // namespace sagitta::output
