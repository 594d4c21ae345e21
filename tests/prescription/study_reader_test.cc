// SPDX-License-Identifier: Apache-2.0
#include "lib/prescription/study_reader.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "lib/prescription/study_keys.h"
#include "lib/surface/facets.h"
#include "tests/prescription/support.h"

namespace sagitta::prescription::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::string lens =
    "sagitta: 1\nname: Lens\nwavelengths_nm: [855]\naperture: {entrance_pupil_diameter_mm: 4}\nsurfaces:\n"
    "  - {name: front, stop: true, conic: {radius_mm: 20}, thickness_mm: 40, medium: {index: 1.5}}\n  - {name: image}\n";
const std::string head = "sagitta_study: 1\nname: tiny\nsystem: lens.yaml\nsurface: front\n";

StudyReadResult read(const std::string& study) {
  const TemporaryFolder folder;
  folder.write("lens.yaml", lens);
  return read_study(folder.write("study.yaml", study));
}

TEST(StudyReader, MultipliesListsOutByTheOrderOfTheKeys) {
  const auto result = read(head + "variants:\n  - points_per_mm2: [4, 9]\n    interpolation: [linear, c1]\n    rays: 100\n  - {interpolation: analytic, seed: [1, 2]}\n");
  ASSERT_TRUE(result.study) << text_of(result.findings);
  std::vector<std::string> found;
  for (const Parameters& one : result.study->variants)
    found.push_back(fmt::format("{} {} {} {}", one.text("interpolation"), one.number("points_per_mm2"), one.number("rays"), one.number("seed")));
  EXPECT_THAT(found, ElementsAre("linear 4 100 1", "linear 9 100 1", "c1 4 100 1", "c1 9 100 1", "analytic 0 10000 1", "analytic 0 10000 2"));
  EXPECT_EQ(result.study->surface_number, 1);
  EXPECT_EQ(result.study->system.name, "Lens");
  EXPECT_EQ(result.study->title, "tiny");
}

TEST(StudyReader, RoughnessIsMultipliedOutToo) {
  const auto result = read(head + "variants:\n  - points_per_mm: 10\n    roughness: [{rms_um: 0}, {rms_um: 0.1, correlation_length_um: [1, 1000], truth: clean}]\n    seed: [1, 2]\n");
  ASSERT_TRUE(result.study) << text_of(result.findings);
  std::vector<std::string> found;
  for (const Parameters& one : result.study->variants)
    found.push_back(fmt::format("{} {} {} {} {}", one.number("rms_um"), one.number("correlation_length_um"), one.text("truth"), one.number("seed"), one.number("points_per_mm2")));
  EXPECT_THAT(found, ElementsAre("0 1000 noisy 1 100", "0 1000 noisy 2 100", "0.1 1 clean 1 100", "0.1 1 clean 2 100", "0.1 1000 clean 1 100", "0.1 1000 clean 2 100"));
}

TEST(StudyReader, VariantsNameTheirSurfaceAndFieldOrHaveTheStudys) {
  const TemporaryFolder folder;
  folder.write("lens.yaml", "fields: {angles_deg: [[0, 0], [0, 5], [0, 10]]}\n" + lens);
  const auto result = read_study(folder.write("study.yaml", head + "field: 1\nvariants:\n  - {interpolation: analytic, surface: [image, front], field: [2, 0]}\n  - interpolation: analytic\n"));
  ASSERT_TRUE(result.study) << text_of(result.findings);
  std::vector<std::string> found;
  for (const Parameters& one : result.study->variants) found.push_back(fmt::format("{} {} {}", one.text("surface"), surface_number_of(*result.study, one), field_of(one)));
  EXPECT_THAT(found, ElementsAre("image 2 2", "image 2 0", "front 1 2", "front 1 0", "front 1 1"));
}

TEST(StudyReader, KnowsEveryInterpolationOfDelaunay) {
  const auto of = [](KeyTable keys) {
    for (const numerics::Key& key : keys)
      if (key.name == "interpolation") return numerics::words_of(key.choices);
    return std::vector<std::string>{};
  };
  auto expected = of(surface::Facets::keys);
  ASSERT_EQ(expected.size(), 5u);
  expected.emplace_back("analytic");
  EXPECT_THAT(of(variant_keys), testing::UnorderedElementsAreArray(expected));
}

