// SPDX-License-Identifier: Apache-2.0
// The grammar of values that are computed: what it gives, and where it says what is wrong.
#include "lib/prescription/expression.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace sagitta::prescription {
namespace {

const std::vector<ParameterValue> parameters{{"accommodation_D", 4}, {"x", -2}, {"zero", 0}};

double value_of(const std::string& text) {
  const Evaluation evaluation = evaluate("=" + text, parameters);
  EXPECT_FALSE(evaluation.fault) << text << ": " << evaluation.fault->what;
  return evaluation.value;
}

TEST(Expression, HasTheValueOfItsArithmetic) {
  struct Case {
    const char* text;
    double value;
  };
  const Case cases[]{{"12", 12}, {" 12.0 - 0.4 * accommodation_D ", 12.0 - 0.4 * 4}, {".5", 0.5}, {"9e-5", 9e-5}, {"2.", 2},
                     {"1 - 2 - 3", -4}, {"24 / 4 / 3", 2}, {"24 / 4 * 3", 18}, {"2 + 3 * 4", 14}, {"(2 + 3) * 4", 20},
                     {"-2^2", -4}, {"(-2)^2", 4}, {"2^3^2", 512}, {"2^-1", 0.5}, {"x^3", -8}, {"2*-x", 4}, {"--1", 1}, {"+-+1", -1}, {"3 - -x", 1},
                     {"zero * 5", 0}, {"0^0", 1}, {"\t1\n+ 1", 2},
                     {"ln(1)", 0}, {"exp(0)", 1}, {"sqrt(16)", 4}, {"abs(x)", 2}, {"min(3, x, 1)", -2}, {"max(3, x, 1)", 3}, {"max(5)", 5},
                     {"cos_deg(0)", 1}, {"sin_deg(0)", 0}, {"tan_deg(0)", 0}, {"ln (1)", 0}, {"min(1, 2)^2 * 3", 3}};
  for (const Case& one : cases) EXPECT_EQ(value_of(one.text), one.value) << one.text;
  EXPECT_EQ(value_of("ln(accommodation_D + 1)"), std::log(5.0));
  EXPECT_EQ(value_of("exp(x)"), std::exp(-2.0));
  // An angle of up to 60 degrees is rounded twice on its way to radians, which the slope of at most 4 (of the tangent) carries on.
  EXPECT_NEAR(value_of("sin_deg(30)"), 0.5, 4e-16);
  EXPECT_NEAR(value_of("cos_deg(60)"), 0.5, 4e-16);
  EXPECT_NEAR(value_of("tan_deg(45)"), 1, 1e-15);
  // 2026-11-23: tan_deg(90) was 1.6e16, sin_deg(180) 1.2e-16
  for (const char* zero : {"sin_deg(180)", "sin_deg(-360)", "cos_deg(90)", "cos_deg(-270)", "tan_deg(180)"}) EXPECT_EQ(value_of(zero), 0) << zero;
  for (const char* one : {"sin_deg(90)", "sin_deg(-270)", "cos_deg(360)", "-cos_deg(180)", "-sin_deg(270)", "-sin_deg(-90)"}) EXPECT_EQ(value_of(one), 1) << one;
  for (const double x : {-400.0, -333.3, -200.0, -135.0, -91.0, -45.0, -1.0, 1.0, 44.0, 45.0, 46.0, 100.0, 135.0, 225.0, 260.0, 315.0, 350.0, 1000.0}) {
    EXPECT_NEAR(value_of(fmt::format("sin_deg({})", x)), std::sin(x * std::numbers::pi / 180), 4e-15) << x;  // of 1000 degrees, 17 rad, to rounding
    EXPECT_NEAR(value_of(fmt::format("cos_deg({})", x)), std::cos(x * std::numbers::pi / 180), 4e-15) << x;
  }
}

TEST(Expression, NamesTheParametersThatItUses) {
  EXPECT_EQ(evaluate("= x * ln(accommodation_D) - x", parameters).used, (std::set<std::string>{"accommodation_D", "x"}));
  EXPECT_TRUE(evaluate("= 1 + 2", parameters).used.empty());
}

TEST(Expression, SaysWhatIsWrongWhereItIs) {
  struct Case {
    const char* text;
    std::size_t at;
    const char *what, *hint;
  };
  const char* functions = "the functions are: abs, exp, ln, sqrt, sin_deg, cos_deg, tan_deg, min, max";
  const Case cases[]{{"=", 1, "the expression ends where a value should stand", ""},
                     {"= 1 +", 5, "the expression ends where a value should stand", ""},
                     {"= 2 accommodation_D", 4, "'a' cannot stand here", "a product is written with *"},
                     {"= 2(3)", 3, "'(' cannot stand here", "a product is written with *"},
                     {"= 2 ** 3", 5, "'*' cannot stand here", "a power is written ^"},
                     {"= 1,5", 3, "',' cannot stand here", "decimals are written with a point"},
                     {"= 1 ; 2", 4, "';' cannot stand here", ""},
                     {"= 2 × 3", 4, "'×' cannot stand here", ""},
                     {"= .inf", 2, "'.' cannot stand here", "a product is written with *"},
                     {"= )", 2, "')' cannot stand here", ""},
                     {"= == 2", 2, "'=' cannot stand here", ""},
                     {"= 2 * (3 + 1", 6, "this '(' has no ')'", "quote the expression: in a line of [ ] or { } one with a comma needs quotes"},
                     {"= ln()", 5, "')' cannot stand here", ""},
                     {"= max(1, )", 9, "')' cannot stand here", ""},
                     {"= acommodation_D", 2, "there is no parameter 'acommodation_D'", "did you mean 'accommodation_D'?"},
                     {"= 3 * something", 6, "there is no parameter 'something'", "the parameters are: accommodation_D, x, zero"},
                     {"= ln 5", 2, "ln needs its argument in ( )", ""},
                     {"= sqr(5)", 2, "there is no function 'sqr'", "did you mean 'sqrt'?"},
                     {"= sin(5)", 2, "there is no function 'sin'", "write sin_deg: angles are in degrees"},
                     {"= log(5)", 2, "there is no function 'log'", "the natural logarithm is ln"},
                     {"= gamma(5)", 2, "there is no function 'gamma'", functions},
                     {"= sqrt(1, 2)", 2, "sqrt takes one argument, not 2", ""},
                     {"= 1 / zero", 4, "a division by 0", ""},
                     {"= tan_deg(90)", 2, "tan_deg(90) is no finite number", ""},
                     {"= tan_deg(-270)", 2, "tan_deg(-270) is no finite number", ""},
                     {"= ln(x)", 2, "ln(-2) is no finite number", ""},
                     {"= 1 + (x)^0.5", 9, "(-2)^(0.5) is no finite number", ""},
                     {"= zero^-1", 6, "(0)^(-1) is no finite number", ""},
                     {"= exp(1000)", 2, "exp(1000) is no finite number", ""},
                     {"= 1e300 * 1e300", 8, "1e+300 * 1e+300 is no finite number", ""},
                     {"= 1e999", 2, "a number beyond the range of numbers", ""}};
  for (const Case& one : cases) {
    const Evaluation evaluation = evaluate(one.text, parameters);
    ASSERT_TRUE(evaluation.fault) << one.text;
    EXPECT_EQ(evaluation.fault->at, one.at) << one.text;
    EXPECT_EQ(evaluation.fault->what, one.what) << one.text;
    EXPECT_EQ(evaluation.fault->hint, one.hint) << one.text;
  }
  EXPECT_EQ(evaluate("= x", {}).fault->hint, "the system declares none; parameters: {NAME: VALUE} does");
  EXPECT_EQ(evaluate("= acommodation_D", parameters, false).fault->hint, "");
}

TEST(Expression, IsBounded) {
  const auto nested = [](std::size_t depth) { return "=" + std::string(depth, '(') + "1" + std::string(depth, ')'); };
  EXPECT_EQ(evaluate(nested(49), {}).value, 1);
  EXPECT_EQ(evaluate(nested(50), {}).fault.value().what, "nested more than 50 deep");
  EXPECT_EQ(evaluate("=" + std::string(50, '-') + "1", {}).fault.value().what, "nested more than 50 deep");
  EXPECT_EQ(evaluate("=1" + std::string(998, ' '), {}).value, 1);
  EXPECT_EQ(evaluate("=1" + std::string(999, ' '), {}).fault.value().what, "an expression of 1001 bytes is longer than 1000");
  std::string powers = "=1";
  for (int i = 0; i < 60; ++i) powers += "^1";
  EXPECT_EQ(evaluate(powers, {}).fault.value().what, "nested more than 50 deep");
  std::string products = "=1";
  for (int i = 0; i < 400; ++i) products += "*1";  // side by side is not nested
  EXPECT_EQ(evaluate(products, {}).value, 1);
}

TEST(Expression, ANameOfAParameterIsOneThatAnExpressionCanHold) {
  for (const char* name : {"a", "accommodation_D", "X2", "sin"}) EXPECT_TRUE(is_parameter_name(name)) << name;
  for (const char* name : {"", "_a", "2x", "a b", "a-b", "é", "ln", "max", "sin_deg"}) EXPECT_FALSE(is_parameter_name(name)) << name;
  EXPECT_TRUE(is_parameter_name(std::string(64, 'a')));
  EXPECT_FALSE(is_parameter_name(std::string(65, 'a')));
}

}  // namespace
}  // namespace sagitta::prescription
