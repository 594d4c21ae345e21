// SPDX-License-Identifier: Apache-2.0
#include "lib/prescription/index_pattern.h"

#include <gtest/gtest.h>

#include <regex>

namespace sagitta::prescription {
namespace {

using numerics::IndexRange;

TEST(IndexPattern, MatchesTheNumbersOfTheRangeAndNoOthers) {
  int matched = 0;
  for (const IndexRange range : {IndexRange{0, 0}, {0, 9}, {1, 37}, {2, 40}, {0, 5150}, {1, 5151}, {1, 230}, {1, 12}, {2, 12, 2}, {1, 11, 2}, {9, 10}, {95, 1005}, {99, 100}, {123, 456}, {1000, 1999}, {7, 7}, {10, 5999}, {4, 998, 2}}) {
    const std::regex pattern(index_pattern(range));
    for (int i = 0; i <= 6100; ++i) {
      ASSERT_EQ(std::regex_match(std::to_string(i), pattern), range.contains(i)) << i << " by " << index_pattern(range);
      matched += range.contains(i);
    }
  }
  EXPECT_GT(matched, 19'000);
}

// As the reader takes them.
TEST(IndexPattern, TakesZerosBeforeANumberAndNothingElse) {
  const std::regex pattern(index_pattern({0, 100'000})), even(index_pattern({2, 12, 2}));
  for (const char* one : {"0", "00", "007", "100000"}) EXPECT_TRUE(std::regex_search(one, pattern)) << one;
  for (const char* one : {"", "-0", "-1", "+1", "1.5", "1e2", " 1", "1 ", "x1", "100001", "200000", "1000000"}) EXPECT_FALSE(std::regex_search(one, pattern)) << one;
  for (const char* one : {"2", "012"}) EXPECT_TRUE(std::regex_search(one, even)) << one;
  for (const char* one : {"1", "14", "2x2", "1 2", ""}) EXPECT_FALSE(std::regex_search(one, even)) << one;
}

}  // namespace
}  // namespace sagitta::prescription
