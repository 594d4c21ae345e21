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

// A sequence without counts between its rungs.
std::vector<Rung> rungs_of(const std::vector<double>& counts, const std::vector<Answer>& answers) {
  std::vector<Rung> rungs;
  for (std::size_t i = 0; i < counts.size(); ++i) rungs.push_back({counts[i], {answers[i]}});
  return rungs;
}

// By hand: 7, 4, 5, 6 against the last: errors 1, 2, 1, 0; from there on 2, 2, 1, 0, and the largest rise is 1, from the first to the second. No error stands clear
// of twice the last but one, so no law is fitted, and the truth is off by that one, 1, for the least order: 1/(sqrt 4 - 1) < 1 leaves it.
TEST(Convergence, ClaimsTheWorstFromThereOnAndTheTruthsOwnError) {
  const std::vector<double> counts{100, 300, 1000, 4000};
  const std::vector<Rung> rungs = rungs_of(counts, {{7}, {4}, {5}, {6}});
  const Truth truth = truth_of(rungs);
  EXPECT_EQ(truth.value, Answer{6});
  EXPECT_EQ(truth.uncertainty, 1);
  EXPECT_EQ(truth.clear_of, 2);
  const Settling settled = settling(rungs, truth);
  EXPECT_EQ(settled.error, (std::vector<double>{1, 2, 1, 0}));
  EXPECT_EQ(settled.worst, settled.error);
  EXPECT_EQ(settled.bound, (std::vector<double>{4, 3, 2, 1}));
  // another pattern, against the same truth
  const Settling other = settling(rungs_of({100, 300, 1000}, {{6}, {}, {5.5}}), truth);
  EXPECT_EQ(other.error, (std::vector<double>{0, infinity, .5}));
  EXPECT_EQ(other.bound, (std::vector<double>{infinity, infinity, 1.5}));
}

// By hand, against 0 known exactly: errors 1, (4, 2), 1, (3), 0 from rung to rung. The worst are 4, 3, 0; the rises 3 (1 to 4), 2 (1 to 3) and none.
TEST(Convergence, ClaimsTheCountsBetweenAndHowErrorsJumpAmongThem) {
  const std::vector<Rung> rungs{{100, {{1}, {-4}, {2}}}, {300, {{-1}, {3}}}, {1000, {{0}}}};
  const Settling settled = settling(rungs, {{0}, 0, 0});
  EXPECT_EQ(settled.error, (std::vector<double>{1, 1, 0}));
  EXPECT_EQ(settled.worst, (std::vector<double>{4, 3, 0}));
  EXPECT_EQ(settled.bound, (std::vector<double>{7, 5, 0}));
  // The truth itself is off by the worst of the last counts before it: 3, for a ratio of 10/3 and the least order 1/2.
  EXPECT_DOUBLE_EQ(truth_of(rungs).uncertainty, 3 / (std::sqrt(10 / 3.0) - 1));
}

// Errors 16/N from N = 1 on, every power of 2, with four counts or more up to the rung of 16, and none at 64, which is right by luck: the claim goes on with 1/N.
TEST(Convergence, CarriesTheClaimOnWhereFewCountsAreMeasured) {
  const auto error = [](double count) { return Answer{16 / count}; };
  std::vector<Rung> rungs;
  for (const double count : {1.0, 4.0, 16.0}) rungs.push_back({count, {error(count), error(1.25 * count), error(1.5 * count), error(2 * count), error(3 * count)}});
  rungs.push_back({64, {{0}}});
  rungs.push_back({256, {{0}}});
  const Settling settled = settling(rungs, {{0}, 0, 0});
  const double expected[] = {16, 4, 1, .25, .0625};
  for (std::size_t i = 0; i < 5; ++i) EXPECT_NEAR(settled.bound[i], expected[i], 1e-12) << i;
  // Errors that are not clear of the truth have no law to carry on.
  EXPECT_EQ(settling(rungs, {{0}, .5, 100}).bound.back(), .5);
}

// A = 5 + 8/N for N = 1, 4, 16, 64, but the last two agree by chance. The truth, 5.125, is off by 0.125. The errors 7.875 and 1.875 stand clear,
// and the law through them, 7.875 N^-p with 4^p = 7.875/1.875, is 7.875 (1.875/7.875)^3 = 0.106 at N = 64, over 1.
TEST(Convergence, LawGuardsAgainstAnswersThatAgreeByChance) {
  const Truth truth = truth_of(rungs_of({1, 4, 16, 64}, {{13}, {7}, {5.125 + 1e-6}, {5.125}}));
  EXPECT_NEAR(truth.uncertainty, 7.875 * std::pow(1.875 / 7.875, 3), 1e-12);
}

TEST(Convergence, TruthOfOneAnswerMayBeOffByAnything) {
  EXPECT_EQ(truth_of(rungs_of({100}, {{1}})).uncertainty, infinity);
  EXPECT_TRUE(truth_of(rungs_of({100}, {{}})).value.empty());
}

// For A = T + c N^-p, p >= 1/2, u of (2) is at least the truth's error, c N_f^-p, on rungs that are close together (grids of 256 and 384) as on those that are not, and at most
// (r^p - 1)/(r^(1/2) - 1) of it, or of what the law makes of errors that are too small by c N_f^-p, r = N_f/N_(f-1), where that is less than 4. At p = 1/2 it is the error but for rounding.
TEST(Convergence, UncertaintyBoundsTheErrorOfAPowerLaw) {
  const std::vector<double> rays{100, 300, 1000, 3000, 1e4, 3e4, 1e5}, samples{709, 1653, 3001, 6921, 12453, 28345, 50617, 114553};
  for (const std::vector<double>& counts : {rays, samples})
    for (const double p : {.5, .64, .75, 1.0}) {
      std::vector<Answer> answers;
      for (const double count : counts) answers.push_back({10 - 3 * std::pow(count, -p)});
      const double off = 3 * std::pow(counts.back(), -p);
      const std::vector<Rung> rungs = rungs_of(counts, answers);
      const Truth truth = truth_of(rungs);
      EXPECT_GE(truth.uncertainty, off * (1 - 1e-9)) << p;
      EXPECT_LE(truth.uncertainty, 4 * off) << p;
      const Settling settled = settling(rungs, truth);
      for (std::size_t i = 0; i < counts.size(); ++i) EXPECT_GE(settled.bound[i], 3 * std::pow(counts[i], -p) * (1 - 1e-9)) << p << " " << counts[i];
    }
}

}  // namespace
}  // namespace sagitta::study
