// SPDX-License-Identifier: Apache-2.0
// sagitta study --system, as the program runs it.
#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "tests/support/program.h"

namespace sagitta::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

// Two fields and two wavelengths of a singlet.
const std::string lens =
    "sagitta: 1\nname: A | lens\nwavelengths_nm: [550, 600]\naperture: {entrance_pupil_diameter_mm: 8}\nfields: {angles_deg: [[0, 0], [0, 2]]}\nsurfaces:\n"
    "  - {name: front, stop: true, conic: {radius_mm: 20}, thickness_mm: 58, medium: N-BK7}\n  - {name: image}\n";

TEST(StudySystemCommand, writes_tables_plots_and_advice) {
  const Folder folder;
  const std::string out = folder.path("out");
  const std::string system = folder.file("lens.yaml", lens);
  const Outcome run = run_program("study --system '" + system + "' -o '" + out + "' --threads 1");
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(run.err, "");
  EXPECT_THAT(run.out, testing::ContainsRegex("^A . lens: 2 fields, 2 wavelengths\n1e4 rays give the spot RMS to 0[.0-9]+ % in [0-9.]+ [mµ]+s"));
  EXPECT_THAT(run.out, HasSubstr("\n64 x 64 samples give the wavefront RMS to "));
  EXPECT_THAT(run.out, HasSubstr("\n64 x 64 samples give every Zernike coefficient to "));
  EXPECT_THAT(run.out, HasSubstr("it is not independent"));

  const json found = json::parse(read_text(out + "/study.json"));
  EXPECT_EQ(found["system"], "A | lens");
  // ten counts of rays in three patterns, ten grids for two answers; two fields, two wavelengths
  ASSERT_EQ(found["rows"].size(), (3u * 10 + 2 * 10) * 4);
  int spots = 0, truths = 0;
  for (const json& row : found["rows"]) {
    EXPECT_GT(row["processor_s"].get<double>(), 0);
    EXPECT_GE(row["worst_to_next"].get<double>(), row["error"].get<double>());
    EXPECT_GE(row["claim"].get<double>(), row["worst_to_next"].get<double>());
    EXPECT_EQ(row["reason"], "");
    truths += row["error"] == 0.0;
    if (row["answer"] != "spot RMS") continue;
    ++spots;
    EXPECT_NEAR(row["claim_percent"].get<double>() * row["value"].get<double>() / 100, row["claim"].get<double>(), row["claim"].get<double>()) << "of the truth, which the value is near";
  }
  EXPECT_EQ(spots, 120);
  EXPECT_GE(truths, 3 * 4);
  const std::string csv = read_text(out + "/study.csv");
  EXPECT_THAT(csv, testing::StartsWith("answer,varied,pattern,rays,grid,surface,interpolation,tolerance_mm,steps,field,wavelength_nm,launched,arrived,unit,value,error,error_percent,worst_to_next,claim,claim_percent,"));

  // The answers of `trace` are among the rows, to the last bit.
  ASSERT_EQ(run_program("trace '" + system + "' -o '" + folder.path("trace") + "'").status, 0);
  const json traced = json::parse(read_text(folder.path("trace/summary.json")));
  int compared = 0;
  for (const json& result : traced["results"])
    for (const json& row : found["rows"]) {
      const bool is_spot = row["answer"] == "spot RMS" && row["pattern"] == "hexapolar" && row["rays"] == 10000, is_wavefront = row["answer"] == "wavefront RMS" && row["grid"] == 64;
      if ((!is_spot && !is_wavefront) || result["field"] != row["field"] || result["wavelength_nm"] != row["wavelength_nm"]) continue;
      EXPECT_DOUBLE_EQ(row["value"].get<double>(), is_spot ? 1e3 * result["spot"]["rms_radius_mm"].get<double>() : result["wavefront"]["rms_waves"].get<double>());
      ++compared;
    }
  EXPECT_EQ(compared, 8);

  const std::string page = read_text(out + "/study.md");
  std::istringstream lines(run.out);
  std::string line;
  std::getline(lines, line);
  int advice = 0;
  for (; std::getline(lines, line); ++advice) EXPECT_THAT(page, HasSubstr(line));
  EXPECT_EQ(advice, 5);
  EXPECT_THAT(page, HasSubstr("# A \\| lens: error against run time"));
  std::set<std::string> plots;
  for (std::size_t at = 0; (at = page.find("](", at)) != std::string::npos;) {
    at += 2;
    plots.insert(page.substr(at, page.find(')', at) - at));
  }
  EXPECT_EQ(plots, (std::set<std::string>{"spot-rays.svg", "spot-time.svg", "wavefront-samples.svg", "wavefront-time.svg", "zernike-samples.svg", "zernike-time.svg"}));
  for (const std::string& file : plots) {
    EXPECT_THAT(read_text(out + "/" + file), HasSubstr("<svg")) << file;
    EXPECT_TRUE(fs::exists(fs::path(out + "/" + file).replace_extension(".png"))) << file;
  }
}

