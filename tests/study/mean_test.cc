// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "lib/study/mean.h"

namespace sagitta::test {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();

// All sums and quotients are exact in binary; one rounding of the root.
TEST(Mean, IsThatOfTheFormula) {
  const study::Mean pair = study::mean_of(std::array{1.0, 3.0});
  EXPECT_EQ(pair.mean, 2);
  EXPECT_EQ(pair.deviation, std::sqrt(2.0));
  EXPECT_EQ(pair.count, 2);
  const study::Mean eight = study::mean_of(std::array{2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0});  // squares about 5: 9, 1, 1, 1, 0, 0, 4, 16
  EXPECT_EQ(eight.mean, 5);
  EXPECT_EQ(eight.deviation, std::sqrt(32.0 / 7));
  EXPECT_EQ(study::mean_of(std::array{0x1p52, 0x1p52 + 4}).deviation, std::sqrt(8.0));  // squares of the values would not have the digits
}

TEST(Mean, LeavesOutWhatIsNoNumber) {
  const study::Mean mean = study::mean_of(std::array{nan, 1.0, infinity, 3.0, -infinity});
  EXPECT_EQ(mean.mean, 2);
  EXPECT_EQ(mean.deviation, std::sqrt(2.0));
  EXPECT_EQ(mean.count, 2);
  const study::Mean one = study::mean_of(std::array{7.0, nan});
  EXPECT_EQ(one.mean, 7);
  EXPECT_TRUE(std::isnan(one.deviation));
  EXPECT_EQ(one.count, 1);
  const study::Mean none = study::mean_of(std::array{nan});
  EXPECT_TRUE(std::isnan(none.mean));
  EXPECT_TRUE(std::isnan(none.deviation));
  EXPECT_EQ(none.count, 0);
}

}  // namespace
}  // namespace sagitta::test
