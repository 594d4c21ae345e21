// SPDX-License-Identifier: Apache-2.0
#include "lib/output/figure.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <png.h>

#include <cmath>
#include <limits>

#include "lib/output/exr.h"
#include "tests/output/test_folder.h"

namespace sagitta::output {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr Rgb8 white{255, 255, 255};

Rgb8 at(const Raster& raster, int x, int y) {
  const std::uint32_t pixel = raster.pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(raster.width) + static_cast<std::size_t>(x)];
  return {static_cast<std::uint8_t>(pixel >> 16U), static_cast<std::uint8_t>(pixel >> 8U), static_cast<std::uint8_t>(pixel)};
}

struct Found {
  int count = 0;
  double x = 0, y = 0;  // mean place
};
Found find(const Raster& raster, Rgb8 wanted) {
  Found found;
  for (int y = 0; y < raster.height; ++y)
    for (int x = 0; x < raster.width; ++x)
      if (at(raster, x, y) == wanted) {
        ++found.count;
        found.x += x;
        found.y += y;
      }
  found.x /= found.count;
  found.y /= found.count;
  return found;
}

Panel flat_panel(double value) {
  Panel panel;
  panel.title = "Field 0°, 10°, 543 nm";
  panel.subtitle = {"RMS 0.31 waves"};
  panel.map = {8, 8, std::vector<float>(64, static_cast<float>(value))};
  panel.range = Range{0, 1};
  panel.quantity = "OPD";
  panel.unit = "waves";
  return panel;
}

bool margins_are_white(const Raster& raster, int margin) {
  for (int y = 0; y < raster.height; ++y)
    for (int x = 0; x < raster.width; ++x) {
      const bool inside = x >= margin && y >= margin && x < raster.width - margin && y < raster.height - margin;
      if (!inside && at(raster, x, y) != white) return false;
    }
  return true;
}

TEST(Figure, EveryPanelIsThereInReadingOrderAndAligned) {
  Figure figure{"Six panels", "footer", {}, 3};
  for (int i = 0; i < 6; ++i) figure.panels.push_back(flat_panel(0.1 + 0.15 * i));
  const Raster raster = render(figure);
  EXPECT_GE(raster.width, 1100);
  EXPECT_LE(raster.width, 1300);
  std::vector<Found> panels;
  for (int i = 0; i < 6; ++i) {
    const Found found = find(raster, color(ColorMap::sequential, static_cast<float>(0.1 + 0.15 * i)));
    // The plot, and a line or two of this very colour in each of the six bars.
    EXPECT_GE(found.count, 256 * 256);
    EXPECT_LE(found.count, 256 * 256 + 6 * 5 * 13);
    panels.push_back(found);
  }
  for (std::size_t i = 0; i < 3; ++i) {
    // The bars pull the mean by less than 6*5*13/256^2 of the sheet: 8 pixels.
    EXPECT_NEAR(panels[i].x, panels[i + 3].x, 8);
    EXPECT_NEAR(panels[i].y, panels[0].y, 8);
    EXPECT_GT(panels[i + 3].y, panels[i].y + 256);
    if (i > 0) {
      EXPECT_GT(panels[i].x, panels[i - 1].x + 256);
    }
  }
}

TEST(Figure, TheSameFigureGivesTheSameBytesAndThePngHoldsItsPixels) {
  const TestFolder folder;
  const Figure figure{"One panel", "λ = 543 nm", {flat_panel(0.5)}, 1};
  const Raster raster = render(figure);
  ASSERT_EQ(write_png(folder / "a.png", raster).error, "");
  ASSERT_EQ(write_png(folder / "b.png", render(figure)).error, "");
  EXPECT_EQ(folder.contents("a.png"), folder.contents("b.png"));

  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  ASSERT_NE(png_image_begin_read_from_file(&image, (folder / "a.png").c_str()), 0);
  EXPECT_EQ(static_cast<int>(image.width), raster.width);
  EXPECT_EQ(static_cast<int>(image.height), raster.height);
  image.format = PNG_FORMAT_RGB;
  std::vector<std::uint8_t> pixels(PNG_IMAGE_SIZE(image));
  ASSERT_NE(png_image_finish_read(&image, nullptr, pixels.data(), 0, nullptr), 0);
  std::vector<std::uint8_t> expected;
  for (int y = 0; y < raster.height; ++y)
    for (int x = 0; x < raster.width; ++x)
      for (const std::uint8_t component : at(raster, x, y)) expected.push_back(component);
  EXPECT_EQ(pixels, expected);
}

