// SPDX-License-Identifier: Apache-2.0
#include "lib/numerics/column_sum.h"

#include <gtest/gtest.h>

#include <vector>

#include "lib/numerics/instruction_set.h"

namespace sagitta::numerics {
namespace {

double sum_of(const std::vector<double>& terms) {
  ColumnSum sum;
  with_chosen_instructions_flat([&]<int n>() { sum.add<n>(terms.data(), terms.size()); });
  return sum.value();
}

// A 1 in each column, and behind it a thousand terms that a double cannot add to 1. 8000 * 2^-60 are 3.9 units of 2^-49, the last
// place of 8.
TEST(ColumnSum, keeps_what_is_too_small_for_its_sums) {
  std::vector<double> terms(8, 1.0);
  terms.insert(terms.end(), 8000, 0x1p-60);
  EXPECT_EQ(sum_of(terms), 8 + 4 * 0x1p-49);
  for (double& term : terms) term = -term;
  EXPECT_EQ(sum_of(terms), -8 - 4 * 0x1p-49);
}

// Large terms that cancel leave the small ones, whichever comes first.
TEST(ColumnSum, survives_cancellation) {
  std::vector<double> terms(8, 3.0);
  terms.insert(terms.end(), 8, 0x1p60);
  terms.insert(terms.end(), 8, -0x1p60);
  EXPECT_EQ(sum_of(terms), 24);
}

TEST(ColumnSum, of_nothing_is_zero_and_zeros_change_nothing) {
  EXPECT_EQ(sum_of({}), 0);
  EXPECT_EQ(sum_of({1, 2, 3, 0, 0, 0, 0, 0}), 6);
}

}  // namespace
}  // namespace sagitta::numerics
