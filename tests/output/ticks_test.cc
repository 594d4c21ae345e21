// SPDX-License-Identifier: Apache-2.0
#include "lib/output/ticks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace sagitta::output {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr double inf = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

TEST(Ticks, StepsAreOneTwoOrFiveAndLabelsAreExact) {
  EXPECT_THAT(linear_ticks(0, 1, 6).values, ElementsAre(0, 0.2, 0.4, 0.6, 0.8, 1));
  EXPECT_THAT(linear_ticks(0, 1, 6).labels, ElementsAre("0.0", "0.2", "0.4", "0.6", "0.8", "1.0"));
  EXPECT_THAT(linear_ticks(0, 1, 5).labels, ElementsAre("0.0", "0.5", "1.0"));
  EXPECT_THAT(linear_ticks(-51.2, 51.2, 5).labels, ElementsAre("−40", "−20", "0", "20", "40"));
  EXPECT_THAT(linear_ticks(0, 178, 5).labels, ElementsAre("0", "50", "100", "150"));
  EXPECT_THAT(linear_ticks(-0.0031, 0.0002, 4).labels, ElementsAre("−0.003", "−0.002", "−0.001", "0.000"));
  EXPECT_THAT(linear_ticks(2.3449, 2.3453, 5).values, ElementsAre(2.3449, 2.345, 2.3451, 2.3452, 2.3453));
}

TEST(Ticks, CountsHaveWholeTicks) {
  EXPECT_THAT(linear_ticks(0, 1, 7, 1).labels, ElementsAre("0", "1"));
  EXPECT_THAT(linear_ticks(0, 3, 7, 1).labels, ElementsAre("0", "1", "2", "3"));
}

TEST(Ticks, EveryIntervalHasEnoughAndNotTooMany) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> mantissa(-1, 1), exponent(-12, 12);
  int checked = 0;
  for (int i = 0; i < 10000; ++i) {
    const double low = mantissa(random) * std::pow(10, exponent(random));
    const double high = low + std::pow(10, exponent(random));
    if (!(high - low > 1e-9 * std::abs(low))) continue;  // ticks would need more digits than a double has
    ++checked;
    const auto values = linear_ticks(low, high, 6).values;
    // The steps grow by at most 2.5, so the step before the last one taken had more than 6 ticks: at least 6 steps in
    // the interval before, 2.4 now, which hold 2 ticks wherever they start.
    ASSERT_GE(values.size(), 2U) << low << " " << high;
    ASSERT_LE(values.size(), 6U);
    const double slack = 2e-9 * (high - low);
    ASSERT_GE(values.front(), low - slack);
    ASSERT_LE(values.back(), high + slack);
  }
  EXPECT_GT(checked, 6000);
}

TEST(Ticks, AnIntervalThatIsNoneHasNoTicks) {
  EXPECT_THAT(linear_ticks(1, 1, 5).values, IsEmpty());
  EXPECT_THAT(linear_ticks(2, 1, 5).values, IsEmpty());
  EXPECT_THAT(linear_ticks(nan, 1, 5).values, IsEmpty());
  EXPECT_THAT(linear_ticks(0, inf, 5).values, IsEmpty());
  EXPECT_THAT(log_ticks(0, 1, 5).values, IsEmpty());
  EXPECT_THAT(log_ticks(nan, 1, 5).values, IsEmpty());
  EXPECT_LE(linear_ticks(1e17, 1e17 + 64, 5).values.size(), 5U);  // beyond 2^53: it ends
}

TEST(Ticks, LogarithmicTicksArePowersOfTenThinnedOrRefined) {
  EXPECT_THAT(log_ticks(1, 150, 7).labels, ElementsAre("1", "2", "5", "10", "20", "50", "100"));
  EXPECT_THAT(log_ticks(1, 150, 6).labels, ElementsAre("1", "10", "100"));
  EXPECT_THAT(log_ticks(0.01, 200000, 8).labels, ElementsAre("0.01", "0.1", "1", "10", "100", "1000", "10000", "10⁵"));
  EXPECT_THAT(log_ticks(1e-6, 1e6, 7).labels, ElementsAre("10⁻⁶", "10⁻⁴", "0.01", "1", "100", "10000", "10⁶"));
  EXPECT_THAT(log_ticks(150000, 600000, 7).labels, ElementsAre("2×10⁵", "5×10⁵"));
  EXPECT_THAT(log_ticks(6, 9, 5).labels, ElementsAre("6", "7", "8", "9"));
}

