// SPDX-License-Identifier: Apache-2.0
#include "lib/medium/figures.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lib/medium/formulas.h"
#include "lib/medium/spectral_lines.h"
#include "lib/medium/table.h"

namespace sagitta::medium {
namespace {

// N-BK7, Schott. Its data sheet (2014) prints nd 1.51680, Vd 64.17, ne 1.51872, Ve 63.96.
Medium n_bk7(double shortest_um = 0.3, double longest_um = 2.5) {
  return from_formula("N-BK7", *find_formula(2), {0, 1.03961212, 0.00600069867, 0.231792344, 0.0200179144, 1.01046945, 103.560653}, shortest_um, longest_um);
}

TEST(Figures, OfNBK7AreThoseOfItsDataSheet) {
  EXPECT_NEAR(n_bk7().index(lines::d_um), 1.51680, 0.5e-5);
  EXPECT_NEAR(n_bk7().index(lines::e_um), 1.51872, 0.5e-5);
  EXPECT_NEAR(abbe_number_d(n_bk7()), 64.17, 0.5e-2);
  EXPECT_NEAR(abbe_number_e(n_bk7()), 63.96, 0.5e-2);
}

TEST(Figures, GiveBackTheAbbeNumberThatAMediumIsMadeOf) {
  EXPECT_NEAR(abbe_number_d(from_nd_vd(1.6, 40)), 40, 1e-12);  // a quotient of differences of 0.015: 1e-16/0.015 * 40 a rounding
  EXPECT_TRUE(std::isnan(abbe_number_d(constant("", 1.5))));
  EXPECT_TRUE(std::isnan(abbe_number_e(air())));
}

TEST(Figures, AreNoneWhereTheRangeLacksALine) {
  EXPECT_TRUE(std::isnan(abbe_number_d(n_bk7(0.5, 2.5))));
  EXPECT_TRUE(std::isnan(abbe_number_d(n_bk7(0.3, 0.65))));
  EXPECT_FALSE(std::isnan(abbe_number_e(n_bk7(0.3, 0.65))));
  EXPECT_TRUE(std::isnan(slope_per_um(n_bk7(), 0.29)));
}

// 2 n dn/dL = -2 L sum of K C/(L^2 - C)^2, by hand from the formula.
TEST(Figures, TheSlopeIsTheDerivativeAlsoAtTheEnds) {
  const Medium glass = n_bk7();
  int compared = 0;
  for (const double um : {0.3, 0.30001, 0.4, 0.5875618, 1.0, 2.4999, 2.5}) {
    const auto term = [&](double K, double C) { return K * C / std::pow(um * um - C, 2); };
    const double slope = -um / glass.index(um) * (term(1.03961212, 0.00600069867) + term(0.231792344, 0.0200179144) + term(1.01046945, 103.560653));
    // Rounding: up to 128 * 2.2e-16 n over 12 h, h = L/2000, is 8e-12 on one side; the formula's error is below 1e-9 of n/L.
    EXPECT_NEAR(slope_per_um(glass, um), slope, 1e-9 * glass.index(um) / um) << um;
    EXPECT_NEAR(group_index(glass, um), glass.index(um) - um * slope, 1e-9 * glass.index(um)) << um;
    ++compared;
  }
  EXPECT_EQ(compared, 7);
  EXPECT_EQ(slope_per_um(constant("", 1.5), 0.5), 0);
  EXPECT_EQ(group_index(constant("", 1.5), 0.5), 1.5);
}

TEST(Figures, ATableHasNoSlope) {
  const Medium table = from_table("", {{0.4, 1.5}, {0.5, 1.4}, {0.7, 1.3}});
  EXPECT_TRUE(std::isnan(slope_per_um(table, 0.45)));
  EXPECT_TRUE(std::isnan(group_index(table, 0.5)));
  EXPECT_EQ(table.dispersion->kind(), "table of 3");
}

TEST(SpectralLines, AreInOrder) {
  for (std::size_t i = 1; i < spectral_lines.size(); ++i) EXPECT_LT(spectral_lines[i - 1].wavelength_um, spectral_lines[i].wavelength_um);
}

}  // namespace
}  // namespace sagitta::medium
