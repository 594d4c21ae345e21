// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <set>

#include "tests/support/program.h"

namespace sagitta::test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

constexpr const char* catalog = "CC My glasses\nNM G1 2 0 1.5 60\nGC a comment\nCD 1.25\nLD 0.4 1\nNM G2 99\nCD 1\nLD 0.4 1\nNM N-BK7 5\nCD 1.5\nLD 0.4 1\n";

json read(const std::string& arguments) {
  const Outcome run = run_program("materials --json " + arguments);
  EXPECT_EQ(run.status, 0) << run.err;
  return json::parse(run.out).at("materials");
}

const json& named(const json& materials, const std::string& name) {
  static const json none;
  for (const json& one : materials)
    if (one.at("name") == name) return one;
  ADD_FAILURE() << "no " << name;
  return none;
}

TEST(MaterialsCommand, lists_every_file_that_is_shipped) {
  std::set<std::string> files{"air"}, names;
  for (const auto& file : std::filesystem::directory_iterator(SAGITTA_SOURCE_DIR "/materials")) files.insert(file.path().stem().string());
  const json materials = read("");
  for (const json& one : materials) names.insert(one.at("name").get<std::string>());
  EXPECT_EQ(names, files);
  const json& glass = named(materials, "N-BK7");
  EXPECT_NEAR(glass.at("nd").get<double>(), 1.5168, 1e-6);
  EXPECT_NEAR(glass.at("vd").get<double>(), 64.17, 5e-3);
  EXPECT_EQ(glass.at("range_nm"), json({300.0, 2500.0}));
  EXPECT_EQ(glass.at("kind"), "formula 2 (Sellmeier-2)");
  EXPECT_EQ(glass.at("from"), "materials");
  EXPECT_FALSE(glass.contains("values"));
  const json& table = named(materials, "navarro-lens");  // which ends before the line C
  EXPECT_EQ(table.at("kind"), "table of 4");
  EXPECT_TRUE(table.at("vd").is_null());
  EXPECT_TRUE(named(materials, "air").at("range_nm").is_null());
  const Outcome text = run_program("materials");
  EXPECT_EQ(text.status, 0);
  EXPECT_EQ(text.err, "");
  EXPECT_EQ(static_cast<std::size_t>(std::count(text.out.begin(), text.out.end(), '\n')), files.size() + 3);
  EXPECT_THAT(text.out, HasSubstr("\nN-BK7                        1.51680  64.17    300 to 2500  materials  formula 2 (Sellmeier-2)"));
}

TEST(MaterialsCommand, gives_the_values_at_the_lines_of_the_range) {
  const json glass = read("N-BK7").at(0);
  EXPECT_EQ(glass.at("values").size(), 13U);
  EXPECT_EQ(glass.at("values")[6].at("line"), "d");
  EXPECT_NEAR(glass.at("values")[6].at("index").get<double>(), 1.5168, 1e-6);
  const json table = read("navarro-lens").at(0);
  std::vector<std::string> lines;
  for (const json& value : table.at("values")) {
    lines.push_back(value.at("line"));
    EXPECT_TRUE(value.at("slope_per_um").is_null());
    EXPECT_TRUE(value.at("group_index").is_null());
  }
  EXPECT_EQ(lines, (std::vector<std::string>{"F'", "F", "e", "d", "D"}));
  const Outcome text = run_program("materials N-BK7 air");
  EXPECT_THAT(text.out, StartsWith("N-BK7: Optical glass N-BK7\nsource  Schott's catalogue"));
  EXPECT_THAT(text.out, HasSubstr("kind    formula 2 (Sellmeier-2), 300 to 2500 nm\nnd 1.5168000, Vd 64.17; ne 1.5187"));
  EXPECT_THAT(text.out, HasSubstr("\nair: the reference of the indices of all media\nkind    constant, any nm\nnd 1.0000000, Vd -; ne 1.0000000, Ve -\n"));
}

TEST(MaterialsCommand, evaluates_at_given_wavelengths) {
  const json values = read("N-BK7 --at 632.8,587.5618").at(0).at("values");
  ASSERT_EQ(values.size(), 2U);
  EXPECT_EQ(values[0].at("wavelength_nm"), 632.8);
  EXPECT_TRUE(values[0].at("line").is_null());
  EXPECT_NEAR(values[0].at("index").get<double>(), 1.5150892, 0.5e-7);  // E20
  EXPECT_NEAR(values[1].at("index").get<double>(), 1.5168000, 0.5e-7);
  EXPECT_EQ(read("--at 600,632.8 --at 500 N-BK7").at(0).at("values").size(), 3U);
  EXPECT_THAT(run_program("materials N-BK7 --at 632.8").out, HasSubstr("632.8  1.5150892  "));
}

