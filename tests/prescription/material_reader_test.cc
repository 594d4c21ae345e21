// SPDX-License-Identifier: Apache-2.0
#include "lib/prescription/material_reader.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "lib/prescription/material_search.h"

namespace sagitta::prescription {
namespace {

namespace fs = std::filesystem;

const fs::path bad_materials = fs::path(SAGITTA_SOURCE_DIR) / "tests/prescription/bad-materials";

std::vector<std::string> bad_names() {
  std::vector<std::string> names;
  for (const auto& file : fs::directory_iterator(bad_materials))
    if (file.path().extension() == ".yml") names.push_back(file.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

// All findings as text, each place's file without its folder.
std::string text_of(const Findings& findings) {
  std::string text;
  for (Finding finding : findings.all()) {
    finding.place.file = fs::path(finding.place.file).filename().string();
    text += format(finding) + '\n';
  }
  return text;
}

class Folder {  // of its own for each test, gone with it
 public:
  Folder() {
    std::string name = ::testing::TempDir() + "sagitta-material-XXXXXX";
    path_ = mkdtemp(name.data());
    fs::create_directories(path_ / "materials");
  }
  ~Folder() { fs::remove_all(path_); }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(path_ / name, std::ios::binary) << text;
    return (path_ / name).string();
  }
  Place place() const { return {(path_ / "system.yaml").string(), 3, 7}; }

 private:
  fs::path path_;
};

class BadMaterial : public ::testing::TestWithParam<std::string> {};

TEST_P(BadMaterial, IsRefusedWithTheExpectedText) {
  std::ifstream expected(bad_materials / (GetParam() + ".txt"));
  std::stringstream text;
  text << expected.rdbuf();
  Findings findings;
  EXPECT_FALSE(read_material((bad_materials / (GetParam() + ".yml")).string(), findings).has_value());
  EXPECT_TRUE(findings.has_errors());
  EXPECT_EQ(text_of(findings), text.str());
}

INSTANTIATE_TEST_SUITE_P(Files, BadMaterial, ::testing::ValuesIn(bad_names()), [](const auto& test) {
  std::string name = test.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

TEST(BadMaterials, AreThirtyOne) { EXPECT_EQ(bad_names().size(), 31u); }

TEST(MaterialReader, ReadsCoefficientsThatWrapAndTheOlderKeyOfTheRange) {
  const Folder folder;
  Findings findings;
  const auto medium = read_material(folder.write("g.yml",
                                                 "DATA:\n  - type: formula 5 \n    range: 0.5 2\n    coefficients: 1.5\n      0.25\n"
                                                 "      1\nSPECS:\n  - type: formula A\n"),
                                    findings);
  ASSERT_TRUE(medium.has_value()) << text_of(findings);
  EXPECT_TRUE(findings.all().empty());
  EXPECT_EQ(medium->name, "g");
  EXPECT_EQ(medium->shortest_um, 0.5);
  EXPECT_EQ(medium->longest_um, 2);
  EXPECT_EQ(medium->index(1), 1.75);
}

TEST(MaterialReader, TakesNFromTheFormulaAndLeavesTheTableOfK) {
  const std::string formula = "  - type: formula 5\n    wavelength_range: 0.4 0.8\n    coefficients: 1.5\n";
  const std::string absorption = "  - type: tabulated k\n    data: |\n        0.5 7\n  - type: tabulated n2\n    data: |\n        0.5 8\n";
  const Folder folder;
  for (const std::string& data : {formula + absorption, absorption + formula}) {
    Findings findings;
    const auto medium = read_material(folder.write("g.yml", "DATA:\n" + data), findings);
    ASSERT_TRUE(medium.has_value());
    EXPECT_TRUE(findings.all().empty());
    EXPECT_EQ(medium->index(0.5), 1.5);
  }
}

TEST(MaterialReader, TakesTheFirstOfTwoSourcesOfNWithAWarning) {
  const Folder folder;
  Findings findings;
  const auto medium = read_material(folder.write("g.yml",
                                                 "DATA:\n  - type: formula 5\n    wavelength_range: 0.4 0.8\n    coefficients: 1.5\n"
                                                 "  - type: tabulated nk\n    data: |\n        0.5 1.7 0\n"),
                                    findings);
  ASSERT_TRUE(medium.has_value());
  EXPECT_EQ(medium->index(0.5), 1.5);
  EXPECT_EQ(text_of(findings),
            "g.yml:5:11: warning: n is given once more here, which is not used\n"
            "  hint: the entry on line 2 counts; put the other into a file of its own\n");
}

TEST(MaterialReader, SortsRowsWithANoteAndMergesEqualOnes) {
  const Folder folder;
  Findings findings;
  const auto medium = read_material(
      folder.write("g.yml", "DATA:\r\n  - type: tabulated nk\r\n    data: |\r\n        0.7 1.25 0\r\n        0.5\t1.5 1e-3\r\n\r\n        0.7 1.25 0\r\n"), findings);
  ASSERT_TRUE(medium.has_value()) << text_of(findings);
  EXPECT_EQ(text_of(findings), "g.yml:5:1: note: the rows are not in order of wavelength; they were sorted\n");
  EXPECT_EQ(medium->shortest_um, 0.5);
  EXPECT_EQ(medium->longest_um, 0.7);
  EXPECT_EQ(medium->index(0.5), 1.5);
  EXPECT_EQ(medium->index(0.7), 1.25);
}

TEST(MaterialReader, SaysThatThereIsNoSuchFile) {
  Findings findings;
  EXPECT_FALSE(read_material("/nowhere/glass.yml", findings).has_value());
  EXPECT_EQ(findings.error_count(), 1);
}

TEST(FindMaterial, KnowsAirWithoutAFile) {
  Findings findings;
  const auto medium = find_material("air", {}, findings);
  ASSERT_TRUE(medium.has_value());
  EXPECT_EQ(medium->index(0.5), 1);
}

TEST(FindMaterial, PrefersTheFileBesideThePrescriptionThenItsMaterialsThenTheShippedOnes) {
  const Folder folder;
  Findings findings;
  const auto index = [&] { return find_material("N-BK7", folder.place(), findings)->index(0.5875618); };
  const auto glass = [](const std::string& n) { return "DATA:\n  - type: formula 5\n    wavelength_range: 0.4 0.8\n    coefficients: " + n + "\n"; };
  EXPECT_NEAR(index(), 1.5168, 1e-6);
  folder.write("materials/N-BK7.yml", glass("1.25"));
  EXPECT_EQ(index(), 1.25);
  folder.write("N-BK7.yml", glass("1.75"));
  EXPECT_EQ(index(), 1.75);
  EXPECT_TRUE(findings.all().empty());
}

TEST(FindMaterial, SuggestsTheNearestNameAndAcceptsNoOther) {
  const Folder folder;
  folder.write("materials/my-gel.yml", "");
  const auto said = [&](const std::string& name) {
    Findings findings;
    EXPECT_FALSE(find_material(name, folder.place(), findings).has_value());
    return text_of(findings);
  };
  EXPECT_EQ(said("n-bk7"), "system.yaml:3:7: error: unknown medium 'n-bk7'\n  hint: did you mean 'N-BK7'?\n");
  EXPECT_EQ(said("N-BK77"), "system.yaml:3:7: error: unknown medium 'N-BK77'\n  hint: did you mean 'N-BK7'?\n");
  EXPECT_EQ(said("my-jel"), "system.yaml:3:7: error: unknown medium 'my-jel'\n  hint: did you mean 'my-gel'?\n");
  EXPECT_EQ(said("Air"), "system.yaml:3:7: error: unknown medium 'Air'\n  hint: did you mean 'air'?\n");
  EXPECT_EQ(said("unobtainium"), "system.yaml:3:7: error: unknown medium 'unobtainium'\n"
                                 "  hint: a medium is air, the name of a file materials/NAME.yml, {index: ...} or {nd: ..., vd: ...}\n");
  for (const std::string name : {"", "../materials/N-BK7", "materials/N-BK7", "..", "a\\b", "/etc/passwd"})
    EXPECT_EQ(said(name), "system.yaml:3:7: error: '" + name + "' is not the name of a medium\n"
                          "  hint: a medium is air, the name of a file materials/NAME.yml, {index: ...} or {nd: ..., vd: ...}\n");
  EXPECT_NE(said(std::string("N-BK7\0x", 7)).find("is not the name of a medium"), std::string::npos);
  EXPECT_NE(said(std::string(5000, 'x')).find("unknown medium"), std::string::npos);
}

TEST(FindMaterial, SaysWhereABrokenFileIsNamed) {
  const Folder folder;
  folder.write("gel.yml", "DATA:\n  - type: formula 5\n    wavelength_range: 0.4 0.8\n    coefficients: 1.5 2\n");
  Findings findings;
  EXPECT_FALSE(find_material("gel", folder.place(), findings).has_value());
  EXPECT_EQ(text_of(findings),
            "gel.yml:4:19: error: formula 5 (Cauchy) takes 1, 3, 5, ... coefficients, not 2\n"
            "  hint: C1 comes first, then every term in full\n"
            "system.yaml:3:7: note: named here\n");
}

}  // namespace
}  // namespace sagitta::prescription