TEST(StudyReader, FiguresOfThePaperFindTheirVariants) {
  const auto result = read(head + "variants:\n  - {points_per_mm2: [4, 9], seed: [1, 2]}\npaper:\n  - {where: {points_per_mm: 3}, distance_mean_um: .5, note: table 1}\n");
  ASSERT_TRUE(result.study) << text_of(result.findings);
  ASSERT_EQ(result.study->paper.size(), 1u);
  const PublishedFigure& figure = result.study->paper.front();
  EXPECT_THAT(figure.values, ElementsAre(testing::Pair("distance_mean_um", .5)));
  EXPECT_EQ(figure.note, "table 1");
  std::vector<bool> has;
  for (const Parameters& one : result.study->variants) has.push_back(has_settings(one, figure.where));
  EXPECT_THAT(has, ElementsAre(false, false, true, true));
}

struct Mistake {
  std::string name, study;
  std::vector<std::string> said;  // each once; lines and columns are counted by hand

  friend void PrintTo(const Mistake& mistake, std::ostream* out) { *out << mistake.name; }
};

class StudyMistakes : public testing::TestWithParam<Mistake> {};

TEST_P(StudyMistakes, GetTheirPlaceAndAHint) {
  const auto result = read(GetParam().study);
  EXPECT_FALSE(result.study);
  const std::string text = text_of(result.findings);
  for (const std::string& said : GetParam().said) EXPECT_THAT(text, HasSubstr(said));
  EXPECT_EQ(static_cast<std::size_t>(result.findings.error_count()), GetParam().said.size()) << text;
}