// Where the first panel shows the second one's labels these are copied from there, and else they are drawn.
TEST(Figure, ALabelThatIsCopiedIsTheOneThatIsDrawn) {
  Panel panel = flat_panel(0.5), unlike = flat_panel(0.5);
  panel.axes = {25, 25, 0, 0, true, "pupil x", "pupil y"};
  panel.range = Range{0, 100};
  unlike.axes = {0.25, 0.25, 0, 0, false, "u", "v"};
  unlike.range = Range{0, 8};
  unlike.title = "Other";
  unlike.subtitle = {"words"};
  unlike.quantity = "Q";
  unlike.unit = "u";
  const Raster copied = render({"", "", {panel, panel}, 2}), drawn = render({"", "", {unlike, panel}, 2});
  ASSERT_EQ(copied.width, drawn.width);
  ASSERT_EQ(copied.height, drawn.height);
  int inked = 0, unlike_on_the_left = 0;
  for (int y = 0; y < drawn.height; ++y)
    for (int x = 0; x < drawn.width; ++x) {
      if (x < drawn.width / 2) {
        unlike_on_the_left += at(copied, x, y) != at(drawn, x, y);
        continue;
      }
      inked += at(drawn, x, y) != white;
      ASSERT_EQ(at(copied, x, y), at(drawn, x, y)) << x << " " << y;
    }
  EXPECT_GT(inked, 384 * 384);
  EXPECT_GT(unlike_on_the_left, 1000);
}

// Of a plot 24 pixels wide the labels -5000 and 0 overlap; where the first panel has a 0 that stands alone, that is not copied.
TEST(Figure, ALabelOverAnotherIsNotCopied) {
  Panel narrow = flat_panel(0.5), wide = flat_panel(0.5);
  narrow.map = {2, 32, std::vector<float>(64, 0.5F)};
  narrow.axes = {5000, 5000, -2500, 0, false, "", ""};
  wide.axes = {1250, 1250, -2500, 0, false, "", ""};
  const Raster with_zero = render({"", "", {wide, narrow}, 2});
  wide.axes.center_x = 50000;
  const Raster without_zero = render({"", "", {wide, narrow}, 2});
  ASSERT_EQ(with_zero.width, without_zero.width);
  int inked = 0;
  for (int y = 0; y < with_zero.height; ++y)
    for (int x = with_zero.width / 2; x < with_zero.width; ++x) {
      ASSERT_EQ(at(with_zero, x, y), at(without_zero, x, y)) << x << " " << y;
      inked += at(with_zero, x, y) != white;
    }
  EXPECT_GT(inked, 24 * 384);
}

TEST(Figure, APictureThatIsEmptyOrTooWideIsAnErrorAndNoFile) {
  const TestFolder folder;
  EXPECT_EQ(write_png(folder / "a.png", {}).error, (folder / "a.png") + ": the picture is empty");
  const Raster too_wide{1000001, 1, std::vector<std::uint32_t>(1000001)};  // for libpng, by a pixel
  EXPECT_EQ(write_png(folder / "a.png", too_wide).error, (folder / "a.png") + ": Invalid IHDR data");  // libpng's words
  EXPECT_TRUE(folder.names().empty());
}

