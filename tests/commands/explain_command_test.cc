// SPDX-License-Identifier: Apache-2.0
// `sagitta explain` as it is shipped, and `plan` in the summary of `trace`.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "tests/support/compared.h"

namespace sagitta::test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

const std::string lens = "sagitta: 1\nname: A lens\nwavelengths_nm: [550, 633]\naperture: {entrance_pupil_diameter_mm: 8}\nfields: {angles_deg: [[0, 0], [1, 3]]}\nsurfaces:\n"
                         "  - {name: front, stop: true, conic: {radius_mm: 50}, thickness_mm: 4, medium: N-BK7, semi_diameter_mm: 5}\n"
                         "  - {name: back, conic: {radius_mm: -50, conic_constant: -1}, thickness_mm: 48}\n  - {name: image}\n";

TEST(ExplainCommand, prints_a_table_of_the_surfaces_and_what_is_left_out) {
  const Folder folder;
  const Outcome run = run_program("explain " + folder.file("lens.yaml", lens));
  EXPECT_EQ(run.status, 0);
  EXPECT_EQ(run.err, "");
  for (const char* text : {"A lens\n", "kernel", "sphere", "conic", "plane", "left out", "why", "saves", "optical path lengths of the spots' rays",
                           "dispersion of the media in 1 gap", "only 2 wavelengths are traced", "kernel 'conic' for surface 1", "aperture tests of surfaces 2-3"})
    EXPECT_THAT(run.out, HasSubstr(text));
  EXPECT_THAT(run.out, Not(HasSubstr("…")));  // no cell is cut
  EXPECT_THAT(run.out, Not(HasSubstr("asked for")));
}

TEST(ExplainCommand, says_the_same_as_the_summary_of_trace) {
  const Folder folder;
  const std::string system = folder.file("lens.yaml", lens);
  for (const std::string only : {"", " --only spot", " --only wavefront", " --only spot,wavefront"}) {
    const json summary = traced(system, "--rays 300" + only);
    const Outcome run = run_program("explain " + system + " --rays 300 --json" + only);
    EXPECT_EQ(run.status, 0) << run.err;
    const json explained = json::parse(run.out);
    EXPECT_EQ(explained["plan"], summary["plan"]) << only;
    EXPECT_EQ(explained["system"], "A lens");
    ASSERT_EQ(explained["plan"]["surfaces"].size(), 3u);
    EXPECT_EQ(explained["plan"]["surfaces"][0]["kernel"], "sphere");
    EXPECT_EQ(explained["plan"]["surfaces"][1]["name"], "back");
    EXPECT_EQ(explained["plan"]["surfaces"][1]["operations_per_ray"]["divisions"], 2);
    EXPECT_EQ(explained["plan"]["operations_include_opl"], only != " --only spot");
  }
  EXPECT_THAT(run_program("explain " + system + " --rays 300 --only wavefront").out, HasSubstr("331 rays for 4 fields and wavelengths"));
}

// A cloud far wider than the beam, of which a part is triangulated; and a beam that needs all of it.
TEST(ExplainCommand, counts_the_points_that_the_beam_does_not_need) {
  const Folder folder;
  std::string points;
  for (int i = -70; i <= 70; ++i)
    for (int j = -70; j <= 70; ++j) {
      const double x = 0.08 * i + 0.011 * (j % 4), y = 0.08 * j + 0.009 * (i % 3);
      points += fmt::format("{:.17g} {:.17g} {:.17g}\n", x, y, (x * x + y * y) / 40);
    }
  folder.file("points.xyz", points);
  const auto system = [&](const std::string& diameter) {
    return folder.file("cloud.yaml", "sagitta: 1\nwavelengths_nm: [550]\naperture: {entrance_pupil_diameter_mm: " + diameter + "}\nsurfaces:\n"
                                     "  - {name: front, stop: true, delaunay: {points: points.xyz}, thickness_mm: 30, medium: {index: 1.5}}\n  - {name: image}\n");
  };
  const json summary = traced(system("1"), "--rays 300");
  const int used = summary["triangulated"][0]["used"].get<int>();
  EXPECT_LT(used, 5000);
  const std::string what = fmt::format("{} of the 19881 points of surface 1", 19881 - used);
  const std::string here = run_program("explain " + system("1") + " --json --rays 300").out;
  EXPECT_EQ(json::parse(here)["plan"], summary["plan"]);
  EXPECT_THAT(here, HasSubstr(what));
  const json whole = json::parse(run_program("explain " + system("10") + " --json --rays 300").out);
  EXPECT_THAT(whole.dump(), Not(HasSubstr("points of surface 1")));
  // facets and their patches, some two a point, of 64 and 128 bytes and more
  EXPECT_GT(whole["plan"]["surfaces"][0]["data_bytes"].get<int>() - summary["plan"]["surfaces"][0]["data_bytes"].get<int>(), (19881 - used) * 2 * 192);
}

TEST(ExplainCommand, the_plan_has_the_same_bytes_for_any_thread_count_and_instruction_set) {
  const Folder folder;
  const std::string system = folder.file("lens.yaml", lens);
  const std::string plan = traced(system, "--threads 1")["plan"].dump();
  EXPECT_EQ(traced(system, "--threads 3")["plan"].dump(), plan);
  const std::string here = run_program("explain " + system).out;
  EXPECT_NE(here, "");
  EXPECT_EQ(run_program("explain " + system, "SAGITTA_ISA=x86-64 ").out, here);
}

TEST(ExplainCommand, a_comparison_has_no_plan) {
  const Folder folder;
  const std::string system = folder.file("lens.yaml", lens), other = folder.file("other.yaml", lens);
  const json summary = compared(system + " " + other + " --rays 100");
  ASSERT_EQ(summary["systems"].size(), 2u);
  for (const json& one : summary["systems"]) EXPECT_FALSE(one.contains("plan"));
}

TEST(ExplainCommand, explains_every_shipped_system) {
  int count = 0;
  const bool has_cgal = run_program("--version").out.find("by CGAL") != std::string::npos;
  for (const auto& entry : std::filesystem::directory_iterator(systems)) {
    if (entry.path().extension() != ".yaml") continue;
    const Outcome run = run_program("explain " + entry.path().string() + " --json");
    if (!has_cgal && run.err.find("without CGAL") != std::string::npos) continue;
    ++count;
    EXPECT_EQ(run.status, 0) << entry.path() << run.err;
    const json explained = json::parse(run.out);
    for (const json& surface : explained["plan"]["surfaces"]) EXPECT_TRUE(surface["operations_per_ray"].is_object()) << entry.path() << surface;
  }
  EXPECT_GE(count, 6);
}

TEST(ExplainCommand, exit_status_tells_wrong_usage_from_wrong_input) {
  const Folder folder;
  const std::string system = folder.file("lens.yaml", lens);
  for (const std::string& arguments : std::vector<std::string>{"explain", "explain " + system + " --only spots", "explain " + system + " --rays 0", "explain " + system + " -o x"}) {
    const Outcome run = run_program(arguments);
    EXPECT_EQ(run.status, 2) << arguments;
    EXPECT_EQ(run.out, "");
    EXPECT_NE(run.err, "");
  }
  EXPECT_EQ(run_program("explain --help").status, 0);
  EXPECT_THAT(run_program("--help").out, HasSubstr("explain"));
  EXPECT_EQ(run_program("explain " + folder.path("none.yaml")).status, 1);
  EXPECT_EQ(run_program("explain " + folder.file("bad.yaml", "sagitta: 1\n")).status, 1);
}

}  // namespace
}  // namespace sagitta::test
