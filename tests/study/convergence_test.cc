// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "lib/study/convergence.h"

namespace sagitta::study {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

TEST(Convergence, ErrorIsThatOfTheWorstNumber) {
  EXPECT_EQ(error_of({1, -4, 2}, {1.5, -1, 2}), 3);
  EXPECT_EQ(error_of({2, 2}, {2, 2}), 0);
  EXPECT_EQ(error_of({}, {1}), infinity);
  EXPECT_EQ(error_of({}, {}), infinity);
  EXPECT_EQ(error_of({1}, {1, 2}), infinity);
  EXPECT_EQ(error_of({std::nan(""), 1}, {1, 1}), infinity);
  EXPECT_EQ(error_of({1, std::nan("")}, {1, 1}), infinity);
}

// By hand: 7, 4, 5, 6 against the last: errors 1, 2, 1, 0; from there on 2, 2, 1, 0. No error stands clear of twice the last but one,
// so no law is fitted, and the truth is off by that one: 1.
TEST(Convergence, ClaimsTheWorstFromThereOnAndTheTruthsOwnError) {
  const std::array counts{100.0, 300.0, 1000.0, 3000.0};
  const std::array<Answer, 4> answers{Answer{7}, Answer{4}, Answer{5}, Answer{6}};
  const Truth truth = truth_of(counts, answers);
  EXPECT_EQ(truth.value, Answer{6});
  EXPECT_EQ(truth.uncertainty, 1);
  EXPECT_EQ(truth.clear_of, 2);
  const Settling settled = settling(answers, truth);
  EXPECT_EQ(settled.error, (std::vector<double>{1, 2, 1, 0}));
  EXPECT_EQ(settled.bound, (std::vector<double>{3, 3, 2, 1}));
  // another pattern, against the same truth
  const std::array<Answer, 3> others{Answer{6}, Answer{}, Answer{5.5}};
  const Settling other = settling(others, truth);
  EXPECT_EQ(other.error, (std::vector<double>{0, infinity, .5}));
  EXPECT_EQ(other.bound, (std::vector<double>{infinity, infinity, 1.5}));
}

// A = 5 + 8/N for N = 1, 4, 16, 64, but the last two agree by chance. The truth, 5.125, is off by 0.125. The errors 7.875 and 1.875 stand clear,
// and the law through them, 7.875 N^-p with 4^p = 7.875/1.875, is 7.875 (1.875/7.875)^3 = 0.106 at N = 64.
TEST(Convergence, LawGuardsAgainstAnswersThatAgreeByChance) {
  const std::array counts{1.0, 4.0, 16.0, 64.0};
  const std::array<Answer, 4> answers{Answer{13}, Answer{7}, Answer{5.125 + 1e-6}, Answer{5.125}};
  const Truth truth = truth_of(counts, answers);
  EXPECT_NEAR(truth.uncertainty, 7.875 * std::pow(1.875 / 7.875, 3), 1e-12);
}

TEST(Convergence, TruthOfOneAnswerMayBeOffByAnything) {
  const std::array counts{100.0};
  const std::array<Answer, 1> answers{Answer{1}};
  EXPECT_EQ(truth_of(counts, answers).uncertainty, infinity);
  const std::array<Answer, 1> none{Answer{}};
  EXPECT_TRUE(truth_of(counts, none).value.empty());
}

// For A = T + c N^-p and counts a factor of 3 or more apart, u of (2) is at least the truth's error as long as 3^p >= 2, and at most e_(f-1) or
// what the law makes of errors that are too small by c N_f^-p: less than 3 times the truth's error for p = 1 and a factor of 10/3.
TEST(Convergence, UncertaintyBoundsTheErrorOfAPowerLaw) {
  const std::array counts{100.0, 300.0, 1000.0, 3000.0, 1e4, 3e4, 1e5};
  for (const double p : {.64, .75, 1.0}) {
    std::vector<Answer> answers;
    for (const double count : counts) answers.push_back({10 - 3 * std::pow(count, -p)});
    const double off = 3 * std::pow(counts.back(), -p);
    const Truth truth = truth_of(counts, answers);
    EXPECT_GE(truth.uncertainty, off) << p;
    EXPECT_LE(truth.uncertainty, 3 * off) << p;
    const Settling settled = settling(answers, truth);
    for (std::size_t i = 0; i < counts.size(); ++i) EXPECT_GE(settled.bound[i], 3 * std::pow(counts[i], -p) * (1 - 1e-9)) << p << " " << counts[i];
  }
}

}  // namespace
}  // namespace sagitta::study