TEST(Figure, TheFirstRowOfAMapIsItsTopAndTheFirstColumnItsLeft) {
  Panel panel = flat_panel(0);
  panel.map = {2, 2, {0.3F, 0.9F, 0.9F, 0.6F}};
  const Raster raster = render({"", "", {panel}, 1});
  const Found top_left = find(raster, color(ColorMap::sequential, 0.3F));
  const Found bottom_right = find(raster, color(ColorMap::sequential, 0.6F));
  // A quarter of the plot each; the two bars' lines are at most 4 x 13 pixels.
  EXPECT_NEAR(top_left.count, 256 * 256, 4 * 13);
  EXPECT_NEAR(bottom_right.x - top_left.x, 256, 1);
  EXPECT_NEAR(bottom_right.y - top_left.y, 256, 1);
}

TEST(Figure, ALonelyRayStaysVisibleInAMapFinerThanThePlot) {
  Panel panel;
  panel.map = {2000, 2000, std::vector<float>(4000000, 0.0F)};
  panel.map.values[1234567] = 1;
  panel.map.values[3456789] = 3;
  panel.zero_is_background = true;
  panel.range = Range{0, 4};
  const Raster raster = render({"", "", {panel}, 1});
  Panel without = panel;
  without.map.values[1234567] = 0;
  const Raster other = render({"", "", {without}, 1});
  const Rgb8 one = color(ColorMap::sequential, 0.25);
  EXPECT_EQ(find(raster, one).count, find(other, one).count + 1);
}

TEST(Figure, NoDataIsGreyAndWithoutAnyThePanelSaysWhy) {
  Panel half = flat_panel(0.5);
  for (std::size_t i = 0; i < 32; ++i) half.map.values[i] = nan;
  // The edges of a few letters may have this grey too.
  EXPECT_NEAR(find(render({"", "", {half}, 1}), no_data_color).count, 512 * 256 + 50, 50);
  Panel none = flat_panel(nan);
  none.empty_note = "";
  const Raster silent = render({"", "", {none}, 1});
  EXPECT_NEAR(find(silent, no_data_color).count, 512 * 512 + 50, 50);
  none.empty_note = "no ray arrived";
  EXPECT_LT(find(render({"", "", {none}, 1}), no_data_color).count, 512 * 512 - 100);
  none.map.values.resize(3);  // not width x height
  EXPECT_GT(find(render({"", "", {none}, 1}), no_data_color).count, 512 * 500);
}

TEST(Figure, ZeroIsInTheMiddleOfADivergingMap) {
  Panel panel = flat_panel(0);
  panel.range.reset();
  panel.color_map = ColorMap::diverging;
  panel.map = {3, 1, {-0.25F, 0.0F, 1.0F}};
  const Raster raster = render({"", "", {panel}, 1});
  for (const double t : {0.375, 0.5, 1.0}) EXPECT_GT(find(raster, color(ColorMap::diverging, t)).count, 170 * 170);
}

TEST(Figure, LargeValuesStandAboveSmallOnesOnTheAxisTheBarAndAmongCircles) {
  Panel panel = flat_panel(0.3);
  panel.axes.center_y = 1.5;  // y from -2.5 to 5.5: ticks at -2, 0, 2, 4
  panel.circles = {{0, 4.5, 0.5, ""}};
  const Raster raster = render({"", "", {panel}, 1});
  const Rgb8 flat = color(ColorMap::sequential, 0.3F);
  int left = 0, top = 0;
  while (at(raster, left, raster.height / 2) != flat) ++left;
  while (at(raster, left, top) != flat) ++top;

  const auto is_tick = [&](double y) {
    const int row = top + static_cast<int>(512 * (5.5 - y) / 8);
    return at(raster, left - 3, row) != white && at(raster, left - 3, row - 2) == white;
  };
  for (const double y : {-2.0, 0.0, 2.0, 4.0}) EXPECT_TRUE(is_tick(y)) << y;
  for (const double mirrored : {5.0, 3.0, 1.0, -1.0}) EXPECT_FALSE(is_tick(mirrored)) << mirrored;

  const Found high = find(raster, color(ColorMap::sequential, 1 - 0.5 / 512));
  const Found low = find(raster, color(ColorMap::sequential, 0.5 / 512));
  EXPECT_NEAR(high.y, top, 3);  // neighbouring lines of the bar may round to the same bytes
  EXPECT_NEAR(low.y, top + 511, 3);

  // The circle's right end, at x = 0.5, y = 4.5.
  EXPECT_NE(at(raster, left + 256 + 32, top + 64), flat);
  EXPECT_EQ(at(raster, left + 256 + 32, top + 448), flat);
}

