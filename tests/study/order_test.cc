// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "lib/study/order.h"

namespace sagitta::study {
namespace {

TEST(Order, IsThePowerOfAPowerLaw) {
  const std::array x{.1, .2, .5, 2.0}, y{3e-3, 12e-3, 75e-3, 1.2};  // 0.3 x^2
  const Order order = order_of(x, y);
  EXPECT_NEAR(order.slope, 2, 1e-14);
  EXPECT_NEAR(order.factor, .3, 1e-14);
  EXPECT_NEAR(order.standard_error, 0, 1e-14);
  EXPECT_EQ(order.pairs, 4);
}

// By hand: X = -1, 0, 1 and Y = 0, 0, 3 in natural logarithms. Slope 3/2; residuals 1/2, -1, 1/2: (3/2)/(1 x 2) under the root.
TEST(Order, HasItsStandardError) {
  const double e = std::exp(1.0);
  const std::array x{1 / e, 1.0, e}, y{1.0, 1.0, e * e * e};
  const Order order = order_of(x, y);
  EXPECT_NEAR(order.slope, 1.5, 1e-14);
  EXPECT_NEAR(order.standard_error, std::sqrt(.75), 1e-14);
}

TEST(Order, LeavesOutWhatHasNoLogarithm) {
  const std::array x{1.0, 2.0, 4.0, 8.0, 16.0}, y{1.0, 2.0, 0.0, std::nan(""), 16.0};
  const Order order = order_of(x, y);
  EXPECT_NEAR(order.slope, 1, 1e-14);
  EXPECT_EQ(order.pairs, 3);
  EXPECT_TRUE(std::isnan(order_of(std::array{1.0, 1.0}, std::array{2.0, 3.0}).slope));
  EXPECT_TRUE(std::isnan(order_of(std::array{1.0, 2.0}, std::array{2.0, 3.0}).standard_error));
}

}  // namespace
}  // namespace sagitta::study
