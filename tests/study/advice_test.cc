// SPDX-License-Identifier: Apache-2.0
// The lines for rows that are made up, worked out by hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <deque>

#include "lib/study/advice.h"

namespace sagitta::study {
namespace {

using ::testing::ElementsAre;

constexpr double none = std::numeric_limits<double>::quiet_NaN();

Worst percent(double value) { return {value, none}; }
Worst absolute(double value) { return {none, value}; }

class Curves {
 public:
  struct Made {
    std::int64_t rays;
    int grid;
    double seconds;
    Worst bound;
  };
  Curve curve(Quantity quantity, const char* pattern, const std::vector<Made>& steps, Worst uncertainty) {
    Curve result{quantity, pattern, {}, {}, uncertainty, {}};
    for (const Made& made : steps) {
      runs_.push_back({pattern, made.rays, made.grid, {}, {made.seconds, made.seconds, made.seconds, 3}, {}});
      result.steps.push_back({&runs_.back(), 0, {}, {}, {}, {}, made.bound});
    }
    return result;
  }

 private:
  std::deque<Run> runs_;
};

TEST(Advice, NamesTheUsualRaysAndTheFewestForATarget) {
  Curves made;
  const std::vector<Curve> curves{
      made.curve(Quantity::spot_rms, "hexapolar", {{100, 0, 1e-4, percent(9)}, {1000, 0, 3e-4, percent(.951)}, {10000, 0, 2e-3, percent(.2999)}, {100000, 0, .0204, percent(.0301)}}, percent(.01)),
      made.curve(Quantity::spot_rms, "square", {{100, 0, 1, percent(9)}, {1000, 0, 1, percent(5)}, {10000, 0, 1, percent(.1)}, {100000, 0, 1, percent(.01)}}, percent(.01)),
      made.curve(Quantity::spot_rms, "random:1", {{100, 0, 1, percent(9)}, {100000, 0, 1, percent(.11)}}, percent(.01)),
      made.curve(Quantity::wavefront_rms, "", {{0, 16, 1e-3, percent(20)}, {0, 64, 12e-3, percent(2.31)}, {0, 128, 1.2, percent(1)}}, percent(.5)),
      made.curve(Quantity::zernike, "", {{0, 16, 1e-3, absolute(.2)}, {0, 64, 12e-3, absolute(.0801)}, {0, 128, 1.2, absolute(2.01e-5)}}, absolute(1e-5))};
  EXPECT_THAT(advice(curves, {}),
              ElementsAre("1e4 rays give the spot RMS to 0.3 % in 2 ms; 1e3 to 0.96 % in 300 µs; 1e5 to 0.031 % in 20 ms",
                          "the spot RMS to 0.1 % takes 1e5 rays of hexapolar, 1e4 rays of square, more than 1e5 rays of random:1",
                          "64 x 64 samples give the wavefront RMS to 2.4 % in 12 ms; 128 x 128 to 1 % in 1.2 s; 128 x 128 are too few for 0.1 %",
                          "64 x 64 samples give every Zernike coefficient to 0.081 µm in 12 ms; 128 x 128 to 2.1e-5 µm in 1.2 s"));
  EXPECT_EQ(truth_note(curves, {}),
            "The truth here is the finest itself, 1e5 hexapolar rays and 128 x 128 samples, by the same double-precision code: it is not independent. By its own convergence it may be off by "
            "0.01 % (spot RMS), 0.5 % (wavefront RMS), 1e-5 µm (a Zernike coefficient), which every figure includes. A figure is the worst of the counts measured from there on, those between included, "
            "and the largest rise of the error from one of them to the next: what was measured, no bound.");
  EXPECT_EQ(truth_note({}, {}), "");
  EXPECT_TRUE(advice({}, {}).empty());
}

TEST(Advice, SaysWhatIsNotInPercent) {
  const double infinity = std::numeric_limits<double>::infinity();
  Curves made;
  const std::vector<Curve> perfect{made.curve(Quantity::spot_rms, "hexapolar", {{100, 0, 1e-4, absolute(3e-13)}, {10000, 0, 2e-3, absolute(1e-13)}}, absolute(1e-14))};
  EXPECT_THAT(advice(perfect, {}), ElementsAre("1e4 rays give the spot RMS to 1e-13 µm in 2 ms; 100 to 3e-13 µm in 100 µs"));
  EXPECT_EQ(text_of({.5, .0014}, Quantity::spot_rms), "0.5 % (0.0014 µm where it is next to nothing)");
  EXPECT_EQ(text_of({.5, .0009}, Quantity::wavefront_rms), "0.5 %");
  EXPECT_EQ(text_of(percent(infinity), Quantity::spot_rms), "an unknown amount");
}

TEST(Advice, TellsWhatInterpolationsChange) {
  CloudRun c1{1, "cornea", "c1", false, {}, 0, {}, {}}, linear{1, "cornea", "linear", true, {}, 0, {}, {}}, failed{2, "", "cubic", false, "no room", 0, {}, {}};
  std::vector<CloudChange> changes{{&c1, &c1, 1, {percent(0), percent(0), absolute(0)}}, {&linear, &c1, .7512, {percent(12.31), Worst{}, absolute(.02)}}, {&failed, &c1, none, {}}};
  EXPECT_THAT(advice({}, changes), ElementsAre("linear, as given, in place of c1 at 'cornea' changes the spot RMS by 13 %, a Zernike coefficient by 0.02 µm; a ray takes 0.75 times as long", "cubic at surface 2: no room"));
}

TEST(Advice, WritesTimesAndCountsWithTwoDigits) {
  EXPECT_EQ(text_of_seconds(4.56e-7), "0.46 µs");
  EXPECT_EQ(text_of_seconds(.000994), "990 µs");
  EXPECT_EQ(text_of_seconds(.000996), "1 ms");
  EXPECT_EQ(text_of_seconds(.994), "990 ms");
  EXPECT_EQ(text_of_seconds(.996), "1 s");
  EXPECT_EQ(text_of_seconds(12.34), "12 s");
  const auto count = [](std::int64_t rays) { return text_of(study::Run{"hexapolar", rays, 0, {}, {}, {}}); };
  EXPECT_EQ(count(300), "300");
  EXPECT_EQ(count(1000), "1e3");
  EXPECT_EQ(count(3'000'000), "3e6");
  EXPECT_EQ(count(1234000), "1234000");
}

TEST(Advice, CountsMissingAnswersByTheirReason) {
  Answers good, lost, undetermined;
  lost.no_spot = "no ray arrived";
  lost.no_wavefront = lost.no_zernike = "the chief ray is lost";
  undetermined.no_zernike = "too few";
  Sampling sampling;
  sampling.spots = {{study::Run{"hexapolar", 100, 0, {good, lost, lost}, {}, {}}}};
  sampling.wavefronts = {study::Run{"", 0, 64, {undetermined, lost, lost}, {}, {}}};
  EXPECT_THAT(missing_answers(sampling), ElementsAre("no spot RMS for 2 of 3 fields and wavelengths: no ray arrived", "no wavefront RMS for 2 of 3 fields and wavelengths: the chief ray is lost",
                                                     "no Zernike coefficients for 1 of 3 fields and wavelengths: too few"));
}

TEST(Advice, OfGradientsNamesTheGivenToleranceAndTheLoosestThatChangesNextToNothing) {
  const ToleranceRun tight{1e-14, false, 31.4, {}, {}}, given{1e-12, true, 12, {}, {}}, loose{1e-6, false, 5.25, {}, {}}, loosest{1e-3, false, 2, {}, {}};
  const std::vector<ToleranceChange> changes{{&tight, 3, {percent(0), percent(0), absolute(0)}}, {&given, 1, {percent(1.21e-9), percent(2e-8), absolute(3e-12)}},
                                             {&loose, .512, {percent(.0099), Worst{}, absolute(.02)}}, {&loosest, .3, {percent(.0001), percent(.0101), absolute(1)}}};
  EXPECT_THAT(advice({}, {}, changes),
              ElementsAre("tolerance_mm 1e-12, as given: 12 steps of a ray in gradients; against 1e-14 it changes the spot RMS by 1.3e-9 %, the wavefront RMS by 2e-8 %, a Zernike coefficient by 3e-12 µm",
                          "tolerance_mm 1e-06: 5.25 steps of a ray in gradients; against 1e-14 it changes the spot RMS by 0.0099 %, a Zernike coefficient by 0.02 µm; a ray takes 0.51 times as long"));
}

}  // namespace
}  // namespace sagitta::study
