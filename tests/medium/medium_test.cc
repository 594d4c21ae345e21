// SPDX-License-Identifier: Apache-2.0
#include "lib/medium/medium.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "lib/medium/formulas.h"
#include "lib/medium/shifted.h"
#include "lib/medium/table.h"

namespace sagitta::medium {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

TEST(Medium, AirHasIndexOneAtEveryWavelength) {
  EXPECT_EQ(air().name, "air");
  for (const double wavelength_um : {0.001, 0.543, 10.6, 1e6}) EXPECT_EQ(air().index(wavelength_um), 1);
}

TEST(Medium, AConstantIsTheSameAtEveryWavelengthAndAnIndexOnlyWhenPositiveAndFinite) {
  EXPECT_EQ(constant("", 1.376).index(0.3), 1.376);
  EXPECT_EQ(constant("", 1.376).index(30), 1.376);
  for (const double wrong : {0.0, -1.5, infinity, nan}) EXPECT_TRUE(std::isnan(constant("", wrong).index(0.5)));
}

TEST(Medium, NdAndVdComeBack) {
  int compared = 0;
  for (const double nd : {1.3, 1.5168, 1.62004, 2.1}) {
    for (const double vd : {20.0, 36.37, 64.17, 95.0}) {
      const Medium medium = from_nd_vd(nd, vd);
      EXPECT_EQ(medium.index(0.5875618), nd);
      // nF - nC is a difference of numbers of size n, each rounded to n * 1.1e-16 a few times: Vd (n eps * 4)/(nF - nC).
      const double difference = medium.index(0.4861327) - medium.index(0.6562725);
      EXPECT_NEAR((nd - 1) / difference, vd, vd * 4 * nd * 1.2e-16 / difference);
      EXPECT_GT(difference, 0);
      ++compared;
    }
  }
  EXPECT_EQ(compared, 16);
}

TEST(Medium, AnInfiniteAbbeNumberMeansNoDispersion) { EXPECT_EQ(from_nd_vd(1.5, infinity).index(0.4), 1.5); }

TEST(Medium, ATwoTermCauchyIsLinearInTheInverseSquareOfTheWavelength) {
  const Medium medium = from_nd_vd(1.5168, 64.17);
  const auto at = [&](double x) { return medium.index(1 / std::sqrt(x)); };
  // Differences of three indices of size 1.5, each with a few roundings.
  EXPECT_NEAR(at(2) - 2 * at(3) + at(4), 0, 4e-15);
}

// Of Herzberger's interpolation the same as the shift of all four nodes, to what the sum of its weights differs from 1 by (shifted.h).
TEST(Medium, AShiftedOneRisesAndFallsAsTheOther) {
  const auto lens = [](double more) {
    return from_formula("lens", *find_formula("Navarro"), {1.4492 + more, 1.42625 + more, 1.4175 + more, 1.4097 + more}, 0.365, 1.014);
  };
  const Medium other = lens(0), medium = shifted(other, 1.43, 0.5893), by_nodes = lens(0.018);
  EXPECT_EQ(medium.name, "index 1.43 dispersing as lens");
  EXPECT_EQ(medium.index(0.5893), 1.43);
  for (const double um : {0.365, 0.4861, 0.6563, 1.014}) {
    EXPECT_EQ(medium.index(um), 1.43 + (other.index(um) - other.index(0.5893)));
    EXPECT_NEAR(shifted(other, other.index(0.5893) + 0.018, 0.5893).index(um), by_nodes.index(um), 0.018 * 2e-7);
    EXPECT_NE(other.index(um), other.index(0.5893));
  }
  EXPECT_TRUE(std::isnan(medium.index(0.36)));
  EXPECT_TRUE(std::isnan(medium.index(1.02)));
  EXPECT_TRUE(std::isnan(shifted(from_nd_vd(1.5, 30), 0.005, 0.4).index(0.7)));  // below every index
  EXPECT_FALSE(medium.dispersion->is_constant());
  EXPECT_TRUE(shifted(constant("", 1.4), 1.5, 0.5).dispersion->is_constant());
  EXPECT_TRUE(medium.dispersion->is_smooth());
  EXPECT_FALSE(shifted(from_table("", {{0.4, 1.4}, {0.5, 1.3}, {0.6, 1.25}}), 1.5, 0.5).dispersion->is_smooth());
}

TEST(Medium, TheEndsOfTheRangeBelongToItAlsoWhenGivenInNanometres) {
  const Medium medium = from_table("", {{0.3804, 1.3445}, {0.6001, 1.3360}});
  EXPECT_EQ(medium.index(0.3804), 1.3445);
  EXPECT_EQ(medium.index(0.6001), 1.3360);
  ASSERT_LT(380.4 / 1000, 0.3804);  // why there is a slack, at both ends
  ASSERT_GT(600.1 / 1000, 0.6001);
  EXPECT_EQ(medium.index(380.4 / 1000), 1.3445);
  EXPECT_EQ(medium.index(600.1 / 1000), 1.3360);
  for (const double outside : {0.3803999, 0.6001001, 0.0, -0.5, nan, infinity}) {
    EXPECT_FALSE(medium.covers(outside));
    EXPECT_TRUE(std::isnan(medium.index(outside))) << outside;
  }
}

TEST(Medium, AWavelengthWithoutIndexIsFoundInsideTheRange) {
  const Formula& sellmeier = *find_formula(1);
  EXPECT_EQ(wavelength_without_index(from_formula("", sellmeier, {0, 1, 0.1}, 0.3, 2.5)), std::nullopt);
  // n^2 = 1 + L^2/(L^2 - 1) is negative from L^2 = 1/2 on.
  const auto found = wavelength_without_index(from_formula("", sellmeier, {0, 1, 1}, 0.5, 2));
  ASSERT_TRUE(found.has_value());
  EXPECT_NEAR(*found, std::sqrt(0.5), 0.002);
  EXPECT_EQ(wavelength_without_index(from_formula("", *find_formula(5), {-1}, 0.3, 2.5)), 0.3);
  // Only at the very end: n = 1 - L/2 at L = 2.
  EXPECT_EQ(wavelength_without_index(from_formula("", *find_formula(5), {1, -0.5, 1}, 0.5, 2)), 2);
}

TEST(Table, GivesTheMeasuredIndexAtTheMeasuredWavelengths) {
  const std::vector<Sample> samples{{0.458, 1.3828}, {0.543, 1.3777}, {0.5893, 1.3760}, {0.6328, 1.3747}};
  const Medium medium = from_table("", samples);
  for (const Sample& sample : samples) EXPECT_EQ(medium.index(sample.wavelength_um), sample.index);
}

TEST(Table, IsLinearBetweenNeighbours) {
  const Medium medium = from_table("", {{0.5, 1.5}, {1, 1.25}, {2, 1.75}});
  EXPECT_EQ(medium.index(0.75), 1.375);
  EXPECT_EQ(medium.index(1.25), 1.375);
  EXPECT_EQ(medium.index(1.75), 1.625);
}

TEST(Table, OfOneRowHoldsAtThatWavelengthOnly) {
  const Medium medium = from_table("", {{0.5893, 1.333}});
  EXPECT_EQ(medium.index(0.5893), 1.333);
  EXPECT_EQ(medium.index(589.3 / 1000), 1.333);
  EXPECT_TRUE(std::isnan(medium.index(0.589)));
  EXPECT_TRUE(std::isnan(medium.index(0.59)));
}

TEST(Medium, ATableTellsWhereItWasMeasured) {
  EXPECT_EQ(from_table("lens", {{.458, 1.43}, {.543, 1.422}}).dispersion->measured_um(), (std::vector<double>{.458, .543}));
  EXPECT_TRUE(from_nd_vd(1.5, 60).dispersion->measured_um().empty());
}

TEST(Medium, AFormulaForVisibleLightIsExtrapolatedBeyond) {
  const Medium glass = from_nd_vd(1.5, 60);
  for (const Medium& one : {glass, shifted(glass, 1.4, .55)}) {
    for (const double um : {.38, .55, .78}) EXPECT_FALSE(one.is_extrapolated(um)) << um;
    for (const double um : {.3799, .7801, 10.}) EXPECT_TRUE(one.is_extrapolated(um)) << um;
    EXPECT_FALSE(one.is_extrapolated(1e-10));  // has no index
  }
  for (const Medium& one : {air(), constant("index 1.4", 1.4), from_table("lens", {{.1, 1.43}, {10, 1.422}})}) EXPECT_FALSE(one.is_extrapolated(1));
}

}  // namespace
}  // namespace sagitta::medium
