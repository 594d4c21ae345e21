// SPDX-License-Identifier: Apache-2.0
#include "lib/output/color_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace sagitta::output {
namespace {

constexpr int step_count = 256;  // even: the middle of the diverging map is a sample
const ColorMap all_maps[] = {ColorMap::sequential, ColorMap::diverging};

std::vector<Oklab> samples(ColorMap map) {
  std::vector<Oklab> colors;
  for (int i = 0; i <= step_count; ++i) colors.push_back(oklab_color(map, double(i) / step_count));
  return colors;
}

double distance(const Oklab& p, const Oklab& q) { return std::hypot(p.lightness - q.lightness, p.a - q.a, p.b - q.b); }

// Oklab coordinates of sRGB red, green, blue and white as CSS Color 4 and colour libraries list them, to six figures.
// The slope of the way back is at most 3 * 4.1 * (1 + 1.3) < 30, so 5e-7 there is 1.5e-5 here.
TEST(ColorMap, OklabOfTheSrgbPrimariesIsThatOfTheLiterature) {
  struct Case {
    Oklab oklab;
    std::array<double, 3> linear;
  };
  const Case cases[] = {{{0.627955, 0.224863, 0.125846}, {1, 0, 0}},
                        {{0.866440, -0.233888, 0.179498}, {0, 1, 0}},
                        {{0.452014, -0.032457, -0.311528}, {0, 0, 1}},
                        {{1, 0, 0}, {1, 1, 1}}};
  for (const Case& c : cases) {
    const auto linear = linear_srgb(c.oklab);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(linear[i], c.linear[i], 1.5e-5);
  }
}

TEST(ColorMap, EncodedSrgbComesBackThroughLinearLight) {
  EXPECT_EQ(linear_from_srgb(0), 0);
  EXPECT_EQ(linear_from_srgb(1), 1);
  EXPECT_NEAR(linear_from_srgb(0.5), 0.21404114, 1e-8);  // IEC 61966-2-1: ((0.5 + 0.055) / 1.055)^2.4
  // The standard's two branches meet only to 1e-7 or so; elsewhere this is rounding.
  for (int i = 0; i < 256; ++i) EXPECT_NEAR(srgb_from_linear(linear_from_srgb(i / 255.0)), i / 255.0, 1e-6);
}

TEST(ColorMap, EveryColourCanBeShown) {
  for (const ColorMap map : all_maps)
    for (const Oklab& color : samples(map))
      for (const double component : linear_srgb(color)) {
        EXPECT_GE(component, 0);
        EXPECT_LE(component, 1);
      }
}

// Between equal arcs of a curve that turns by an angle of theta per step, chords differ from their arcs by at most
// theta^2 / 24, here (theta < 0.05 asserted) 1e-4. The table behind the arc length puts a point off by h^2 |s''| / 8
// with h = 1/1024 and |s''| <= |B''| = 2 |P0 - 2 P1 + P2| < 1.5: 1.8e-7, twice on a step of at least 0.4/256 = 1.6e-3,
// or 2.3e-4. Together 3.3e-4. The diverging map is straight: rounding only.
TEST(ColorMap, StepsAreEqualInOklab) {
  for (const ColorMap map : all_maps) {
    const auto colors = samples(map);
    std::vector<double> steps;
    double largest_turn = 0;
    for (std::size_t i = 1; i < colors.size(); ++i) {
      steps.push_back(distance(colors[i], colors[i - 1]));
      if (i + 1 == colors.size() || map == ColorMap::diverging) continue;
      const double turn = std::atan2(colors[i + 1].b - colors[i].b, colors[i + 1].a - colors[i].a) -
                          std::atan2(colors[i].b - colors[i - 1].b, colors[i].a - colors[i - 1].a);
      largest_turn = std::max(largest_turn, std::abs(std::remainder(turn, 2 * std::acos(-1))));
    }
    EXPECT_LT(largest_turn, 0.05);
    const auto [least, most] = std::minmax_element(steps.begin(), steps.end());
    EXPECT_GT(*least, 1e-3);
    EXPECT_LT(*most / *least - 1, map == ColorMap::sequential ? 3.3e-4 : 1e-12);
  }
}

TEST(ColorMap, LightnessGrowsEvenlyAlongTheSequentialMap) {
  const auto colors = samples(ColorMap::sequential);
  const double step = (colors.back().lightness - colors.front().lightness) / step_count;
  EXPECT_GT(step, 0.6 / step_count);
  for (std::size_t i = 1; i < colors.size(); ++i)
    EXPECT_NEAR(colors[i].lightness - colors[i - 1].lightness, step, 1e-15);
}

TEST(ColorMap, ItRunsFromDarkBlueVioletToLightYellow) {
  const Rgb8 first = color(ColorMap::sequential, 0), last = color(ColorMap::sequential, 1);
  EXPECT_GT(first[2], first[0]);  // more blue than red, and that more than green
  EXPECT_GT(first[0], first[1]);
  EXPECT_GT(last[0], 220);
  EXPECT_GT(last[1], 220);
  EXPECT_LT(last[2], 120);
}

TEST(ColorMap, EqualValuesOfEitherSignAreEquallyLightAndEquallyColourful) {
  const auto colors = samples(ColorMap::diverging);
  for (std::size_t i = 0; i < colors.size() / 2; ++i) {
    const Oklab &low = colors[i], &high = colors[colors.size() - 1 - i];
    EXPECT_EQ(low.lightness, high.lightness);
    EXPECT_NEAR(std::hypot(low.a, low.b), std::hypot(high.a, high.b), 1e-15);
    EXPECT_LT(colors[i].lightness, colors[i + 1].lightness);
    EXPECT_LT(low.b, 0);   // blue
    EXPECT_GT(high.a, 0);  // red to orange
    EXPECT_GT(high.b, 0);
  }
  const Rgb8 zero = color(ColorMap::diverging, 0.5);
  EXPECT_LE(std::max({zero[0], zero[1], zero[2]}) - std::min({zero[0], zero[1], zero[2]}), 1);
}

TEST(ColorMap, TheTableIsOffByOneAtMost) {
  int off = 0;
  for (const ColorMap map : all_maps)
    for (int i = 0; i <= 100000; ++i) {
      const Rgb8 exact = exact_color(map, i / 1e5), shown = color(map, i / 1e5);
      for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_LE(std::abs(exact[c] - shown[c]), 1) << i;
        off += exact[c] != shown[c];
      }
    }
  EXPECT_LT(off, 600000 / 5);
}

TEST(ColorMap, BeyondTheEndsTheEndsAreShownAndNoDataIsNeutralGrey) {
  for (const ColorMap map : all_maps) {
    EXPECT_EQ(color(map, -1), color(map, 0));
    EXPECT_EQ(color(map, std::numeric_limits<double>::infinity()), color(map, 1));
    EXPECT_EQ(color(map, std::numeric_limits<double>::quiet_NaN()), no_data_color);
    for (int i = 0; i <= step_count; ++i) EXPECT_NE(color(map, double(i) / step_count), no_data_color);
  }
  EXPECT_EQ(no_data_color[0], no_data_color[1]);
  EXPECT_EQ(no_data_color[1], no_data_color[2]);
}

}  // namespace
}  // namespace sagitta::output
