// SPDX-License-Identifier: Apache-2.0
// Each formula against the same published expression, written out term by term in 50 digits with the coefficients as
// decimal texts: one published medium a formula, by refractiveindex.info's database.
#include "lib/medium/formulas.h"

#include <gtest/gtest.h>

#include <boost/multiprecision/cpp_dec_float.hpp>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <string>
#include <vector>

namespace sagitta::medium {
namespace {

// Without expression templates: a lambda would return an expression of its own locals.
using Real = boost::multiprecision::number<boost::multiprecision::cpp_dec_float<50>, boost::multiprecision::et_off>;
using Coefficients = std::vector<Real>;

struct Case {
  std::string formula;
  std::string medium;
  std::vector<std::string> coefficients;
  double shortest_um, longest_um;
  std::function<Real(const Coefficients&, Real)> index;  // c[1] is C1
};

Real square(const Real& x) { return x * x; }

const std::vector<Case>& cases() {
  static const std::vector<Case> all = {
      {"1", "fused silica, Malitson 1965",
       {"0", "0.6961663", "0.0684043", "0.4079426", "0.1162414", "0.8974794", "9.896161"}, 0.21, 6.7,
       [](const Coefficients& c, Real w) {
         return sqrt(1 + c[1] + c[2] / (1 - square(c[3] / w)) + c[4] / (1 - square(c[5] / w)) + c[6] / (1 - square(c[7] / w)));
       }},
      {"2", "N-BK7, Schott",
       {"0", "1.03961212", "0.00600069867", "0.231792344", "0.0200179144", "1.01046945", "103.560653"}, 0.3, 2.5,
       [](const Coefficients& c, Real w) {
         const Real w2 = w * w;
         return sqrt(1 + c[1] + c[2] / (1 - c[3] / w2) + c[4] / (1 - c[5] / w2) + c[6] / (1 - c[7] / w2));
       }},
      {"3", "BeAl6O10 alpha, Pestryakov 1997", {"2.986556", "0.01828907", "-2", "-0.01445419", "2"}, 0.43, 1.1,
       [](const Coefficients& c, Real w) { return sqrt(c[1] + c[2] / (w * w) + c[4] * w * w); }},
      {"4", "proustite e, Hulme 1967", {"6.346", "0.342", "0", "0.09", "1", "0", "0", "0", "1", "-0.0011", "2"}, 0.59, 4.6,
       [](const Coefficients& c, Real w) { return sqrt(c[1] + c[2] / (w * w - c[4]) + c[10] * w * w); }},
      {"4", "made up, every coefficient in use",
       {"2.1", "0.3", "1.5", "0.2", "2", "-0.05", "2", "90", "0.5", "0.01", "-1", "-0.003", "3"}, 0.4, 2,
       [](const Coefficients& c, Real w) {
         return sqrt(c[1] + c[2] * w * sqrt(w) / (w * w - c[4] * c[4]) + c[6] * w * w / (w * w - sqrt(c[8])) + c[10] / w +
                     c[12] * w * w * w);
       }},
      {"5", "soda lime glass, bronze, Rubin 1985", {"1.5130", "-0.003169", "2", "0.003962", "-2"}, 0.32, 4.6,
       [](const Coefficients& c, Real w) { return c[1] + c[2] * w * w + c[4] / (w * w); }},
      {"6", "air, Ciddor 1996", {"0", "0.05792105", "238.0185", "0.00167917", "57.362"}, 0.23, 1.69,
       [](const Coefficients& c, Real w) {
         const Real w2 = w * w;
         return 1 + c[1] + c[2] * w2 / (c[3] * w2 - 1) + c[4] * w2 / (c[5] * w2 - 1);
       }},
      {"6", "5PCH e, Wu 1993", {"0.4560", "1.7501", "25.0000", "1.1423", "18.1077"}, 0.4, 0.8,
       [](const Coefficients& c, Real w) {
         const Real w2 = w * w;
         return 1 + c[1] + c[2] * w2 / (c[3] * w2 - 1) + c[4] * w2 / (c[5] * w2 - 1);
       }},
      {"7", "silicon, Edwards 1980", {"3.41983", "0.159906", "-0.123109", "1.26878E-6", "-1.95104E-9"}, 2.4373, 25,
       [](const Coefficients& c, Real w) {
         const Real d = w * w - Real("0.028");
         return c[1] + c[2] / d + c[3] / (d * d) + c[4] * w * w + c[5] * w * w * w * w;
       }},
      {"7", "made up, every coefficient in use", {"1.5", "0.01", "-0.0002", "0.003", "-0.002", "0.0005"}, 0.4, 1.5,
       [](const Coefficients& c, Real w) {
         const Real d = w * w - Real("0.028");
         return c[1] + c[2] / d + c[3] / (d * d) + c[4] * pow(w, 2) + c[5] * pow(w, 4) + c[6] * pow(w, 6);
       }},
      {"8", "silver bromide, Schroeter 1931", {"0.452505", "0.09939", "0.070537", "-0.000150"}, 0.495, 0.67,
       [](const Coefficients& c, Real w) {
         const Real b = c[1] + c[2] / (1 - c[3] / (w * w)) + c[4] * w * w;
         return sqrt(3 / (1 - b) - 2);
       }},
      {"9", "urea e, Rosker 1985", {"2.51527", "0.0240", "0.0300", "0.020", "1.52", "0.8771"}, 0.3, 1.06,
       [](const Coefficients& c, Real w) {
         const Real d = w - c[5];
         return sqrt(c[1] + c[2] / (w * w - c[3]) + c[4] / (d + c[6] / d));
       }},
      {"Cornu", "lens, Le Grand", {"1.3999", "9.2492e-3", "0.130"}, 0.38, 0.78,
       [](const Coefficients& c, Real w) { return c[1] + c[2] / (w - c[3]); }},
      {"Navarro", "lens, Navarro 1985", {"1.4492", "1.42625", "1.4175", "1.4097"}, 0.365, 1.014,
       [](const Coefficients& c, Real w) {
         const Real f = 1 / (w * w - square(Real("0.1673")));
         const auto weight = [&](const char* A, const char* B, const char* P, const char* R) { return Real(A) + Real(B) * w * w + Real(P) * f + Real(R) * f * f; };
         return weight("0.66147196", "-0.40352796", "-0.28046790", "0.03385979") * c[1] + weight("-4.20146383", "2.73508956", "1.50543784", "-0.11593235") * c[2] + weight("6.29834237", "-4.69409935", "-1.57508650", "0.10293038") * c[3] + weight("-1.75835059", "2.36253794", "0.35011657", "-0.02085782") * c[4];
       }},
  };
  return all;
}

Medium medium_of(const Case& one) {
  std::vector<double> coefficients;
  for (const std::string& text : one.coefficients) coefficients.push_back(std::strtod(text.c_str(), nullptr));
  return from_formula(one.medium, *find_formula(one.formula), coefficients, one.shortest_um, one.longest_um);
}

TEST(Formulas, AreNumberedFromOneToNineAndThenHaveNames) {
  int number = 0;
  std::vector<std::string> named;
  for (const Formula& formula : formulas()) {
    if (formula.number == 0)
      named.emplace_back(formula.name);
    else
      EXPECT_EQ(formula.number, ++number) << formula.name;
  }
  EXPECT_EQ(number, 9);
  EXPECT_EQ(named, (std::vector<std::string>{"Cornu", "Navarro"}));
  EXPECT_EQ(find_formula(0), nullptr);
  EXPECT_EQ(find_formula(10), nullptr);
}

TEST(Formulas, AreFoundByWhatStandsInAFile) {
  EXPECT_EQ(find_formula("2"), find_formula(2));
  EXPECT_EQ(find_formula("Cornu")->name, "Cornu");
  for (const std::string none : {"", "0", "10", "02", "2 ", "cornu", "Sellmeier", "-1"}) EXPECT_EQ(find_formula(none), nullptr) << none;
  EXPECT_EQ(title_of(*find_formula("2")), "formula 2 (Sellmeier-2)");
  EXPECT_EQ(title_of(*find_formula("Cornu")), "formula Cornu");
}

TEST(Formulas, AgreeWithFiftyDigitsOverTheWholeRange) {
  // At most 20 operations of half an ulp (pow: one) act on the sum. A fraction makes its denominator's rounding grow by
  // L^2/(L^2 - C): at most 1.5, fused silica at 0.21 um. Silver bromide's 1/(1 - b) makes b's grow by 3 b/((1 - b)^2 n^2):
  // 2 at 0.495 um. The others are milder. 20 * 1.5 * 2 * 1.1e-16 = 7e-15. Navarro's sixteen terms cancel: at
  // 0.365 um, the worst, their sizes add up to 73 n, and each goes through at most 16 roundings: 73 * 16 * 1.1e-16 = 1.3e-13.
  const auto bound_of = [](const Case& one) { return one.formula == "Navarro" ? 1.3e-13 : 7e-15; };
  int compared = 0;
  for (const Case& one : cases()) {
    const Medium medium = medium_of(one);
    Coefficients exact{0};
    for (const std::string& text : one.coefficients) exact.emplace_back(text);
    for (int i = 0; i <= 40; ++i, ++compared) {
      const double wavelength_um = one.shortest_um + (one.longest_um - one.shortest_um) * i / 40;
      const double expected = one.index(exact, Real(wavelength_um)).convert_to<double>();
      EXPECT_NEAR(medium.index(wavelength_um) / expected, 1, bound_of(one)) << one.medium << " at " << wavelength_um;
    }
  }
  EXPECT_EQ(compared, 14 * 41);
}

TEST(Formulas, GiveThePublishedIndices) {
  struct Published {
    std::size_t i;
    double wavelength_um, index, tolerance;
  };
  // E20 (Schott), 1e-6; Malitson's table for fused silica at the d line prints 1.45846; Ciddor's air has
  // n - 1 = 2.765e-4 at 0.633 um.
  for (const Published& p : {Published{1, 0.5875618, 1.5168000, 1e-6}, {1, 0.6328, 1.5150892, 1e-6},
                             {0, 0.5875618, 1.45846, 5e-6}, {6, 0.633, 1.0002765, 5e-8}})
    EXPECT_NEAR(medium_of(cases()[p.i]).index(p.wavelength_um), p.index, p.tolerance) << cases()[p.i].medium;
}

TEST(Formulas, AcceptOnlyWholeTerms) {
  const auto accepted = [](int number) {
    std::vector<std::size_t> counts;
    for (std::size_t count = 0; count <= 13; ++count)
      if (find_formula(number)->accepts(count)) counts.push_back(count);
    return counts;
  };
  using Counts = std::vector<std::size_t>;
  for (const int number : {1, 2, 3, 5, 6}) EXPECT_EQ(accepted(number), (Counts{1, 3, 5, 7, 9, 11, 13})) << number;
  EXPECT_EQ(accepted(4), (Counts{5, 9, 11, 13}));
  EXPECT_EQ(accepted(7), (Counts{3, 4, 5, 6}));
  EXPECT_EQ(accepted(8), (Counts{4}));
  EXPECT_EQ(accepted(9), (Counts{6}));
}

TEST(Formulas, LeaveOutTermsThatTheFileFillsWithZeros) {
  // 0^0 = 1 would divide zero by zero at L = 1.
  const Medium medium = from_formula("", *find_formula(4), {4, 0, 0, 0, 0, 0, 0, 0, 0, 5, -2}, 0.5, 2);
  EXPECT_EQ(medium.index(1), 3);
  // A fraction alone: n^2 = 1 + 6/(4 - 2) = 4 at L = 2.
  EXPECT_EQ(from_formula("", *find_formula(4), {1, 6, 0, 2, 1}, 1.5, 3).index(2), 2);
}

TEST(Formulas, GiveNaNWhereThereIsNoPhysicalIndex) {
  const auto index = [](int number, std::vector<double> coefficients, double wavelength_um) {
    return from_formula("", *find_formula(number), std::move(coefficients), 0.1, 10).index(wavelength_um);
  };
  EXPECT_TRUE(std::isnan(index(1, {0, 1, 0.5}, 0.5)));     // the pole
  EXPECT_TRUE(std::isnan(index(1, {0, 1, 0.5}, 0.45)));    // n^2 = 1 - 4.3
  EXPECT_TRUE(std::isnan(index(2, {-1, 1, 0.25}, 0.5)));   // the pole
  EXPECT_TRUE(std::isnan(index(3, {-1}, 0.5)));            // n^2 = -1
  EXPECT_TRUE(std::isnan(index(3, {0}, 0.5)));             // n = 0
  EXPECT_TRUE(std::isnan(index(5, {-1.5}, 0.5)));          // n < 0
  EXPECT_TRUE(std::isnan(index(6, {0, 1, 4}, 0.5)));       // the pole
  EXPECT_TRUE(std::isnan(index(8, {1, 0, 0, 0}, 0.5)));    // refractivity 1: infinite
  EXPECT_TRUE(std::isnan(index(8, {2, 0, 0, 0}, 0.5)));    // beyond it
  EXPECT_TRUE(std::isnan(index(9, {1, 1, 0.25, 0, 0, 1}, 0.5)));
}

}  // namespace
}  // namespace sagitta::medium
