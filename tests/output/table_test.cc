// SPDX-License-Identifier: Apache-2.0
#include "lib/output/table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "lib/output/text.h"

namespace sagitta::output {
namespace {

using ::testing::ElementsAre;

TEST(Table, ColumnsAreAlignedAndNamesStandOverThem) {
  const Table table{{{"field", "deg", true}, {"RMS radius", "µm"}, {"λ", "nm"}, {"note", "", true}},
                    {{"0, 0", "12.35", "543"}, {"0, 10", "1.2", "632.8", "é"}, {"far", "-", "", "x", "beyond"}}};
  EXPECT_EQ(to_text(table),
            "field  RMS radius      λ  note\n"
            "deg            µm     nm\n"
            "-----  ----------  -----  ----\n"
            "0, 0        12.35    543\n"
            "0, 10         1.2  632.8  é\n"
            "far             -         x\n");
}

TEST(Table, WithoutUnitsThereIsOneLineOfNamesAndWithoutRowsOnlyTheHead) {
  EXPECT_EQ(to_text({{{"a", ""}, {"bc", ""}}, {{"10", "2"}}}), " a  bc\n--  --\n10   2\n");
  EXPECT_EQ(to_text({{{"a", ""}}, {}}), "a\n-\n");
}

TEST(Table, ANameCannotSteerTheTerminal) {
  EXPECT_EQ(to_text({{{"n", "", true}}, {{"\x1b[31mred\n"}}}), "n\n---------\n [31mred\n");
}

TEST(Text, NumbersHaveSignificantDigits) {
  EXPECT_EQ(significant(0.5, 3), "0.500");
  EXPECT_EQ(significant(12.345678, 4), "12.35");
  EXPECT_EQ(significant(9.9996, 4), "10.00");
  EXPECT_EQ(significant(123456, 4), "123456");
  EXPECT_EQ(significant(1234567, 3), "1.23e+06");
  EXPECT_EQ(significant(0.00012345, 3), "0.000123");
  EXPECT_EQ(significant(0.000012345, 3), "1.23e-05");
  EXPECT_EQ(significant(-2.5e-3, 2), "-0.0025");
  EXPECT_EQ(significant(0, 3), "0.00");
  EXPECT_EQ(significant(-0.0, 1), "0");
  EXPECT_EQ(significant(std::numeric_limits<double>::quiet_NaN(), 3), "-");
  EXPECT_EQ(significant(-std::numeric_limits<double>::infinity(), 3), "-inf");
}

TEST(Text, BytesThatAreNotUtf8AreReplacedOneByOne) {
  const std::string bad = "\uFFFD";
  EXPECT_THAT(characters("aé€😀"), ElementsAre("a", "é", "€", "😀"));
  EXPECT_THAT(characters("\xff\x80"), ElementsAre(bad, bad));
  EXPECT_THAT(characters("\xc0\xaf"), ElementsAre(bad, bad));                    // overlong "/"
  EXPECT_THAT(characters("\xed\xa0\x80"), ElementsAre(bad, bad, bad));           // a surrogate
  EXPECT_THAT(characters("\xf4\x90\x80\x80"), ElementsAre(bad, bad, bad, bad));  // above U+10FFFF
  EXPECT_THAT(characters("\xe2\x82"), ElementsAre(bad, bad));                    // cut off
  EXPECT_THAT(characters("\t\x7f\u0085"), ElementsAre(" ", " ", " "));
  // Code points without a character, and their neighbours.
  EXPECT_THAT(characters("\uFDCF\uFDD0\uFDEF\uFDF0"), ElementsAre("\uFDCF", bad, bad, "\uFDF0"));
  EXPECT_THAT(characters("\uFFFC\uFFFE\uFFFF\U00010000"), ElementsAre("\uFFFC", bad, bad, "\U00010000"));
  EXPECT_THAT(characters("\U0001FFFD\U0001FFFE\U0010FFFF\U0001FDD0"), ElementsAre("\U0001FFFD", bad, bad, "\U0001FDD0"));
}

TEST(Text, LongTextIsCut) {
  EXPECT_EQ(printable("abcdef", 6), "abcdef");
  EXPECT_EQ(printable("abcdef", 5), "abcd…");
}

}  // namespace
}  // namespace sagitta::output
