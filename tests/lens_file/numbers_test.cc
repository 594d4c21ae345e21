// SPDX-License-Identifier: Apache-2.0
#include "lib/lens_file/numbers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace sagitta::lens_file {
namespace {

TEST(NumbersOfLensFiles, are_decimal_numbers_as_a_whole) {
  EXPECT_EQ(parse_real("1.5"), 1.5L);
  EXPECT_EQ(parse_real("-3.0E-002"), -0.03L);
  EXPECT_EQ(parse_real("+2"), 2.0L);
  EXPECT_EQ(parse_real(".5"), 0.5L);
  EXPECT_EQ(parse_real("1e-99999"), 0.0L);
  for (const char* text : {"", "-", "+", "--1", "+-1", "1,5", "1.5mm", "0x10", "nan", "inf", "-inf", "INFINITY", "1e31", "1e99999", "e5"}) EXPECT_FALSE(parse_real(text)) << text;
}

// Neither tenths nor 25.4 are doubles: the product of the nearest ones is often another double than the one nearest to the product.
TEST(NumbersOfLensFiles, keep_their_decimals_when_units_are_converted) {
  int differs = 0;
  for (int tenths = 1; tenths <= 1000; ++tenths) {
    const std::string text = std::to_string(tenths / 10) + "." + std::to_string(tenths % 10);
    const double meant = std::strtod((std::to_string(tenths * 254 / 100) + "." + std::to_string(tenths * 254 % 100 / 10) + std::to_string(tenths * 254 % 10)).c_str(), nullptr);
    EXPECT_EQ(static_cast<double>(*parse_real(text) * 25.4L), meant) << text;
    differs += std::strtod(text.c_str(), nullptr) * 25.4 != meant;
  }
  EXPECT_GT(differs, 100);
}

TEST(Radius, has_the_fewest_digits_whose_inverse_is_the_curvature) {
  EXPECT_EQ(number_text(radius_of(1 / Real(12.875))), "12.875");
  EXPECT_EQ(number_text(radius_of(*parse_real("7.766990291262135200E-002"))), "12.875");
  EXPECT_EQ(number_text(radius_of(0.01L)), "100");
  EXPECT_EQ(number_text(radius_of(-0.0L)), ".inf");
  EXPECT_EQ(radius_of(0), std::numeric_limits<double>::infinity());
  std::mt19937_64 random(7);
  int exact = 0;
  for (int i = 0; i < 2000; ++i) {
    const double c = std::exp(std::normal_distribution<double>(0, 3)(random)) * (i % 2 == 0 ? 1 : -1), radius = radius_of(c);
    exact += 1 / radius == c;
    EXPECT_LE(std::abs(1 / radius - c), 1.0000001 * std::numeric_limits<double>::epsilon() * std::abs(c));  // not every double is an inverse
  }
  EXPECT_GT(exact, 1500);
}

// 2026-11-23: 0.0152045005321575 became 65.77000000000008, which no one wrote.
TEST(Radius, has_the_fewest_digits_that_a_curvature_of_ten_digits_or_more_can_mean) {
  struct Case {
    const char *curvature, *radius;
  };
  for (const auto& [curvature, radius] : {Case{"0.0152045005321575", "65.77"}, Case{"-1.78635226866738e-2", "-55.98"}, Case{"-0.0035644270183568", "-280.55"}, Case{"+8.496176720475789867E-02", "11.769999999999994"},
                                          // one unit more in its last digit is another radius
                                          Case{"0.0152045005321576", "65.7699999999996"}, Case{"0.02000000000", "50"},
                                          // fewer digits are what was meant
                                          Case{"0.1", "10"}, Case{"0.33", "3.0303030303030303"}, Case{"0.3333333", "3.00000030000003"}, Case{"0.333333333", "3.000000003"}, Case{"0.3333333333", "3"}, Case{"3", "0.3333333333333333"}})
    EXPECT_EQ(number_text(radius_of(*parse_real(curvature), half_a_digit(curvature))), radius) << curvature;
  EXPECT_EQ(half_a_digit("-1.25E+02"), 0.5L);
  EXPECT_EQ(half_a_digit("12"), 0.5L);
}

TEST(Rounded, is_the_shortest_decimal_within_the_error) {
  EXPECT_EQ(shortest_within(-8.438645L + 1e-18L, 1e-17L), -8.438645);
  EXPECT_EQ(shortest_within(1e-19L, 1e-18L), 0);
  EXPECT_EQ(shortest_within(1.0L / 3, 1e-3L), 0.333);
  EXPECT_EQ(shortest_within(1.0L / 3, 0), 1.0 / 3);
  EXPECT_EQ(number_text(-0.0), "0");
  EXPECT_EQ(number_text(1e-5), "1e-05");
  EXPECT_EQ(power(10, -3), 0.001L);
  EXPECT_EQ(power(25.4L, 0), 1);
}

}  // namespace
}  // namespace sagitta::lens_file