TEST(StudySystemCommand, says_why_there_is_no_answer) {
  const Folder folder;
  const std::string lost = "sagitta: 1\nname: Lost\nwavelengths_nm: [550]\naperture: {entrance_pupil_diameter_mm: 8}\nsurfaces:\n"
                           "  - {name: front, stop: true, inner_semi_diameter_mm: 5, thickness_mm: 58}\n  - {name: image}\n";
  const Outcome run = run_program("study --system '" + folder.file("lost.yaml", lost) + "' -o '" + folder.path("out") + "'");
  EXPECT_EQ(run.status, 1);
  EXPECT_THAT(run.err, HasSubstr("not one ray arrived"));
  EXPECT_THAT(run.out, HasSubstr("no spot RMS for 1 of 1 fields and wavelengths: no ray arrived"));
  EXPECT_THAT(read_text(folder.path("out/study.md")), HasSubstr("no ray arrived"));
}

TEST(StudySystemCommand, refuses_what_is_wrong) {
  const Folder folder;
  const std::string out = folder.path("out"), good = folder.file("lens.yaml", lens);
  const Outcome wrong = run_program("study --system '" + folder.file("wrong.yaml", lens + "wavelenghts_nm: [1]\n") + "' -o '" + out + "'");
  EXPECT_EQ(wrong.status, 1);
  EXPECT_THAT(wrong.err, testing::ContainsRegex("wrong.yaml:9:1: error: unknown key 'wavelenghts_nm'"));
  EXPECT_FALSE(fs::exists(out));
  const std::string afocal = "sagitta: 1\nwavelengths_nm: [550]\naperture: {image_f_number: 4}\nsurfaces:\n  - {stop: true, thickness_mm: 5}\n  - {name: image}\n";
  const Outcome later = run_program("study --system '" + folder.file("afocal.yaml", afocal) + "' -o '" + out + "'");
  EXPECT_EQ(later.status, 1);
  EXPECT_THAT(later.err, HasSubstr("afocal.yaml:3:"));
  EXPECT_FALSE(fs::exists(out));
  EXPECT_EQ(run_program("study --system '" + folder.path("none.yaml") + "' -o '" + out + "'").status, 1);
  for (const std::string& arguments : {"study lens --system '" + good + "' -o '" + out + "'", "study --system '" + good + "' --rays 100 -o '" + out + "'", "study --system '" + good + "'",
                                       "study -o '" + out + "'", "study --system '" + good + "' -o '" + out + "' --threads 0"}) {
    const Outcome usage = run_program(arguments);
    EXPECT_EQ(usage.status, 2) << arguments;
    EXPECT_NE(usage.err, "") << arguments;
  }
  EXPECT_FALSE(fs::exists(out));
}

// One message, with the other way.
TEST(StudySystemCommand, knows_a_study_from_a_system) {
  const Folder folder;
  const std::string out = folder.path("out"), system = folder.file("lens.yaml", lens), study = folder.file("study.yaml", "# of two lines\nsagitta_study: 1\nname: lens\n");
  const Outcome as_system = run_program("study --system '" + study + "' -o '" + out + "'");
  EXPECT_EQ(as_system.status, 1);
  EXPECT_EQ(as_system.err, study + ":2:1: error: this is a study, not a system\n  hint: give it as it is: sagitta study " + study + " -o " + out + "\n");
  const Outcome as_study = run_program("study '" + system + "' -o '" + out + "'");
  EXPECT_EQ(as_study.status, 1);
  EXPECT_EQ(as_study.err, system + ":1:1: error: this is a system, not a study\n  hint: give it with --system: sagitta study --system " + system + " -o " + out + "\n");
  EXPECT_FALSE(fs::exists(out));
}

TEST(StudySystemCommand, says_what_cannot_be_written) {
  const Folder folder;
  const std::string file = folder.file("file", "");
  const Outcome run = run_program("study --system '" + folder.file("lens.yaml", lens) + "' -o '" + file + "/out'");
  EXPECT_EQ(run.status, 1);
  EXPECT_THAT(run.err, HasSubstr("file"));
}

}  // namespace
}  // namespace sagitta::test
