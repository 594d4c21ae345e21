// SPDX-License-Identifier: Apache-2.0
#include "lib/prescription/diagnostics.h"

#include <gtest/gtest.h>

#include "lib/prescription/utf8.h"

namespace sagitta::prescription {
namespace {

TEST(Diagnostics, AFindingIsOneLineAndItsHintAnother) {
  EXPECT_EQ(format({{"a.yaml", 3, 7}, Severity::error, "bad", ""}), "a.yaml:3:7: error: bad");
  EXPECT_EQ(format({{"a.yaml", 3, 7}, Severity::warning, "odd", "do so"}), "a.yaml:3:7: warning: odd\n  hint: do so");
  EXPECT_EQ(format({{"a.yaml"}, Severity::note, "named here", ""}), "a.yaml:1:1: note: named here");
  EXPECT_EQ(format({{"--with", -1}, Severity::note, "named here", ""}), "--with: note: named here");
}

TEST(Diagnostics, OnlyErrorsAreErrors) {
  Findings findings;
  findings.note({}, "a");
  findings.warning({}, "b");
  EXPECT_FALSE(findings.has_errors());
  findings.error({}, "c");
  EXPECT_TRUE(findings.has_errors());
  EXPECT_EQ(findings.error_count(), 1);
  EXPECT_EQ(findings.all().size(), 3u);
}

TEST(Diagnostics, TheNearestNameIsAtMostAThirdOfTheLettersAway) {
  const std::vector<std::string> names{"thickness_mm", "medium", "name", "stop"};
  EXPECT_EQ(nearest_name("thickness_mn", names), "thickness_mm");
  EXPECT_EQ(nearest_name("mediun", names), "medium");
  EXPECT_EQ(nearest_name("nmae", names), "name");  // two neighbours swapped are one edit
  EXPECT_EQ(nearest_name("stpo", names), "stop");
  EXPECT_EQ(nearest_name("st", names), "");  // two edits, one allowed
  EXPECT_EQ(nearest_name("", names), "");
  EXPECT_EQ(nearest_name("medium", {}), "");
  EXPECT_EQ(nearest_name(std::string(1000, 'm'), names), "");
}

TEST(Diagnostics, AnExcerptIsShortAndHarmless) {
  EXPECT_EQ(excerpt("7.8 mm"), "7.8 mm");
  EXPECT_EQ(excerpt(std::string(40, 'x')), std::string(40, 'x'));
  EXPECT_EQ(excerpt(std::string(41, 'x')), std::string(40, 'x') + "...");
  EXPECT_EQ(excerpt("a\x1b[31m\n\t\x7f"), "a?[31m???");
  EXPECT_EQ(excerpt("K\xc3\xbc"
                    "chle"),
            "K\xc3\xbc"
            "chle");
  EXPECT_EQ(excerpt("K\xfc"
                    "chle \xc3"),
            "K?chle ?");
  EXPECT_EQ(excerpt("\xc2\x9b"
                    "31m"),
            "?31m");  // the one-character form of ESC [
  EXPECT_EQ(excerpt(std::string(39, 'x') + "\xc3\xbc"), std::string(39, 'x') + "...");  // no half character
}

TEST(Utf8, LengthsFollowTheTableOfUnicode) {
  struct Case {
    std::string bytes;
    std::size_t length;
  };
  const std::vector<Case> cases{{"", 0},
                                {"a", 1},
                                {"\x7f", 1},
                                {"\x80", 0},
                                {"\xc1\xbf", 0},
                                {"\xc2\x80", 2},
                                {"\xc2", 0},
                                {"\xe0\x9f\xbf", 0},
                                {"\xe0\xa0\x80", 3},
                                {"\xed\xa0\x80", 0},
                                {"\xed\x9f\xbf", 3},
                                {"\xf0\x8f\xbf\xbf", 0},
                                {"\xf0\x90\x80\x80", 4},
                                {"\xf4\x8f\xbf\xbf", 4},
                                {"\xf4\x90\x80\x80", 0},
                                {"\xf5\x80\x80\x80", 0},
                                {"\xe2\x82", 0},
                                {"\xff", 0}};
  for (const Case& one : cases) EXPECT_EQ(utf8_length(one.bytes), one.length) << excerpt(one.bytes);
}

}  // namespace
}  // namespace sagitta::prescription