TEST(Figure, NothingReachesIntoTheMargins) {
  std::string endless, words;
  for (int i = 0; i < 300; ++i) {
    endless += "W";
    words += "long ";
  }
  for (const std::string& text : {endless, words, std::string("\xff\x1b broken \n bytes \xEF\xBF\xBE")}) {
    Figure figure{text, text, {}, 2};
    for (int i = 0; i < 5; ++i) {
      Panel panel = flat_panel(i == 3 ? nan : 123456.789);
      panel.title = panel.quantity = panel.unit = panel.axes.x_label = panel.axes.y_label = panel.empty_note = text;
      panel.subtitle = {text, text};
      panel.circles = {{0, 0, 1, text}, {0, 0, 100, text}};
      panel.axes.center_y = -12345.6789;
      panel.range = Range{-123456, 123456};
      panel.map.width = i == 4 ? 2 : 8;
      panel.map.height = i == 4 ? 32 : 8;
      figure.panels.push_back(panel);
    }
    const Raster raster = render(figure);
    EXPECT_TRUE(margins_are_white(raster, 18));
    EXPECT_FALSE(margins_are_white(raster, 30));
  }
}

TEST(Figure, ASheetIsLimitedHoweverManyPanelsThereAre) {
  const Raster raster = render({"", "", std::vector<Panel>(500, flat_panel(0.5)), 1});
  EXPECT_GT(find(raster, color(ColorMap::sequential, 0.5)).count, 64 * 256 * 256 - 1);
  EXPECT_LT(raster.height, 16 * 450);
  EXPECT_LT(raster.width, 4 * 500);
  EXPECT_GT(render({"title", "", {}, 0}).width, 0);
}

TEST(Figure, NumbersThatAreNoneStillMakeAPicture) {
  for (const double bad : {0.0, -1.0, double(nan), double(INFINITY), 1e300, 1e-300}) {
    Panel panel = flat_panel(0.5);
    panel.axes.pixel_width = panel.axes.center_x = panel.axes.center_y = bad;
    panel.map.values[5] = static_cast<float>(bad);
    panel.map.values[6] = INFINITY;
    panel.circles = {{bad, 0, 1, ""}, {0, 0, bad, ""}};
    for (const bool log_scale : {false, true})
      for (const std::optional<Range>& range :
           {std::optional<Range>{}, std::optional(Range{bad, bad}), std::optional(Range{bad, 1})}) {
        panel.log_scale = log_scale;
        panel.range = range;
        EXPECT_GT(render({"", "", {panel}, 1}).width, 500);
      }
  }
}

TEST(Preview, ItHoldsThePictureInLinearLightWithoutNaN) {
  const Raster raster{2, 1, {0x0080FF, 0x4001C8}};
  const ExrPart part = preview_part(raster);
  EXPECT_EQ(part.name, "preview");
  ASSERT_EQ(part.channels.size(), 3U);
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_EQ(part.channels[c].name, std::string(1, "BGR"[c]));
    const auto& pixels = std::get<ExrBytes>(part.channels[c].pixels);
    ASSERT_EQ(pixels.size(), 2U);
    for (std::size_t i = 0; i < 2; ++i) {
      const float value = pixels.values[pixels.bytes[pixels.step * i]];
      // Back to the bytes; 128 is 0.21586 in linear light.
      EXPECT_EQ(std::lround(255 * srgb_from_linear(double(value))), at(raster, static_cast<int>(i), 0)[2 - c]);
      EXPECT_GE(value, 0);
      EXPECT_LE(value, 1);
    }
  }
  EXPECT_NEAR(std::get<ExrBytes>(part.channels[1].pixels).values[128], 0.2158605, 1e-7);
}

}  // namespace
}  // namespace sagitta::output
