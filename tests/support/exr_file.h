// SPDX-License-Identifier: Apache-2.0
// Parts of an EXR file, read with the OpenEXR library.
#pragma once

#include <ImfChannelList.h>
#include <ImfDoubleAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputPart.h>
#include <ImfIntAttribute.h>
#include <ImfMultiPartInputFile.h>
#include <ImfStringAttribute.h>
#include <ImfVecAttribute.h>

#include <map>
#include <string>
#include <vector>

namespace sagitta::test {

struct ExrFilePart {
  std::string name;
  int width = 0, height = 0;
  std::map<std::string, std::vector<float>> floats;
  std::map<std::string, std::vector<unsigned>> counts;
  Imf::Header header;

  std::string text(const char* attribute) const { return header.typedAttribute<Imf::StringAttribute>(attribute).value(); }
  double number(const char* attribute) const { return header.typedAttribute<Imf::DoubleAttribute>(attribute).value(); }
  int integer(const char* attribute) const { return header.typedAttribute<Imf::IntAttribute>(attribute).value(); }
  Imath::V2f pair(const char* attribute) const { return header.typedAttribute<Imf::V2fAttribute>(attribute).value(); }
};

inline std::vector<ExrFilePart> read_exr(const std::string& path) {
  Imf::MultiPartInputFile file(path.c_str());
  std::vector<ExrFilePart> parts;
  for (int number = 0; number < file.parts(); ++number) {
    Imf::InputPart input(file, number);
    const Imath::Box2i window = input.header().dataWindow();
    ExrFilePart part{input.header().name(), window.max.x + 1, window.max.y + 1, {}, {}, input.header()};
    const auto width = static_cast<std::size_t>(part.width), size = width * static_cast<std::size_t>(part.height);
    Imf::FrameBuffer buffer;
    for (auto channel = input.header().channels().begin(); channel != input.header().channels().end(); ++channel) {
      const bool is_float = channel.channel().type == Imf::FLOAT;
      char* const data = is_float ? reinterpret_cast<char*>((part.floats[channel.name()] = std::vector<float>(size)).data())
                                  : reinterpret_cast<char*>((part.counts[channel.name()] = std::vector<unsigned>(size)).data());
      buffer.insert(channel.name(), Imf::Slice(channel.channel().type, data, 4, 4 * width));
    }
    input.setFrameBuffer(buffer);
    input.readPixels(0, window.max.y);
    parts.push_back(std::move(part));
  }
  return parts;
}

}  // namespace sagitta::test