TEST(Ticks, AShortChartAxisHasOneTwoAndFive) {
  const ChartTicks decade = chart_ticks(2.5, 25, 12);
  EXPECT_THAT(decade.major.labels, ElementsAre("5", "10", "20"));
  EXPECT_THAT(decade.major.values, ElementsAre(5, 10, 20));
  EXPECT_THAT(decade.minor, ElementsAre(3, 4, 6, 7, 8, 9));
  EXPECT_THAT(chart_ticks(0.001, 0.1, 12).major.labels, ElementsAre("0.001", "0.002", "0.005", "0.01", "0.02", "0.05", "0.1"));
  // One label that would not be plain makes all of them powers.
  EXPECT_THAT(chart_ticks(0.0005, 0.01, 12).major.labels, ElementsAre("5×10⁻⁴", "10⁻³", "2×10⁻³", "5×10⁻³", "10⁻²"));
  EXPECT_THAT(chart_ticks(40000, 500000, 12).major.labels, ElementsAre("5×10⁴", "10⁵", "2×10⁵", "5×10⁵"));
  EXPECT_EQ(chart_ticks(1, 315, 12).major.labels.size(), 8U);  // 1 2 5 10 20 50 100 200
}

TEST(Ticks, ALongChartAxisHasPowersThinnedWhereTheyAreMany) {
  const ChartTicks four = chart_ticks(8, 20000, 12);
  EXPECT_THAT(four.major.labels, ElementsAre("10", "100", "1000", "10000"));
  EXPECT_THAT(four.minor, ElementsAre(8, 9, 20, 30, 40, 50, 60, 70, 80, 90, 200, 300, 400, 500, 600, 700, 800, 900, 2000, 3000, 4000, 5000, 6000, 7000, 8000,
                                      9000, 20000));
  EXPECT_THAT(chart_ticks(1, 317, 12).major.labels, ElementsAre("1", "10", "100"));
  EXPECT_THAT(chart_ticks(1e-9, 1e1, 12).major.labels,
              ElementsAre("10⁻⁹", "10⁻⁸", "10⁻⁷", "10⁻⁶", "10⁻⁵", "10⁻⁴", "10⁻³", "10⁻²", "10⁻¹", "10⁰", "10¹"));
  const ChartTicks thinned = chart_ticks(1e-9, 1e1, 10);
  EXPECT_THAT(thinned.major.labels, ElementsAre("10⁻⁸", "10⁻⁶", "10⁻⁴", "10⁻²", "10⁰"));
  EXPECT_THAT(thinned.minor, ElementsAre(1e-9, 1e-7, 1e-5, 1e-3, 1e-1, 1e1));
  EXPECT_LE(chart_ticks(1e-300, 1e300, 12).major.values.size(), 12U);
  for (const auto& [low, high] : {std::pair{0.0, 1.0}, std::pair{nan, 1.0}, std::pair{1.0, inf}, std::pair{2.0, 1.0}}) {
    EXPECT_THAT(chart_ticks(low, high, 12).major.values, IsEmpty());
    EXPECT_THAT(chart_ticks(low, high, 12).minor, IsEmpty());
  }
}

TEST(Ticks, LengthsHaveTheUnitTheirSizeAsksFor) {
  EXPECT_STREQ(length_unit(12).name, "mm");
  EXPECT_STREQ(length_unit(0.1).name, "µm");
  EXPECT_EQ(length_unit(0.1).per_mm, 1000);
  EXPECT_STREQ(length_unit(1e-5).name, "nm");
  EXPECT_EQ(length_unit(1e-5).per_mm, 1e6);
}

TEST(Ticks, VerySmallAndVeryLargeValuesAreMultiplesOfAPowerOfTen) {
  EXPECT_EQ(magnitude(3e-7).label, "×10⁻⁷ ");
  EXPECT_EQ(magnitude(3e-7).factor, 1e-7);
  EXPECT_EQ(magnitude(250000).label, "×10⁵ ");
  for (const double plain : {0.0, 0.01, 0.3, 99999.0, inf, nan}) {
    EXPECT_EQ(magnitude(plain).label, "");
    EXPECT_EQ(magnitude(plain).factor, 1);
  }
}

}  // namespace
}  // namespace sagitta::output
