// SPDX-License-Identifier: Apache-2.0
// Catalogues written here, glass by glass against the formulas of OpticStudio's manual in 50 digits.
#include "lib/prescription/agf_reader.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <boost/multiprecision/cpp_dec_float.hpp>
#include <filesystem>
#include <functional>
#include <sstream>

#include "lib/prescription/material_search.h"
#include "tests/prescription/support.h"

namespace sagitta::prescription {
namespace {

using test::TemporaryFolder;
using ::testing::HasSubstr;
using Real = boost::multiprecision::number<boost::multiprecision::cpp_dec_float<50>, boost::multiprecision::et_off>;
using Coefficients = std::vector<Real>;

std::string said(const Findings& findings) {
  std::string text;
  for (Finding finding : findings.all()) {
    finding.place.file = std::filesystem::path(finding.place.file).filename().string();
    text += format(finding) + '\n';
  }
  return text;
}

AgfCatalog read(const std::string& bytes, const std::string& expected_findings = "") {
  const TemporaryFolder folder;
  Findings findings;
  auto catalog = read_agf(folder.write("glasses.agf", bytes), findings);
  EXPECT_EQ(said(findings), expected_findings);
  return catalog.value_or(AgfCatalog{});
}

std::optional<Material> glass_of(const AgfCatalog& catalog, const std::string& name, const std::string& expected_findings = "") {
  Findings findings;
  const AgfGlass* glass = catalog.find(name);
  if (!glass) {
    ADD_FAILURE() << "no glass " << name;
    return std::nullopt;
  }
  auto material = read_glass(catalog, *glass, findings);
  EXPECT_EQ(said(findings), expected_findings);
  return material;
}

struct Case {
  int formula;
  std::vector<std::string> coefficients;
  std::function<Real(const Coefficients&, Real)> index;  // c[1] is c1
};

// Coefficients of every formula, all different from zero, so that none can stand in another's place unseen.
const std::vector<Case>& cases() {
  static const std::vector<std::string> sellmeier{"1.03961212", "0.00600069867", "0.231792344", "0.0200179144", "1.01046945", "103.560653", "0.0123", "0.031", "0.0077", "88.25"};
  static const std::vector<std::string> series{"2.27", "-0.0097", "0.0108", "0.00031", "-0.000011", "0.0000017", "0.00000023", "-0.000000019", "0.0000000057"};
  const auto first = [](const std::vector<std::string>& all, std::size_t count) { return std::vector<std::string>(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(count)); };
  const auto sum_of_terms = [](int terms) {
    return [terms](const Coefficients& c, Real w) {
      Real square = 1;
      for (std::size_t i = 1; i < 2 * static_cast<std::size_t>(terms); i += 2) square += c[i] * w * w / (w * w - c[i + 1]);
      return sqrt(square);
    };
  };
  static const std::vector<Case> all = {
      {1, first(series, 6), [](const Coefficients& c, Real w) { return sqrt(c[1] + c[2] * pow(w, 2) + c[3] / pow(w, 2) + c[4] / pow(w, 4) + c[5] / pow(w, 6) + c[6] / pow(w, 8)); }},
      {2, first(sellmeier, 6), sum_of_terms(3)},
      {3, {"1.5", "0.0041", "-0.00021", "-0.0033", "0.0007", "-0.00009"},
       [](const Coefficients& c, Real w) {
         const Real H = 1 / (w * w - Real("0.028"));
         return c[1] + c[2] * H + c[3] * H * H + c[4] * pow(w, 2) + c[5] * pow(w, 4) + c[6] * pow(w, 6);
       }},
      {4, {"0.31", "1.07", "0.11", "-0.9", "9.7"}, [](const Coefficients& c, Real w) { return sqrt(1 + c[1] + c[2] * w * w / (w * w - c[3] * c[3]) + c[4] / (w * w - c[5] * c[5])); }},
      {5, {"1.49", "0.0113", "0.00047"}, [](const Coefficients& c, Real w) { return c[1] + c[2] / w + c[3] / pow(w, Real("3.5")); }},
      {6, first(sellmeier, 8), sum_of_terms(4)},
      {7, {"2.38", "0.0131", "0.017", "0.0093"}, [](const Coefficients& c, Real w) { return sqrt(c[1] + c[2] / (w * w - c[3]) - c[4] * w * w); }},
      {8, {"1.31", "1.08", "0.0115", "0.0093"}, [](const Coefficients& c, Real w) { return sqrt(c[1] + c[2] * w * w / (w * w - c[3]) - c[4] * w * w); }},
      {9, {"1.31", "1.08", "0.0115", "0.87", "101.5"}, [](const Coefficients& c, Real w) { return sqrt(c[1] + c[2] * w * w / (w * w - c[3]) + c[4] * w * w / (w * w - c[5])); }},
      {10, first(series, 8),
       [](const Coefficients& c, Real w) {
         return sqrt(c[1] + c[2] * pow(w, 2) + c[3] / pow(w, 2) + c[4] / pow(w, 4) + c[5] / pow(w, 6) + c[6] / pow(w, 8) + c[7] / pow(w, 10) + c[8] / pow(w, 12));
       }},
      {11, first(sellmeier, 10), sum_of_terms(5)},
      {12, first(series, 8),
       [](const Coefficients& c, Real w) {
         return sqrt(c[1] + c[2] * pow(w, 2) + c[3] / pow(w, 2) + c[4] / pow(w, 4) + c[5] / pow(w, 6) + c[6] / pow(w, 8) + c[7] * pow(w, 4) + c[8] * pow(w, 6));
       }},
      {13, first(series, 9),
       [](const Coefficients& c, Real w) {
         return sqrt(c[1] + c[2] * pow(w, 2) + c[3] * pow(w, 4) + c[4] / pow(w, 2) + c[5] / pow(w, 4) + c[6] / pow(w, 6) + c[7] / pow(w, 8) + c[8] / pow(w, 10) + c[9] / pow(w, 12));
       }}};
  return all;
}

std::string line_of(const std::vector<std::string>& words) {
  std::string line = "CD";
  for (const std::string& word : words) line += " " + word;
  return line + "\n";
}

TEST(AgfReader, EveryFormulaIsThatOfTheManual) {
  std::string text = "CC All formulas\n";
  for (const Case& one : cases()) text += fmt::format("NM F{0} {0} 517642 1.5 60 0 1\n{1}LD 0.4 1.6\n", one.formula, line_of(one.coefficients));
  const AgfCatalog catalog = read(text);
  ASSERT_EQ(catalog.glasses.size(), 13U);
  int compared = 0;
  for (const Case& one : cases()) {
    const auto glass = glass_of(catalog, "F" + std::to_string(one.formula));
    ASSERT_TRUE(glass);
    Coefficients exact{0};
    for (const std::string& word : one.coefficients) exact.emplace_back(word);
    for (int i = 0; i <= 24; ++i, ++compared) {
      const double um = 0.4 + (1.6 - 0.4) * i / 24;
      // The bound of formulas_test.cc, and half an ulp of 1 + c1.
      EXPECT_NEAR(glass->index(um) / one.index(exact, Real(um)).convert_to<double>(), 1, 7.2e-15) << one.formula << " at " << um;
    }
  }
  EXPECT_EQ(compared, 13 * 25);
}

constexpr const char* n_bk7 = "NM N-BK7 2 517642.251 1.5168 64.17 0 1\n"
                              "GC standard crown\n"
                              "ED 7.1 8.3 2.51 -0.0009 0\n"
                              "CD 1.03961212E+000 6.00069867E-003 2.31792344E-001 2.00179144E-002 1.01046945E+000 1.03560653E+002 0 0 0 0\n"
                              "TD 1.86E-06 1.31E-08 -1.37E-11 4.34E-07 6.27E-10 0.17 20\n"
                              "OD 1 2 0 1 2.3 2.3\n"
                              "LD 3.0E-001 2.5\n"
                              "IT 0.3 0.05 25\n";

TEST(AgfReader, AGlassIsTheMediumOfTheSameCoefficients) {
  const auto glass = glass_of(read(n_bk7), "N-BK7");
  Findings findings;
  const auto shipped = find_material("N-BK7", {SAGITTA_SOURCE_DIR "/systems/x.yaml"}, findings);
  ASSERT_TRUE(glass && shipped);
  EXPECT_EQ(glass->shortest_um, 0.3);
  EXPECT_EQ(glass->longest_um, 2.5);
  for (int i = 0; i <= 100; ++i) EXPECT_EQ(glass->index(0.3 + 0.022 * i), shipped->index(0.3 + 0.022 * i));
  EXPECT_NEAR(glass->index(0.5875618), 1.5168000, 1e-6);  // E20
  EXPECT_NEAR(glass->index(0.6328), 1.5150892, 1e-6);
  EXPECT_EQ(glass->comments, "standard crown");
  EXPECT_EQ(glass->references, "glasses.agf, AGF formula 2, Sellmeier 1");
  EXPECT_EQ(glass->place.line, 1);
}

std::string in_utf_16(const std::string& latin_1, bool low_end_first) {
  std::string bytes = low_end_first ? "\xFF\xFE" : "\xFE\xFF";
  for (const char c : latin_1) bytes += low_end_first ? std::string{c, '\0'} : std::string{'\0', c};
  return bytes;
}

TEST(AgfReader, ReadsEveryEncodingAndLineEnd) {
  const std::string latin_1 = std::string("CC Gl\xE4ser\n") + n_bk7, utf_8 = std::string("CC Gl\xC3\xA4ser\n") + n_bk7;
  std::string crlf = utf_8, cr = utf_8;
  for (std::size_t at = 0; (at = crlf.find('\n', at)) != std::string::npos; at += 2) crlf.replace(at, 1, "\r\n");
  std::replace(cr.begin(), cr.end(), '\n', '\r');
  int count = 0;
  for (const std::string& bytes : {latin_1, utf_8, "\xEF\xBB\xBF" + utf_8, in_utf_16(latin_1, true), in_utf_16(latin_1, false), crlf, cr, utf_8.substr(0, utf_8.size() - 1)}) {
    const AgfCatalog catalog = read(bytes);
    EXPECT_EQ(catalog.comment, "Gl\xC3\xA4ser");
    const auto glass = glass_of(catalog, "N-BK7");
    ASSERT_TRUE(glass);
    EXPECT_EQ(glass->place.line, 2);
    EXPECT_NEAR(glass->index(0.6328), 1.5150892, 1e-6);
    ++count;
  }
  EXPECT_EQ(count, 8);
}

TEST(AgfReader, ToleratesWhatIsCutShortAndWhatItDoesNotKnow) {
  // A name and a formula are enough of NM; coefficients left out are zero; formula 2 with one term: n^2 = 1 + 3 L^2/L^2.
  const AgfCatalog catalog = read("! not of the format\nXX 1\n\n  NM\tA&* 2.0\n\tCD 3\n LD 0.5 1 \nZZ\nTD\nIT\n");
  const auto glass = glass_of(catalog, "A&*");
  ASSERT_TRUE(glass);
  EXPECT_EQ(glass->index(0.7), 2);
}

TEST(AgfReader, OfARepeatedNameTheFirstCountsWithAWarning) {
  const AgfCatalog catalog = read("NM A 5\nCD 1.5\nLD 0.4 1\nNM A 5\nCD 1.7\nLD 0.4 2\nNM A 5\nCD 1.8\n",
                                  "glasses.agf:4:4: warning: 2 of the glasses have a name that stands here before, the first one on this line; not used\n");
  EXPECT_EQ(catalog.glasses.size(), 1U);
  EXPECT_EQ(glass_of(catalog, "A")->index(0.5), 1.5);
  EXPECT_EQ(glass_of(catalog, "A")->longest_um, 1);
}

TEST(AgfReader, AFaultIsToldWhereItStandsAndHindersNoOtherGlass) {
  const AgfCatalog catalog = read(
      "NM good 5\nCD 1.5\nLD 0.4 1\n"
      "NM unnumbered\nCD 1.5\nLD 0.4 1\n"
      "NM unknown 14\nCD 1.5\nLD 0.4 1\n"
      "NM half 1.5\nCD 1.5\nLD 0.4 1\n"
      "NM word Schott\nCD 1.5\nLD 0.4 1\n"
      "NM bare 5\nLD 0.4 1\n"
      "NM zero 2\nCD 0 0 0\nLD 0.4 1\n"
      "NM comma 5\nCD 1,5\nLD 0.4 1\n"
      "NM infinite 5\nCD 1.5 nan\nLD 0.4 1\n"
      "NM rangeless 5\nCD 1.5\n"
      "NM short 5\nCD 1.5\nLD 0.4\n"
      "NM turned 5\nCD 1.5\nLD 1 0.4\n"
      "NM nowhere 5\nCD 1.5\nLD 0 0\n"
      "NM pole 2\nCD 1 0.25\nLD 0.4 1\n"
      "NM twice 5\nGC one\nGC two\nCD 1.5\nLD 0.4 1\nCD 1.6\nCD 1.7\nLD 0.4 2\n");
  EXPECT_TRUE(glass_of(catalog, "good"));
  const std::vector<std::pair<std::string, std::string>> expected = {
      {"unnumbered", "glasses.agf:4:1: error: glass 'unnumbered': no number of a dispersion formula\n  hint: NM NAME FORMULA ..., 1 to 13\n"},
      {"unknown", "glasses.agf:7:12: error: glass 'unknown': unknown dispersion formula '14'\n  hint: formulas are numbered 1 to 13\n"},
      {"half", "glasses.agf:10:9: error: glass 'half': unknown dispersion formula '1.5'\n  hint: formulas are numbered 1 to 13\n"},
      {"word", "glasses.agf:13:9: error: glass 'word': 'Schott' is not a finite number\n"},
      {"bare", "glasses.agf:16:1: error: glass 'bare': no coefficients\n  hint: a line `CD c1 c2 ...` gives them\n"},
      {"zero", "glasses.agf:19:1: error: glass 'zero': all coefficients are zero\n"},
      {"comma", "glasses.agf:22:4: error: glass 'comma': '1,5' is not a finite number\n"},
      {"infinite", "glasses.agf:25:8: error: glass 'infinite': 'nan' is not a finite number\n"},
      {"rangeless", "glasses.agf:27:1: error: glass 'rangeless': no range\n  hint: a line `LD MIN MAX` gives it, in um\n"},
      {"short", "glasses.agf:31:1: error: glass 'short': no range\n  hint: a line `LD MIN MAX` gives it, in um\n"},
      {"turned", "glasses.agf:34:1: error: glass 'turned': the range 1 to 0.4 is not two wavelengths in um, 1e-09 <= shortest <= longest <= 1000000000\n  hint: swap them\n"},
      {"nowhere", "glasses.agf:37:1: error: glass 'nowhere': the range 0 to 0 is not two wavelengths in um, 1e-09 <= shortest <= longest <= 1000000000\n"},
      {"pole", "glasses.agf:39:1: error: glass 'pole': formula 2 (Sellmeier 1) gives no index from 0.001 to 1000 at 0.4 um, inside its range\n"
               "  hint: check CD, LD and the number of the formula in NM\n"},
      {"twice", "glasses.agf:46:1: error: glass 'twice': a second line of coefficients\n  hint: the first is line 44: one of them must go\n"
                "glasses.agf:48:1: error: glass 'twice': a second line of range\n  hint: the first is line 45: one of them must go\n"}};
  EXPECT_EQ(catalog.glasses.size(), expected.size() + 1);
  for (const auto& [name, findings] : expected) EXPECT_FALSE(glass_of(catalog, name, findings)) << name;
}

TEST(AgfReader, WhatIsNoCatalogueIsAnError) {
  const std::string none = "glasses.agf:1:1: error: no glass: not a catalogue in the AGF format\n  hint: a glass begins with a line `NM NAME FORMULA ...`\n";
  read("", none);
  read("CC a comment alone\nCD 1 2 3\nLD 0.4 1\n", none);
  read(std::string(1000, '\0'), none);
  read("NM\nNM \n", none);
  Findings findings;
  EXPECT_FALSE(read_agf("/nowhere/glasses.agf", findings));
  EXPECT_THAT(said(findings), HasSubstr("there is no such file"));
}

TEST(AgfReader, HasLimits) {
  std::string many;
  for (std::size_t i = 0; i <= most_agf_glasses; ++i) many += fmt::format("NM G{} 5\n", i);
  read(many, "glasses.agf:20001:1: error: more than 20000 glasses\n  hint: split the catalogue\n");
  read(std::string(most_agf_bytes + 1, 'x'), "glasses.agf:1:1: error: larger than 16 MiB, which no such file needs\n  hint: split the catalogue\n");
}

std::string lens(const std::string& medium, const std::string& keys) {
  return "sagitta: 1\n" + keys + "wavelengths_nm: [587.6]\naperture: {entrance_pupil_diameter_mm: 2}\nsurfaces:\n  - {stop: true, conic: {radius_mm: 50}, thickness_mm: 3, medium: " + medium +
         "}\n  - {}\n";
}

struct Outcome {
  std::string findings;
  std::optional<double> index;  // at 587.6 nm, of the medium after surface 1
};

Outcome read_lens(const TemporaryFolder& folder, const std::string& medium, const std::string& keys) {
  const ReadResult result = read_prescription(folder.write("system.yaml", lens(medium, keys)));
  Outcome outcome{said(result.findings), {}};
  if (result.model) outcome.index = result.model->surfaces[0].medium->index(0.5876);
  return outcome;
}

TEST(Catalogs, AreSearchedBehindTheFolderOfThePrescriptionAndBeforeTheShippedMedia) {
  const TemporaryFolder folder;
  folder.write("a.agf", "NM X 5\nCD 1.25\nLD 0.4 1\nNM N-BK7 5\nCD 1.75\nLD 0.4 1\n");
  folder.write("b.agf", "NM X 5\nCD 1.5\nLD 0.4 1\nNM Y 5\nCD 1.625\nLD 0.4 1\n");
  const std::string both = "catalogs: [a.agf, b.agf]\n";
  EXPECT_EQ(read_lens(folder, "Y", both).index, 1.625);
  EXPECT_EQ(read_lens(folder, "Y", both).findings, "");
  EXPECT_EQ(read_lens(folder, "X", both).index, 1.25);
  EXPECT_EQ(read_lens(folder, "X", both).findings, "system.yaml:6:67: note: X is taken from a.agf, line 1; b.agf, line 1 has another index, by up to 0.25\n");
  EXPECT_EQ(read_lens(folder, "X", "catalogs: [b.agf, a.agf]\n").index, 1.5);
  EXPECT_EQ(read_lens(folder, "N-BK7", both).index, 1.75);
  EXPECT_THAT(read_lens(folder, "N-BK7", both).findings, HasSubstr("N-BK7 is taken from a.agf, line 4; N-BK7.yml has another index, by up to 0.24"));
  EXPECT_NEAR(*read_lens(folder, "N-BK7", "catalogs: [b.agf]\n").index, 1.5168, 1e-4);
  EXPECT_EQ(read_lens(folder, "N-BK7", "catalogs: [b.agf]\n").findings, "");
  folder.write("X.yml", "DATA:\n  - {type: formula 5, wavelength_range: 0.4 1, coefficients: 1.125}\n");
  EXPECT_EQ(read_lens(folder, "X", both).index, 1.125);
}

TEST(Catalogs, WithTheSameValuesNothingIsTold) {
  const TemporaryFolder folder;
  folder.write("schott.agf", n_bk7);
  EXPECT_EQ(read_lens(folder, "N-BK7", "catalogs: [schott.agf]\n").findings, "");
}

TEST(Catalogs, OfABaseAreSearchedToo) {
  const TemporaryFolder folder;
  folder.write("a.agf", "NM X 5\nCD 1.25\nLD 0.4 1\n");
  folder.write("base.yaml", lens("X", "catalogs: [a.agf]\n"));
  const ReadResult result = read_prescription(folder.write("changed.yaml", "sagitta: 1\nextends: base.yaml\nname: changed\n"));
  ASSERT_TRUE(result.model) << said(result.findings);
  EXPECT_EQ(result.model->surfaces[0].medium->index(0.5), 1.25);
}

TEST(Catalogs, FaultsNameThePrescription) {
  const TemporaryFolder folder;
  folder.write("a.agf", "NM Glass-1 99\nCD 1.25\nLD 0.4 1\n");
  folder.write("empty.agf", "");
  EXPECT_EQ(read_lens(folder, "Glass-1", "catalogs: [a.agf]\n").findings,
            "a.agf:1:12: error: glass 'Glass-1': unknown dispersion formula '99'\n  hint: formulas are numbered 1 to 13\nsystem.yaml:6:67: note: named here\n");
  EXPECT_EQ(read_lens(folder, "glass-1", "catalogs: [a.agf]\n").findings, "system.yaml:6:67: error: unknown medium 'glass-1'\n  hint: did you mean 'Glass-1'?\n");
  EXPECT_EQ(read_lens(folder, "air", "catalogs: [a.agf, empty.agf]\n").findings,
            "empty.agf:1:1: error: no glass: not a catalogue in the AGF format\n  hint: a glass begins with a line `NM NAME FORMULA ...`\nsystem.yaml:2:19: note: named here\n");
  EXPECT_THAT(read_lens(folder, "air", "catalogs: [missing.agf]\n").findings, HasSubstr("system.yaml:2:12: error: there is no file 'missing.agf'\n"));
  EXPECT_THAT(read_lens(folder, "air", "catalogs: a.agf\n").findings, HasSubstr("system.yaml:2:11: error: catalogs must be a list of at most 16 files, not"));
  EXPECT_THAT(read_lens(folder, "air", "catalogs: [[a.agf]]\n").findings, HasSubstr("each of catalogs must be"));
}

}  // namespace
}  // namespace sagitta::prescription