TEST(MaterialsCommand, outside_the_range_says_what_the_tracer_says) {
  const Outcome run = run_program("materials N-BK7 water --at 200,550,3000");
  EXPECT_EQ(run.status, 1);
  EXPECT_EQ(run.out, "");
  EXPECT_EQ(run.err, "--at: error: N-BK7 is valid from 300 to 2500 nm, not at 200, 3000 nm\n--at: error: water is valid from 182 to 1129 nm, not at 3000 nm\n");
}

TEST(MaterialsCommand, suggests_the_nearest_name) {
  const Outcome run = run_program("materials N-BK8 n-sf6");
  EXPECT_EQ(run.status, 1);
  EXPECT_EQ(run.out, "");
  EXPECT_EQ(run.err, "sagitta materials: error: unknown medium 'N-BK8'\n  hint: did you mean 'N-BK7'?\nsagitta materials: error: unknown medium 'n-sf6'\n  hint: did you mean 'N-SF6'?\n");
}

TEST(MaterialsCommand, takes_catalogues_and_files) {
  const Folder folder;
  const std::string with = "--catalog " + folder.file("my.agf", catalog);
  const json glass = read("G1 " + with).at(0);
  EXPECT_EQ(glass.at("nd"), 1.5);  // n^2 = 1 + 1.25
  EXPECT_EQ(glass.at("from"), "my.agf");
  EXPECT_EQ(glass.at("file"), folder.path("my.agf") + ":2");
  EXPECT_EQ(glass.at("comments"), "a comment");
  EXPECT_EQ(glass.at("references"), "my.agf, AGF formula 2, Sellmeier 1; My glasses");
  EXPECT_EQ(read("N-BK7 " + with).at(0).at("nd"), 1.5);
  EXPECT_EQ(read(with + " --catalog " + folder.file("other.agf", "NM H 5\nCD 1.75\nLD 0.4 1\n") + " H").at(0).at("nd"), 1.75);
  const Outcome list = run_program("materials " + with);
  EXPECT_EQ(list.status, 0);
  EXPECT_THAT(list.out, HasSubstr("\nG1 "));
  EXPECT_THAT(list.out, HasSubstr("\nN-SF6 "));
  EXPECT_THAT(list.out, Not(HasSubstr("\nG2 ")));
  EXPECT_EQ(list.err, folder.path("my.agf") + ":6:7: warning: glass 'G2': unknown dispersion formula '99'\n  hint: formulas are numbered 1 to 13\n");
  const Outcome faulty = run_program("materials G2 " + with);
  EXPECT_EQ(faulty.status, 1);
  EXPECT_THAT(faulty.err, HasSubstr(":6:7: error: glass 'G2': unknown dispersion formula '99'"));
  EXPECT_EQ(run_program("materials --catalog " + folder.path("none.agf")).status, 1);
  EXPECT_EQ(read(folder.file("gel.yml", "DATA:\n  - {type: formula 5, wavelength_range: 0.4 0.8, coefficients: 1.375}\n")).at(0).at("nd"), 1.375);
  EXPECT_EQ(run_program("materials " + folder.path("none.yml")).status, 1);
}

TEST(MaterialsCommand, plots_one_and_several) {
  const Folder folder;
  const std::string picture = folder.path("new/lens.svg");
  EXPECT_EQ(run_program("materials navarro-lens navarro-herzberger-lens air -o " + picture).status, 0);
  const std::string svg = read_text(picture);
  EXPECT_THAT(svg, HasSubstr("<title>Refractive indices of 3 media</title>"));
  EXPECT_EQ(run_program("materials air -o " + folder.path("air.png")).status, 0);
  EXPECT_THAT(read_text(folder.path("air.png")), StartsWith("\x89PNG"));
  EXPECT_EQ(run_program("materials N-BK8 -o " + folder.path("none.png")).status, 1);
  EXPECT_FALSE(std::filesystem::exists(folder.path("none.png")));
  EXPECT_EQ(run_program("materials air -o /dev/null/air.png").status, 1);
}

TEST(MaterialsCommand, refuses_wrong_usage) {
  EXPECT_EQ(run_program("materials --at 550").status, 2);
  EXPECT_EQ(run_program("materials -o a.png").status, 2);
  EXPECT_EQ(run_program("materials air -o a.pdf").status, 2);
  EXPECT_EQ(run_program("materials air --at nan").status, 2);
  EXPECT_EQ(run_program("materials air --at 0").status, 2);
  EXPECT_EQ(run_program("materials air --at five").status, 2);
}

}  // namespace
}  // namespace sagitta::test
