// SPDX-License-Identifier: Apache-2.0
#include "lib/prescription/text_file.h"

#include <gtest/gtest.h>

#include "tests/prescription/support.h"

namespace sagitta::prescription {
namespace {

using namespace std::string_literals;

const std::string text = "a\u00e4\u20ac\U0001F441";  // 1, 2, 3 and 4 bytes

TEST(Utf8Text, IsTheSameFromEveryEncoding) {
  EXPECT_EQ(utf8_text(text), text);
  EXPECT_EQ(utf8_text("\xEF\xBB\xBF" + text), text);
  EXPECT_EQ(utf8_text("\xFF\xFE" "a\0\xE4\0\xAC\x20\x3D\xD8\x41\xDC"s), text);
  EXPECT_EQ(utf8_text("\xFE\xFF" "\0a\0\xE4\x20\xAC\xD8\x3D\xDC\x41"s), text);
  EXPECT_EQ(utf8_text("\xB5m, \xE4 \xFF"), "\u00b5m, \u00e4 \u00ff");  // no UTF-8: Latin-1
  EXPECT_EQ(utf8_text(""), "");
}

TEST(Utf16WithoutMark, IsToldByItsZeroBytes) {
  for (const std::string& one : {"V\0E\0R\0S\0"s, "\0V\0E\0R\0S"s, "V\0"s, "V\0E\0R"s, "\xAC\x20 \0a\0"s, "\0\x01 \0a\0a\0a\0a\0a\0a\0a\0a\0"s}) EXPECT_TRUE(is_utf_16_without_mark(one)) << one;
  for (const std::string& one : {""s, "V"s, "VERS"s, "\0\0"s, "V\0\0\0E\0\0\0"s, "VERS\0 is a text with one zero byte"s, "\xFF\xFE" "V\0E\0"s, "\xFE\xFF" "\0V\0E"s, text, "\xB5m"s}) EXPECT_FALSE(is_utf_16_without_mark(one)) << one;
}

TEST(Utf8Text, WhatIsNoCharacterIsReplaced) {
  EXPECT_EQ(utf8_text("\xFF\xFE" "a\0b"s), "a\uFFFD");                          // half a unit
  EXPECT_EQ(utf8_text("\xFF\xFE" "\x3D\xD8" "a\0"s), "\uFFFD" "a");             // a high surrogate alone
  EXPECT_EQ(utf8_text("\xFF\xFE" "\x41\xDC\x3D\xD8"s), "\uFFFD\uFFFD");         // a low one first, a high one last
  EXPECT_EQ(utf8_text("\xEF\xBB\xBF" "a\xE4" "b"s), "a\uFFFD" "b");             // marked as UTF-8, which it is not
}

TEST(ReadFile, HasALimit) {
  const test::TemporaryFolder folder;
  const std::string file = folder.write("a", std::string(1 << 20, 'x'));
  Findings findings;
  EXPECT_EQ(read_file(file, 1 << 20, "", findings)->size(), std::size_t{1} << 20);
  EXPECT_FALSE(findings.has_errors());
  EXPECT_FALSE(read_file(folder.write("b", std::string((1 << 20) + 1, 'x')), 1 << 20, "shorten it", findings));
  EXPECT_FALSE(read_file(folder.path(), 1 << 20, "", findings));
  EXPECT_FALSE(read_file(folder.path() + "/none", 1 << 20, "", findings));
  EXPECT_EQ(findings.error_count(), 3);
  EXPECT_EQ(findings.all()[0].hint, "shorten it");
}

}  // namespace
}  // namespace sagitta::prescription
