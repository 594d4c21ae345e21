// SPDX-License-Identifier: Apache-2.0
#include "lib/lens_file/lens_reader.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>

#include "lib/prescription/text_file.h"

namespace sagitta::lens_file {
namespace {

struct Format {
  std::string_view ending;
  std::optional<Lens> (*read)(const std::string& file, const std::string& text, Report& report);
};
constexpr std::array formats{Format{".zmx", read_zemax}, Format{".seq", read_code_v}};

const Format* format_of(const std::string& file) {
  std::string ending = std::filesystem::path(file).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  const auto found = std::find_if(formats.begin(), formats.end(), [&](const Format& one) { return one.ending == ending; });
  return found == formats.end() ? nullptr : &*found;
}

}  // namespace

std::string lens_file_formats() {
  std::string all;
  for (const Format& one : formats) all += (all.empty() ? "LENS" : " or LENS") + std::string(one.ending);
  return all;
}

bool is_lens_file(const std::string& file) { return format_of(file) != nullptr; }

std::optional<Lens> read_lens(const std::string& file, Report& report) {
  const Format* format = format_of(file);
  if (!format) {
    report.broken({file}, "the ending of its name is that of no lens file", "known are " + lens_file_formats());
    return std::nullopt;
  }
  const std::optional<std::string> text = prescription::read_text_file(file, most_lens_file_bytes, "a lens of 1000 surfaces takes less", report.findings());
  return text ? format->read(file, *text, report) : std::nullopt;
}

}  // namespace sagitta::lens_file
