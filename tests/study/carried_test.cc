// SPDX-License-Identifier: Apache-2.0
// Numbers that carry their rounding and their derivatives, against 50 digits and differences.
#include "lib/study/carried_internal.h"

#include <gtest/gtest.h>

#include "lib/gradient_index/forms.h"
#include "lib/study/fifty_digits_internal.h"
#include "tests/support/point_sets.h"

namespace sagitta::study {
namespace {

using numerics::Vec3;

TEST(Carried, RoundingIsThatOfEveryOperation) {
  const Carried third = Carried(1) / Carried(3);
  EXPECT_EQ(third.value, 1.0 / 3);
  EXPECT_EQ(third.rounding, 0x1p-53 / 3);
  const Carried sum = third + third;
  EXPECT_EQ(sum.rounding, 2 * third.rounding + 0x1p-53 * (2.0 / 3));
  const Carried difference = third - third;
  EXPECT_EQ(difference.value, 0);
  EXPECT_EQ(difference.rounding, 2 * third.rounding);
  EXPECT_GT((Carried(1) / difference).rounding, 1e300);  // no bound
  EXPECT_EQ(abs(Carried(-2)).value, 2);
}

// x^2 y/(x - y) + sqrt(y), by x and by y.
TEST(Carried, SlopesAreDerivatives) {
  const auto of = []<class T>(const T& x, const T& y) {
    using std::sqrt;
    return x * x * y / (x - y) + sqrt(y);
  };
  Carried x(3), y(2);
  x.slopes[0] = 1, y.slopes[5] = 1;
  const Carried f = of(x, y);
  EXPECT_DOUBLE_EQ(f.slopes[0], (2 * 3 * 2 * 1 - 9 * 2) / 1.0);
  EXPECT_DOUBLE_EQ(f.slopes[5], (9 * 1 + 9 * 2) / 1.0 + .5 / std::sqrt(2.0));
  EXPECT_EQ(f.slopes[1], 0);
}

// At random places of every form with random numbers the exact one is within what is carried, and not far within on the whole.
TEST(Carried, HoldsTheRoundingOfEveryMedium) {
  tests::Uniform u(5);
  double worst = 0;
  int checked = 0;
  gradient_index::for_each_form([&]<class Form>(Form) {
    for (int i = 0; i < 500; ++i) {
      Form form;
      form.index = u(1.2, 1.8);
      if constexpr (requires { form.g; }) form.g = u(0, .3);
      if constexpr (requires { form.radius; }) form.radius = u(2, 9), form.centre_z = u(-3, 3);
      if constexpr (requires { form.linear; }) form.linear = {u(-.1, .1), u(-.1, .1), u(-.1, .1)}, form.quadratic = {u(-.1, .1), u(-.1, .1), u(-.1, .1)};
      if constexpr (requires { form.z_degree; }) form.z_degree = 3, form.r_degree = 2, form.z = {0, u(-.1, .1), u(-.1, .1), u(-.1, .1)}, form.r = {0, u(-.1, .1), u(-.01, .01)};
      const Vec3<double> place{u(-1, 1), u(-1, 1), u(-1, 1)};
      const auto at = form.at(numerics::vec3_cast<Carried>(place));
      const auto exact = form.at(numerics::vec3_cast<FiftyDigits>(place));
      const auto compare = [&](const Carried& carried, const FiftyDigits& truth) {
        if (carried.rounding == 0) return;
        worst = std::max(worst, static_cast<double>(abs(FiftyDigits(carried.value) - truth)) / carried.rounding);
        ++checked;
      };
      compare(at.squared_index, exact.squared_index);
      compare(at.pull.x, exact.pull.x), compare(at.pull.z, exact.pull.z);
    }
  });
  EXPECT_GT(checked, 5 * 500 * 2);
  EXPECT_LE(worst, 1);
  EXPECT_GT(worst, .3);
}

}  // namespace
}  // namespace sagitta::study
