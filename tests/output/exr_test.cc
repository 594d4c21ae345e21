// SPDX-License-Identifier: Apache-2.0
#include "lib/output/exr.h"

#include <ImfChannelList.h>
#include <ImfCompression.h>
#include <ImfDoubleAttribute.h>
#include <ImfFloatAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputPart.h>
#include <ImfIntAttribute.h>
#include <ImfLineOrder.h>
#include <ImfMultiPartInputFile.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfPartType.h>
#include <ImfStringAttribute.h>
#include <ImfStringVectorAttribute.h>
#include <ImfVecAttribute.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cstdio>
#include <cstring>
#include <limits>
#include <map>
#include <random>

#include "lib/output/raster.h"
#include "tests/output/test_folder.h"

namespace sagitta::output {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::vector<std::uint32_t> bits(const std::vector<float>& values) {
  std::vector<std::uint32_t> result;
  for (const float value : values) result.push_back(std::bit_cast<std::uint32_t>(value));
  return result;
}

// A part of random floats of every kind: NaN with payloads, infinities, subnormals.
ExrPart random_part(const std::string& name, int width, int height, unsigned seed) {
  std::mt19937 random(seed);
  const std::size_t count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  std::vector<float> values(count);
  std::vector<std::uint32_t> mask(count);
  for (std::size_t i = 0; i < count; ++i) {
    values[i] = std::bit_cast<float>(static_cast<std::uint32_t>(random()));
    mask[i] = static_cast<std::uint32_t>(random());
  }
  values[0] = std::numeric_limits<float>::quiet_NaN();
  return {name, width, height, {{"Y", values}, {"wavefront.mask", mask}}, {{"unit", std::string("waves")}}};
}

template <class T>
std::vector<T> read_channel(Imf::MultiPartInputFile& file, int part, const char* name) {
  Imf::InputPart input(file, part);
  const Imath::Box2i window = input.header().dataWindow();
  const auto width = static_cast<std::size_t>(window.max.x + 1), height = static_cast<std::size_t>(window.max.y + 1);
  std::vector<T> values(width * height);
  Imf::FrameBuffer buffer;
  buffer.insert(name, Imf::Slice(std::is_same_v<T, float> ? Imf::FLOAT : Imf::UINT,
                                 reinterpret_cast<char*>(values.data()), sizeof(T), sizeof(T) * width));
  input.setFrameBuffer(buffer);
  input.readPixels(0, window.max.y);
  return values;
}

TEST(Exr, EveryBitOfEveryChannelComesBackInTheOrderOfTheParts) {
  const TestFolder folder;
  const std::vector<ExrPart> parts{random_part("preview", 33, 17, 1), random_part("b", 64, 64, 2),
                                   random_part("a", 1, 1, 3), random_part("c", 5, 200, 4)};
  ASSERT_EQ(write_exr(folder / "x.exr", parts).error, "");
  Imf::MultiPartInputFile file((folder / "x.exr").c_str());
  ASSERT_EQ(file.parts(), 4);
  int nan_count = 0;
  for (int i = 0; i < 4; ++i) {
    const ExrPart& part = parts[static_cast<std::size_t>(i)];
    const Imf::Header& header = file.header(i);
    EXPECT_EQ(header.name(), part.name);
    EXPECT_EQ(header.type(), Imf::SCANLINEIMAGE);
    EXPECT_EQ(header.compression(), Imf::ZIP_COMPRESSION);
    EXPECT_EQ(header.dataWindow(), Imath::Box2i({0, 0}, {part.width - 1, part.height - 1}));
    EXPECT_EQ(header.displayWindow(), Imath::Box2i({0, 0}, {32, 16}));  // the first part's, in all
    const auto& written = std::get<std::vector<float>>(part.channels[0].pixels);
    EXPECT_EQ(bits(read_channel<float>(file, i, "Y")), bits(written));
    EXPECT_EQ(read_channel<std::uint32_t>(file, i, "wavefront.mask"),
              std::get<std::vector<std::uint32_t>>(part.channels[1].pixels));
    for (const float value : written) nan_count += value != value;
  }
  EXPECT_GT(nan_count, 4);  // one was planted in each part; random bits hold more
}

TEST(Exr, TheFirstRowIsTheTopOfThePicture) {
  const TestFolder folder;
  const ExrPart part{"p", 1, 2, {{"Y", std::vector<float>{10, 20}}}, {}};
  ASSERT_TRUE(write_exr(folder / "x.exr", {&part, 1}).ok());
  Imf::MultiPartInputFile file((folder / "x.exr").c_str());
  EXPECT_EQ(file.header(0).lineOrder(), Imf::INCREASING_Y);  // y = 0 is the top in OpenEXR
  EXPECT_THAT(read_channel<float>(file, 0, "Y"), ElementsAre(10, 20));
}

TEST(Exr, AttributesOfEveryTypeComeBack) {
  const TestFolder folder;
  const ExrPart part{"p",
                     1,
                     1,
                     {{"Y", std::vector<float>{0}}},
                     {{"text", std::string("OPD = OPL(chief) − OPL(ray)")},
                      {"count", -3},
                      {"short", 0.1F},
                      {"long", 0.1},
                      {"pixel_size_mm", std::array<float, 2>{1, 2}},
                      {"place_mm", std::array<float, 3>{1, 2, 3}},
                      {"names", std::vector<std::string>{"ok", "missed"}},
                      {"a_name_of_more_than_thirty_one_characters", 1}}};
  ASSERT_EQ(write_exr(folder / "x.exr", {&part, 1}).error, "");
  const Imf::MultiPartInputFile file((folder / "x.exr").c_str());
  const Imf::Header& header = file.header(0);
  EXPECT_EQ(header.typedAttribute<Imf::StringAttribute>("text").value(), "OPD = OPL(chief) − OPL(ray)");
  EXPECT_EQ(header.typedAttribute<Imf::IntAttribute>("count").value(), -3);
  EXPECT_EQ(header.typedAttribute<Imf::FloatAttribute>("short").value(), 0.1F);
  EXPECT_EQ(header.typedAttribute<Imf::DoubleAttribute>("long").value(), 0.1);
  EXPECT_EQ(header.typedAttribute<Imf::V2fAttribute>("pixel_size_mm").value(), Imath::V2f(1, 2));
  EXPECT_EQ(header.typedAttribute<Imf::V3fAttribute>("place_mm").value(), Imath::V3f(1, 2, 3));
  EXPECT_THAT(header.typedAttribute<Imf::StringVectorAttribute>("names").value(), ElementsAre("ok", "missed"));
  EXPECT_EQ(header.typedAttribute<Imf::IntAttribute>("a_name_of_more_than_thirty_one_characters").value(), 1);
}

TEST(Exr, TheSamePartsGiveTheSameBytesAndAHundredAndTwentyPartsAreNoTrouble) {
  const TestFolder folder;
  std::vector<ExrPart> parts;
  for (unsigned i = 0; i < 120; ++i) parts.push_back(random_part(fmt::format("part {}", i), 64, 64, i));
  ASSERT_EQ(write_exr(folder / "a.exr", parts).error, "");
  ASSERT_EQ(write_exr(folder / "b.exr", parts).error, "");
  EXPECT_GT(folder.contents("a.exr").size(), 100000U);
  EXPECT_EQ(folder.contents("a.exr"), folder.contents("b.exr"));
  EXPECT_EQ(Imf::MultiPartInputFile((folder / "a.exr").c_str()).parts(), 120);
}

TEST(Exr, AnyNumberOfThreadsGivesTheSameBytes) {
  const TestFolder folder;
  std::vector<ExrPart> parts;
  for (unsigned i = 0; i < 9; ++i) parts.push_back(random_part(fmt::format("part {}", i), 50, 90, i));
  for (const int thread_count : {1, 2, 7, 0}) ASSERT_EQ(write_exr(folder / fmt::format("{}.exr", thread_count), parts, thread_count).error, "");
  for (const char* name : {"2.exr", "7.exr", "0.exr"}) EXPECT_EQ(folder.contents(name), folder.contents("1.exr"));
}

TEST(Exr, APictureOfBytesIsTheSameFileAsItsFloats) {
  const TestFolder folder;
  std::mt19937 random(5);
  ExrBytes bytes{{}, 3, {}};
  for (float& value : bytes.values) value = std::bit_cast<float>(static_cast<std::uint32_t>(random()));
  std::vector<std::uint8_t> picture(3 * 37 * 35 - 2);  // the last pixel's first byte is the last of all
  for (std::uint8_t& byte : picture) byte = static_cast<std::uint8_t>(random() % 64 * (random() % 5));
  bytes.bytes = picture;
  std::vector<float> floats;
  for (std::size_t i = 0; i < picture.size(); i += 3) floats.push_back(bytes.values[picture[i]]);
  ASSERT_EQ(floats.size(), 37U * 35);
  const ExrPart as_bytes{"p", 37, 35, {{"Y", bytes}, {"Z", floats}}, {}}, as_floats{"p", 37, 35, {{"Y", floats}, {"Z", bytes}}, {}};
  ASSERT_EQ(write_exr(folder / "a.exr", {&as_bytes, 1}).error, "");
  ASSERT_EQ(write_exr(folder / "b.exr", {&as_floats, 1}).error, "");
  EXPECT_EQ(folder.contents("a.exr"), folder.contents("b.exr"));
  Imf::MultiPartInputFile file((folder / "a.exr").c_str());
  EXPECT_EQ(bits(read_channel<float>(file, 0, "Y")), bits(floats));
}

// What stands before the chunks: of every part its attributes' names, and as bytes their types and values.
std::vector<std::map<std::string, std::string>> headers_of(const std::string& file) {
  std::vector<std::map<std::string, std::string>> parts;
  std::size_t at = 8;  // behind the magic number and the version
  while (file[at] != '\0') {
    for (parts.emplace_back(); file[at] != '\0';) {
      const std::size_t type = file.find('\0', at) + 1, size = file.find('\0', type) + 1;
      std::int32_t value_size = 0;
      std::memcpy(&value_size, file.data() + size, sizeof value_size);
      const std::size_t end = size + sizeof value_size + static_cast<std::size_t>(value_size);
      parts.back()[file.c_str() + at] = file.substr(type, end - type);
      at = end;
    }
    ++at;
  }
  return parts;
}

TEST(Exr, TheHeadersAreThoseOfOpenExrsOtherWriter) {
  const TestFolder folder;
  std::vector<ExrPart> parts{random_part("preview", 33, 17, 1), random_part("b", 64, 40, 2)};
  parts[1].attributes = {{"text", std::string("−")},
                         {"count", -3},
                         {"short", 0.1F},
                         {"long", 0.1},
                         {"Pixel_size_mm", std::array<float, 2>{1, 2}},
                         {"place_mm", std::array<float, 3>{1, 2, 3}},
                         {"names", std::vector<std::string>{"ok", "", "missed"}},
                         {"nothing", std::string()},
                         {"none", std::vector<std::string>()}};
  for (const bool has_long_name : {false, true}) {
    if (has_long_name) parts[1].attributes.push_back({"a_name_of_more_than_thirty_one_characters", 1});
    std::vector<Imf::Header> headers;
    for (const ExrPart& part : parts) {
      headers.emplace_back(part.width, part.height);
      headers.back().setName(part.name);
      headers.back().setType(Imf::SCANLINEIMAGE);
      headers.back().compression() = Imf::ZIP_COMPRESSION;
      headers.back().channels().insert("wavefront.mask", Imf::Channel(Imf::UINT));
      headers.back().channels().insert("Y", Imf::Channel(Imf::FLOAT));
    }
    headers[0].insert("unit", Imf::StringAttribute("waves"));
    headers[1].insert("text", Imf::StringAttribute("−"));
    headers[1].insert("count", Imf::IntAttribute(-3));
    headers[1].insert("short", Imf::FloatAttribute(0.1F));
    headers[1].insert("long", Imf::DoubleAttribute(0.1));
    headers[1].insert("Pixel_size_mm", Imf::V2fAttribute({1, 2}));
    headers[1].insert("place_mm", Imf::V3fAttribute({1, 2, 3}));
    headers[1].insert("names", Imf::StringVectorAttribute(Imf::StringVector{"ok", "", "missed"}));
    headers[1].insert("nothing", Imf::StringAttribute(""));
    headers[1].insert("none", Imf::StringVectorAttribute());
    if (has_long_name) headers[1].insert("a_name_of_more_than_thirty_one_characters", Imf::IntAttribute(1));
    { const Imf::MultiPartOutputFile file((folder / "theirs.exr").c_str(), headers.data(), 2, true, 0); }
    ASSERT_EQ(write_exr(folder / "ours.exr", parts).error, "");
    const std::string ours = folder.contents("ours.exr"), theirs = folder.contents("theirs.exr");
    EXPECT_EQ(ours.substr(0, 8), theirs.substr(0, 8));
    ASSERT_EQ(headers_of(theirs).size(), 2U);
    EXPECT_EQ(headers_of(ours), headers_of(theirs));
  }
}

TEST(Exr, WhatCannotBeWrittenIsNamedAndNothingIsLeft) {
  const TestFolder folder;
  const std::string path = folder / "x.exr";
  const auto error = [&](const std::vector<ExrPart>& parts) { return write_exr(path, parts).error; };
  const ExrChannel pixel{"Y", std::vector<float>{0}};
  EXPECT_EQ(error({}), path + ": no part to write");
  EXPECT_EQ(error({{"a", 1, 1, {pixel}, {}}, {"a", 1, 1, {pixel}, {}}}), path + ": two parts are named 'a'");
  EXPECT_EQ(error({{"", 1, 1, {pixel}, {}}}), path + ": a part without a name");
  EXPECT_EQ(error({{"a", 1, 0, {pixel}, {}}}), path + ": part 'a': 1 x 0 pixels");
  EXPECT_EQ(error({{"a", 1, 1, {}, {}}}), path + ": part 'a': no channel");
  EXPECT_EQ(error({{"a", 1, 1, {pixel, pixel}, {}}}), path + ": part 'a': two channels are named 'Y'");
  EXPECT_EQ(error({{"a", 2, 3, {pixel}, {}}}), path + ": part 'a': channel 'Y' holds 1 pixels, not 2 x 3");
  EXPECT_EQ(error({{"a", 1, 1, {{"", pixel.pixels}}, {}}}), path + ": part 'a': a channel without a name");
  EXPECT_THAT(error({{"a", 1, 1, {pixel}, {{"unit", 1}, {"unit", 2}}}}), HasSubstr("attribute 'unit' is given twice"));
  for (const char* own : {"compression", "chunkCount", "type", "displayWindow", "channels"})
    EXPECT_THAT(error({{"a", 1, 1, {pixel}, {{own, 1}}}}), HasSubstr(fmt::format("attribute '{}' is given twice or is OpenEXR's own", own)));
  EXPECT_EQ(error({{"a", 1, 1, {{std::string(256, 'Y'), pixel.pixels}}, {}}}), path + ": part 'a': a channel's name is too long");
  for (const std::string& name : {std::string(), std::string(256, 'u')})
    EXPECT_EQ(error({{"a", 1, 1, {pixel}, {{name, 1}}}}), path + ": part 'a': an attribute without a name, or with one that is too long");
  EXPECT_TRUE(folder.names().empty());
}

// The output and the exit status of a command.
std::pair<std::string, int> run(const std::string& command) {
  std::string output;
  FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  if (pipe == nullptr) return {"", -1};
  char buffer[4096];
  for (std::size_t size = 0; (size = fread(buffer, 1, sizeof buffer, pipe)) > 0;) output.append(buffer, size);
  return {output, pclose(pipe)};
}

class ExrReaders : public ::testing::TestWithParam<const char*> {};

TEST_P(ExrReaders, ShowEveryPartAndAttributeAndWarnOfNothing) {
  const std::string command = GetParam();
  const std::string program = command.substr(0, command.find(' '));
  if (run("command -v " + program).second != 0) GTEST_SKIP() << program << " is not installed";
  const TestFolder folder;
  const Raster raster{40, 30, std::vector<std::uint32_t>(1200, 0x808080)};
  std::vector<ExrPart> parts{preview_part(raster), random_part("wavefront.field1.543nm", 64, 64, 7)};
  parts[1].attributes.push_back({"wavelength_nm", 543.25});
  parts[1].attributes.push_back({"pixel_size_mm", std::array<float, 2>{0.25F, 0.5F}});
  ASSERT_EQ(write_exr(folder / "x.exr", parts).error, "");
  const auto [text, status] = run(command + " " + (folder / "x.exr"));
  EXPECT_EQ(status, 0) << text;
  for (const char* expected : {"preview", "wavefront.field1.543nm", "wavefront.mask", "wavelength_nm", "543.25",
                               "pixel_size_mm", "0.25", "unit", "waves"})
    EXPECT_THAT(text, HasSubstr(expected));
  for (const char* unwanted : {"arning", "rror", "WARNING", "ERROR"}) EXPECT_THAT(text, Not(HasSubstr(unwanted)));
}
INSTANTIATE_TEST_SUITE_P(Programs, ExrReaders, ::testing::Values("exrheader", "oiiotool --info -v -a"));

}  // namespace
}  // namespace sagitta::output
