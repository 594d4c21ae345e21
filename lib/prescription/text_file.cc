// SPDX-License-Identifier: Apache-2.0
#include "lib/prescription/text_file.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string_view>

#include "lib/prescription/utf8.h"

namespace sagitta::prescription {
namespace {

constexpr char32_t no_character = 0xFFFD;
constexpr std::string_view low_end_first_mark = "\xFF\xFE", high_end_first_mark = "\xFE\xFF";

void append(std::string& text, char32_t code) {
  const auto put = [&](char32_t byte) { text += static_cast<char>(static_cast<unsigned char>(byte)); };
  const auto put_rest = [&](int bits) {
    for (; bits >= 0; bits -= 6) put(0x80 | ((code >> bits) & 0x3F));
  };
  if (code < 0x80) {
    put(code);
  } else if (code < 0x800) {
    put(0xC0 | (code >> 6)), put_rest(0);
  } else if (code < 0x10000) {
    put(0xE0 | (code >> 12)), put_rest(6);
  } else {
    put(0xF0 | (code >> 18)), put_rest(12);
  }
}

std::string from_utf_16(std::string_view bytes, bool low_end_first) {
  const auto unit = [&](std::size_t i) {
    const auto first = static_cast<unsigned char>(bytes[i]), second = static_cast<unsigned char>(bytes[i + 1]);
    return static_cast<char32_t>(low_end_first ? first | (second << 8) : second | (first << 8));
  };
  const auto is_in = [](char32_t code, char32_t first) { return code >= first && code < first + 0x400; };
  constexpr char32_t high = 0xD800, low = 0xDC00;  // surrogates
  std::string text;
  for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) {
    const char32_t code = unit(i);
    if (is_in(code, high) && i + 3 < bytes.size() && is_in(unit(i + 2), low)) {
      append(text, 0x10000 + ((code - high) << 10) + (unit(i + 2) - low));
      i += 2;
    } else {
      append(text, is_in(code, high) || is_in(code, low) ? no_character : code);
    }
  }
  if (bytes.size() % 2 == 1) append(text, no_character);
  return text;
}

bool is_utf_8(std::string_view text) {
  while (!text.empty()) {
    const std::size_t length = utf8_length(text);
    if (length == 0) return false;
    text.remove_prefix(length);
  }
  return true;
}

}  // namespace

std::optional<std::string> read_file(const std::string& file, std::size_t most_bytes, const std::string& hint, Findings& findings) {
  std::error_code failure;
  const auto status = std::filesystem::status(file, failure);
  if (!std::filesystem::exists(status) || std::filesystem::is_directory(status)) {
    findings.error({file}, std::filesystem::exists(status) ? "cannot be read: it is a folder" : "there is no such file");
    return std::nullopt;
  }
  std::ifstream stream(file, std::ios::binary);
  if (!stream) {
    findings.error({file}, "cannot be read");
    return std::nullopt;
  }
  // In pieces: a buffer for the largest file takes longer to set up than a usual one to read.
  constexpr std::size_t piece = 1 << 14;
  std::string bytes;
  while (stream && bytes.size() <= most_bytes) {
    const std::size_t before = bytes.size(), wanted = std::min(std::max(piece, before), most_bytes + 1 - before);
    bytes.resize(before + wanted);
    stream.read(bytes.data() + before, static_cast<std::streamsize>(wanted));
    bytes.resize(before + static_cast<std::size_t>(stream.gcount()));
  }
  if (bytes.size() > most_bytes) {
    findings.error({file}, "larger than " + std::to_string(most_bytes >> 20) + " MiB, which no such file needs", hint);
    return std::nullopt;
  }
  return bytes;
}

bool has_utf_16_mark(std::string_view bytes) { return bytes.starts_with(low_end_first_mark) || bytes.starts_with(high_end_first_mark); }

bool is_utf_16_without_mark(std::string_view bytes) {
  constexpr std::size_t looked_at = 1000;
  const std::size_t units = std::min(bytes.size(), looked_at) / 2;
  std::size_t zeros[2] = {0, 0};  // of the first and the second bytes
  for (std::size_t i = 0; i < 2 * units; ++i) zeros[i % 2] += bytes[i] == '\0';
  const auto [none, most] = std::minmax(zeros[0], zeros[1]);
  return !has_utf_16_mark(bytes) && most > 0 && 2 * most >= units && 8 * none <= most;
}

std::string utf8_text(const std::string& bytes) {
  const std::string_view all = bytes;
  if (has_utf_16_mark(all)) return from_utf_16(all.substr(2), all.starts_with(low_end_first_mark));
  const bool has_mark = all.starts_with("\xEF\xBB\xBF");
  const std::string_view content = has_mark ? all.substr(3) : all;
  if (is_utf_8(content)) return std::string(content);
  std::string text;
  if (!has_mark) {
    for (const char c : content) append(text, static_cast<unsigned char>(c));
    return text;
  }
  for (std::string_view rest = content; !rest.empty();) {
    const std::size_t length = utf8_length(rest);
    if (length == 0)
      append(text, no_character);
    else
      text += rest.substr(0, length);
    rest.remove_prefix(std::max<std::size_t>(length, 1));
  }
  return text;
}

std::optional<std::string> read_text_file(const std::string& file, std::size_t most_bytes, const std::string& hint, Findings& findings) {
  const std::optional<std::string> bytes = read_file(file, most_bytes, hint, findings);
  if (!bytes) return std::nullopt;
  if (!is_utf_16_without_mark(*bytes)) return utf8_text(*bytes);
  findings.error({file}, "UTF-16 without a byte order mark", "save the file as UTF-8, or as UTF-16 with a byte order mark");
  return std::nullopt;
}

}  // namespace sagitta::prescription
