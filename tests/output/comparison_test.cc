// SPDX-License-Identifier: Apache-2.0
#include "lib/output/comparison.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace sagitta::output {
namespace {

TEST(Comparison, slugs_are_short_and_plain) {
  EXPECT_EQ(slug_of("Navarro eye, Zernike cornea"), "navarro-eye-zernike-cornea");
  EXPECT_EQ(slug_of("zernike:36"), "zernike-36");
  EXPECT_EQ(slug_of("  -- "), "system");
  EXPECT_EQ(slug_of(""), "system");
  EXPECT_EQ(slug_of("Œil 1"), "il-1");
  EXPECT_LE(slug_of(std::string(500, 'a')).size(), 60u);
}

// A comparison of two systems at one field, whose spots and wavefronts are given.
Comparison comparison_of(double first_rms, double other_rms, bool other_is_of_facets) {
  Comparison comparison{"Test", {}, 0};
  for (const double rms : {first_rms, other_rms}) {
    ComparedSystem system{{}, rms == first_rms ? "a" : "b", std::nullopt, {}};
    system.report.system = rms == first_rms ? "A" : "B";
    system.report.fields = {{0, 0}};
    system.report.wavelengths_nm = {550};
    system.report.surface_names = {"one", "two"};
    system.report.first_order.entrance_pupil.semi_diameter = 2;
    if (other_is_of_facets && rms == other_rms) system.report.surfaces_of_flat_facets = {1};
    analysis::JobResult result;
    result.spot = analysis::Spot{};
    result.spot->rms_radius = rms;
    result.spot_image = analysis::SpotImage(64, 0.01, 0, 0);
    result.spot_image->add(0.001, 0.001);
    result.spot_image->add(0.2, 0.2);
    analysis::Wavefront wavefront;
    wavefront.size = 8;
    wavefront.mask.assign(64, 0);
    for (int i = 0; i < 64; ++i) wavefront.opd_waves.push_back(rms * (i + (i % 8 - 3.5) * (i / 8 - 3.5)));
    result.wavefront = analysis::WavefrontResult{std::move(wavefront), {}, {}};
    system.report.results = {std::move(result)};
    comparison.systems.push_back(std::move(system));
  }
  for (ComparedSystem& system : comparison.systems)
    system.differences = analysis::differences(system.report.results, comparison.systems.front().report.results);
  return comparison;
}

TEST(Comparison, sheets_have_a_row_for_each_system_and_common_scales) {
  const Comparison comparison = comparison_of(0.01, 0.02, false);
  const auto figures = sheets(comparison);
  ASSERT_EQ(figures.size(), 1u);
  const std::vector<Panel>& panels = figures[0].panels;
  ASSERT_EQ(panels.size(), 6u);
  EXPECT_EQ(figures[0].columns, 3);
  EXPECT_EQ(panels[0].title, "A: spot");
  EXPECT_EQ(panels[4].title, "B: wavefront");
  EXPECT_EQ(panels[5].title, "B − A");
  ASSERT_TRUE(panels[1].range && panels[4].range && panels[5].range);
  EXPECT_FLOAT_EQ(static_cast<float>(panels[1].range->high), 0.02f * 75.25f);
  EXPECT_EQ(panels[1].range->high, panels[4].range->high);
  EXPECT_EQ(panels[5].range->low, -panels[5].range->high);
  // the difference 0.01 (i + x y), x and y from the middle: i is a plane, x y has none; floats round the sums up to 1.5 by 9e-8
  EXPECT_NEAR(panels[5].map.values.front(), 0.01 * 12.25, 1e-7);
  EXPECT_NEAR(panels[5].map.values[7], -0.01 * 12.25, 1e-7);
  EXPECT_EQ(panels[5].subtitle.front().find("RMS without piston and tilt "), 0u);
  EXPECT_NE(figures[0].footer.find("without piston and tilt"), std::string::npos);
  // three of the larger RMS radius to each side, 0.06 mm, are 12 pixels; the ray at 0.2 mm is beyond
  for (const std::size_t i : {0, 3}) {
    EXPECT_EQ(panels[i].map.width, 12);
    EXPECT_EQ(panels[i].map.values.size(), 144u);
    EXPECT_NE(panels[i].subtitle.back().find("1 beyond the picture"), std::string::npos);
  }
}

TEST(Comparison, wavefronts_of_flat_facets_are_marked_and_do_not_set_the_scale) {
  const Comparison comparison = comparison_of(0.01, 0.02, true);
  const std::vector<Panel> panels = sheets(comparison)[0].panels;
  EXPECT_NE(panels[4].subtitle.back().find("flat facets"), std::string::npos);
  EXPECT_EQ(panels[1].subtitle.back().find("flat facets"), std::string::npos);
  EXPECT_NE(summary_text(comparison).find("B: surface 1 one: flat facets (interpolation: linear) are unusable for wavefronts"), std::string::npos);
  EXPECT_NE(summary_json(comparison).find("\"note\": \"surface 1 one: flat facets"), std::string::npos);
  ASSERT_TRUE(panels[5].range);  // of the facets after all, as there is nothing else
  EXPECT_GT(panels[5].range->high, 0);
}

TEST(Comparison, parts_have_names_of_their_own_and_differences_their_mask) {
  const auto all = parts(comparison_of(0.01, 0.02, true));
  std::set<std::string> names;
  for (const ExrPart& part : all) names.insert(part.name);
  EXPECT_EQ(names, (std::set<std::string>{"a.spot.field0.550nm", "a.wavefront.field0.550nm", "b.spot.field0.550nm",
                                          "b.wavefront.field0.550nm", "b-minus-a.wavefront.field0.550nm"}));
  EXPECT_EQ(all.size(), 5u);
  for (const ExrPart& part : all) {
    std::set<std::string> attributes;
    for (const ExrAttribute& one : part.attributes) EXPECT_TRUE(attributes.insert(one.name).second) << part.name << ' ' << one.name;
    EXPECT_EQ(attributes.contains("note"), part.name.starts_with("b") && part.name.find("wavefront") != std::string::npos) << part.name;
    if (part.name.starts_with("b-minus")) {
      ASSERT_EQ(part.channels.size(), 2u);
      EXPECT_EQ(part.channels[1].name, "difference.mask");
    }
  }
}

}  // namespace
}  // namespace sagitta::output