INSTANTIATE_TEST_SUITE_P(
    All, StudyMistakes,
    testing::Values(
        Mistake{"keys", head + "titel: x\nvariants:\n  - {interpolatio: c1, points_per_mm2: 4}\n",
                {"study.yaml:5:1: error: unknown key 'titel' in the study\n  hint: did you mean 'title'?", "study.yaml:7:6: error: unknown key 'interpolatio' in block 1 of variants\n  hint: did you mean 'interpolation'?"}},
        Mistake{"values", head + "variants:\n  - interpolation: [linear, c2]\n    points_per_mm2: [4, -1]\n    rays: 1.5\n    pattern: random:x\n",
                {"study.yaml:6:29: error: interpolation must be one of linear, c1, cubic, thin_plate, multiquadric, analytic, not 'c2'\n  hint: did you mean 'c1'?",
                 "study.yaml:7:25: error: points_per_mm2 must be a number from 1e-09 to 1000000000000, not '-1'", "study.yaml:8:11: error: rays must be a whole number from 1 to 1000000000, not '1.5'",
                 "study.yaml:9:14: error: pattern must be one of hexapolar, square, fan_x, fan_y, random:SEED, not 'random:x'"}},
        Mistake{"missing", "sagitta_study: 1\n", {"missing key 'name' in the study", "missing key 'system'", "missing key 'surface'", "missing key 'variants'"}},
        Mistake{"version", "sagitta_study: 2\n" + head.substr(17) + "variants:\n  - {interpolation: analytic}\n", {"study.yaml:1:16: error: sagitta_study must be 1, not '2'"}},
        Mistake{"name", "sagitta_study: 1\nname: a b/c\n" + head.substr(28) + "variants:\n  - {interpolation: analytic}\n",
                {"study.yaml:2:7: error: name must be of at most 60 letters, digits, - and _, not 'a b/c'\n  hint: title takes any text"}},
        Mistake{"surface", "sagitta_study: 1\nname: tiny\nsystem: lens.yaml\nsurface: frond\nfield: 1\nvariants:\n  - {interpolation: analytic}\n",
                {"study.yaml:4:10: error: there is no surface 'frond' in lens.yaml\n  hint: did you mean 'front'?", "study.yaml:5:8: error: there is no field 1"}},
        Mistake{"surface_of_a_variant", head + "variants:\n  - {interpolation: analytic, surface: [image, frond], field: 0}\n  - {interpolation: analytic, field: [0, 1]}\n  - {interpolation: analytic, surface: '', field: -1}\n",
                {"study.yaml:6:48: error: there is no surface 'frond' in lens.yaml\n  hint: did you mean 'front'?", "study.yaml:7:42: error: there is no field 1\n  hint: the system has 0 to 0",
                 "study.yaml:8:40: error: surface must be a text", "study.yaml:8:51: error: field must be a whole number"}},
        Mistake{"file", "sagitta_study: 1\nname: tiny\nsystem: lense.yaml\nsurface: front\nvariants:\n  - {interpolation: analytic}\n",
                {"study.yaml:3:9: error: there is no file 'lense.yaml'\n  hint: looked for in"}},
        Mistake{"density", head + "variants:\n  - {interpolation: c1}\n  - {points_per_mm: 2, points_per_mm2: 4}\n",
                {"study.yaml:6:5: error: interpolation c1 needs a density\n  hint: give points_per_mm2", "study.yaml:7:21: error: 'points_per_mm' beside 'points_per_mm2'"}},
        Mistake{"uses", head + "variants:\n  - {interpolation: c1, points_per_mm2: 4, search: nearest_vertex}\n  - {points_per_mm2: 4, tolerance_mm: 1e-6}\n  - {arrangement: rings, rings: 4}\n",
                {"study.yaml:6:52: error: the nearest vertex is looked for on linear facets, not with interpolation: c1", "study.yaml:7:39: error: tolerance_mm has no use with interpolation: linear",
                 "study.yaml:8:33: error: rings and meridians stand together"}},
        // Found by review, 2026-11-22: all of these were taken.
        Mistake{"contradictions", head + "variants:\n  - {arrangement: rings, rings: 6, meridians: 20, points_per_mm2: 3}\n  - {interpolation: analytic, points_per_mm: 2}\n  - {points_per_mm2: 4, margin_spacings: 2, cloud_radius_mm: 5}\n  - {points_per_mm2: 4, roughness: {truth: clean}}\n",
                {"study.yaml:6:67: error: a density beside rings and meridians\n  hint: keep one", "study.yaml:7:46: error: points_per_mm2 has no use with interpolation: analytic", "study.yaml:8:62: error: cloud_radius_mm beside margin_spacings",
                 "study.yaml:9:44: error: a truth without a roughness\n  hint: give rms_um"}},
        Mistake{"twice", head + "variants:\n  - {points_per_mm2: [4, 9]}\n  - {interpolation: [linear, c1], points_per_mm2: 9}\n",
                {"study.yaml:7:5: error: variants 2 and 3 are the same\n  hint: each is to stand once"}},
        Mistake{"lists", head + "variants:\n  - {points_per_mm2: [[4]], seed: []}\npaper:\n  - {where: {points_per_mm2: [4, 9]}, angle_mean_arcmin: 1}\n",
                {"study.yaml:6:23: error: each of points_per_mm2 must be a single value, not a list of 1", "study.yaml:6:35: error: seed must be", "study.yaml:8:30: error: points_per_mm2 must be"}},
        Mistake{"paper", head + "variants:\n  - {points_per_mm2: 4}\npaper:\n  - {where: {points_per_mm2: 5}, angle_mean_arcmin: 1}\n",
                {"study.yaml:8:13: error: no variant has these settings"}},
        Mistake{"many", head + "variants:\n  - {points_per_mm2: [" + [] { std::string all = "1"; for (int i = 2; i <= 101; ++i) all += fmt::format(", {}", i); return all + "], seed: [" + all + "]"; }() + "}\n",
                {"has more than 10000 variants"}}),
    [](const auto& mistake) { return mistake.param.name; });

TEST(StudyReader, FaultInTheSystemIsSaidWithTheStudysPlace) {
  const TemporaryFolder folder;
  folder.write("lens.yaml", lens + "colour: red\n");
  const auto result = read_study(folder.write("study.yaml", head + "variants:\n  - {interpolation: analytic}\n"));
  EXPECT_FALSE(result.study);
  const std::string text = text_of(result.findings);
  EXPECT_THAT(text, HasSubstr("lens.yaml:8:1: error: unknown key 'colour' in the prescription"));
  EXPECT_THAT(text, HasSubstr("study.yaml:3:9: note: named here"));
}

TEST(StudyReader, ReadsEveryShippedStudy) {
  int read_count = 0;
  for (const std::string& name : study_names()) {
    const auto file = find_study(name);
    ASSERT_TRUE(file) << name;
    const auto result = read_study(*file);
    ASSERT_TRUE(result.study) << text_of(result.findings);
    EXPECT_EQ(result.study->name, name);
    ++read_count;
  }
  EXPECT_GE(read_count, 1);
}

}  // namespace
}  // namespace sagitta::prescription::test
