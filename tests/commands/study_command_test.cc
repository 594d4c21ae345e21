// SPDX-License-Identifier: Apache-2.0
// Studies as the program runs them; their points are triangulated.
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/wait.h>

#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/support/program.h"

namespace sagitta::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

const std::string lens =
    "sagitta: 1\nname: Lens\nwavelengths_nm: [855]\naperture: {entrance_pupil_diameter_mm: 4}\nsurfaces:\n"
    "  - {name: front, stop: true, conic: {radius_mm: 20}, thickness_mm: 60, medium: {index: 1.5}}\n  - {name: image}\n";
const std::string head = "sagitta_study: 1\nname: tiny\ntitle: A tiny study\nabout: What it is of.\nsystem: lens.yaml\nsurface: front\n";

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

// Runs a study of these variants in the folder, output in its "out".
Outcome run_study(const Folder& folder, const std::string& variants, const std::string& before = {}) {
  folder.file("lens.yaml", lens);
  return run_program("study '" + folder.file("study.yaml", head + variants) + "' -o '" + folder.path("out") + "' --threads 1", before);
}

const std::string few = "variants:\n  - {points_per_mm2: [4, 16, 64], rays: 300}\n  - {interpolation: analytic, rays: 300}\n";

TEST(StudyCommand, writes_a_row_for_every_variant_a_page_and_plots) {
  const Folder folder;
  const Outcome run = run_study(folder, few + "paper:\n  - {where: {points_per_mm2: 16}, angle_mean_arcmin: 1, note: made up}\nnotes: |-\n  Not *yet*.\n  - The end.\n");
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(run.err, testing::MatchesRegex("sagitta study: 4 variants to measure, about [0-9]+ (s|min)\n"));
  EXPECT_THAT(run.out, HasSubstr("A tiny study: 4 of 4 variants measured, 0 of them before"));

  const auto lines = lines_of(read_text(folder.path("out/study.csv")));
  ASSERT_EQ(lines.size(), 5u);
  EXPECT_THAT(lines[0], testing::StartsWith("study,variant,interpolation,arrangement,points_per_mm2,points,triangles,rays,threads,tolerance,distance_mean_um,distance_rms_um,angle_mean_arcmin,"
                                            "angle_rms_arcmin,spot_rms_um,spot_rms_error_percent,wavefront_rms_error_waves,only_one_finds,prepare_s,ns_per_ray,peak_mib,"));
  EXPECT_THAT(lines[1], testing::StartsWith("tiny,linear regular 4 per mm²,linear,regular,4,"));
  EXPECT_THAT(lines[4], testing::StartsWith("tiny,analytic,analytic,,,0,0,"));

  const json found = json::parse(read_text(folder.path("out/study.json")));
  EXPECT_EQ(found["title"], "A tiny study");
  ASSERT_EQ(found["rows"].size(), 4u);
  for (const json& row : found["rows"]) {
    EXPECT_GE(row["rays"].get<int>(), 300);
    EXPECT_EQ(row["only_one_finds"], 0);
    EXPECT_GT(row["ns_per_ray"].get<double>(), 0);
    EXPECT_GT(row["peak_mib"].get<double>(), 1);
    EXPECT_EQ(row["failed"], "");
  }
  // Spacings of 1/2, 1/4, 1/8 mm: errors fall by 4 and by 2 (tests/study/variant_test.cc derives them), here to a tenth of 300 rays.
  for (int i = 0; i < 2; ++i) {
    const auto ratio = [&](const char* key) { return found["rows"][i][key].get<double>() / found["rows"][i + 1][key].get<double>(); };
    EXPECT_NEAR(ratio("distance_mean_um"), 4, .8);
    EXPECT_NEAR(ratio("angle_mean_arcmin"), 2, .4);
  }
  EXPECT_LT(found["rows"][3]["distance_rms_um"].get<double>(), 1e-10);

  const std::string page = read_text(folder.path("out/study.md"));
  for (const char* text : {"# A tiny study\n", "What it is of.", "4 of 4 variants", "| linear regular 16 per mm² |", "## Orders", "| linear regular | distance |", "| made up |", "\n\nNot \\*yet\\*.\n\n- The end.\n"})
    EXPECT_THAT(page, HasSubstr(text));
  int plots = 0;
  for (std::size_t at = 0; (at = page.find("](", at)) != std::string::npos; ++plots) {
    at += 2;
    const std::string file = page.substr(at, page.find(')', at) - at);
    EXPECT_THAT(read_text(folder.path("out/" + file)), HasSubstr("<svg")) << file;
    EXPECT_TRUE(fs::exists(fs::path(folder.path("out/" + file)).replace_extension(".png"))) << file;
  }
  EXPECT_GE(plots, 6);
}

TEST(StudyCommand, keeps_finished_rows_and_measures_what_is_new) {
  const Folder folder;
  ASSERT_EQ(run_study(folder, few).status, 0);
  const auto first = lines_of(read_text(folder.path("out/study.csv")));
  const Outcome same = run_study(folder, few);
  EXPECT_THAT(same.err, HasSubstr("4 of 4 rows are kept"));
  EXPECT_EQ(lines_of(read_text(folder.path("out/study.csv"))), first);  // to the last digit of the times: nothing was measured

  const Outcome more = run_study(folder, "variants:\n  - {points_per_mm2: [4, 8, 64], rays: 300}\n");
  EXPECT_THAT(more.err, HasSubstr("2 of 3 rows are kept"));
  const auto second = lines_of(read_text(folder.path("out/study.csv")));
  EXPECT_THAT(second, ElementsAre(first[0], first[1], testing::StartsWith("tiny,linear regular 8 per mm²"), first[3]));

  const std::string other = folder.file("lens.yaml", lens + "source: another text of the system\n");
  const Outcome changed = run_program("study '" + folder.path("study.yaml") + "' -o '" + folder.path("out") + "'");
  EXPECT_EQ(changed.status, 0);
  EXPECT_THAT(changed.err, Not(HasSubstr("kept")));
}

// Found by review, 2026-11-22: tables of another kind were replaced without a word, rows of `threads: 0` kept for any number of threads, and variants
// that differ in compared_rays alone shown as seeds.
TEST(StudyCommand, keeps_its_hands_off_tables_of_other_kinds) {
  const Folder folder;
  ASSERT_EQ(run_study(folder, few).status, 0);
  const std::string before = read_text(folder.path("out/study.csv"));
  const Outcome system = run_program("study --system '" + folder.path("lens.yaml") + "' -o '" + folder.path("out") + "'");
  EXPECT_EQ(system.status, 1);
  EXPECT_THAT(system.err, HasSubstr("would be lost\n  hint: give another folder"));
  EXPECT_EQ(read_text(folder.path("out/study.csv")), before);
  std::ofstream(folder.path("out/study.csv")) << "a,b\n1,2\n";
  EXPECT_EQ(run_study(folder, few).status, 1);
  EXPECT_EQ(read_text(folder.path("out/study.csv")), "a,b\n1,2\n");
}

TEST(StudyCommand, takes_tables_with_the_line_ends_of_other_editors) {
  const Folder folder;
  ASSERT_EQ(run_study(folder, few).status, 0);
  std::string csv;
  for (const std::string& line : lines_of(read_text(folder.path("out/study.csv")))) csv += line + "\r\n";
  std::ofstream(folder.path("out/study.csv"), std::ios::binary) << csv;
  EXPECT_THAT(run_study(folder, few).err, HasSubstr("4 of 4 rows are kept"));
}

TEST(StudyCommand, all_threads_are_another_variant_where_they_are_others) {
  const Folder folder;
  const std::string study = "variants:\n  - {points_per_mm2: 4, rays: 300, threads: [0, 1]}\n";
  ASSERT_EQ(run_study(folder, study).status, 0);  // --threads 1
  const Outcome two = run_program("study '" + folder.path("study.yaml") + "' -o '" + folder.path("out") + "' --threads 2");
  EXPECT_THAT(two.err, HasSubstr("1 of 2 rows are kept"));
  EXPECT_THAT(two.err, HasSubstr("1 rows of an earlier run are left out"));
}

TEST(StudyCommand, shows_every_setting_but_the_seed_as_a_line_of_its_own) {
  const Folder folder;
  ASSERT_EQ(run_study(folder, "variants:\n  - {points_per_mm2: 4, rays: 300, compared_rays: [10, 300]}\n").status, 0);
  const std::string page = read_text(folder.path("out/study.md"));
  EXPECT_THAT(page, HasSubstr("| linear regular 10 compared |"));
  EXPECT_THAT(page, HasSubstr("| linear regular |"));
  EXPECT_THAT(page, Not(HasSubstr("±  |")));
}

// The cells of the row of a Markdown table that begins so, from its second column on.
std::vector<std::string> cells_of(const std::string& page, const std::string& first) {
  for (const std::string& line : lines_of(page)) {
    if (!line.starts_with("| " + first + " |")) continue;
    std::vector<std::string> cells;
    for (std::size_t at = line.find(" | ") + 3, end; (end = line.find(" |", at)) != std::string::npos; at = end + 3) cells.push_back(line.substr(at, end - at));
    return cells;
  }
  return {};
}

// Of each density three clouds: three rows of study.csv, one line of the page, with the mean and the standard deviation of its numbers, and one point of a fit.
TEST(StudyCommand, shows_variants_that_differ_in_the_seed_alone_as_their_mean) {
  const Folder folder;
  const Outcome run = run_study(folder,
                                "variants:\n  - {points_per_mm2: [4, 16, 64], rays: 300, arrangement: random, seed: [1, 2, 3]}\n  - {points_per_mm2: 16, rays: 300, seed: 2}\n"
                                "  - {points_per_mm2: 5e6, rays: 300, arrangement: jittered, seed: [1, 2]}\n"
                                "paper:\n  - {where: {points_per_mm2: 16, arrangement: random}, spot_rms_error_percent: 1}\n",
                                "ulimit -v 1000000; ");
#if defined(__SANITIZE_ADDRESS__)
  GTEST_SKIP() << "AddressSanitizer takes more address space than the limit";
#endif
  EXPECT_EQ(run.status, 1);
  const json rows = json::parse(read_text(folder.path("out/study.json")))["rows"];
  ASSERT_EQ(rows.size(), 12u);
  const std::string page = read_text(folder.path("out/study.md"));
  EXPECT_THAT(page, HasSubstr("| variant | seeds | points | rays | distance, mean µm |"));
  struct Expected {
    double mean = 0, deviation = 0;
  };
  const auto expected_of = [&](std::size_t first, const char* key) {
    Expected result;
    for (std::size_t i = 0; i < 3; ++i) result.mean += rows[first + i][key].get<double>() / 3;
    for (std::size_t i = 0; i < 3; ++i) result.deviation += std::pow(rows[first + i][key].get<double>() - result.mean, 2) / 2;
    result.deviation = std::sqrt(result.deviation);
    return result;
  };
  std::vector<double> spacings, angles;
  std::size_t first = 0;
  for (const char* density : {"4", "16", "64"}) {
    const auto cells = cells_of(page, std::string("linear random ") + density + " per mm²");
    ASSERT_GE(cells.size(), 5u) << density;
    EXPECT_EQ(cells[0], "3");
    EXPECT_EQ(cells[1], std::to_string(rows[first]["points"].get<int>()));
    EXPECT_EQ(cells[2], std::to_string(rows[first]["rays"].get<int>()));
    const Expected distance = expected_of(first, "distance_mean_um");
    const std::size_t sign = cells[3].find(" ± ");
    ASSERT_NE(sign, std::string::npos) << cells[3];
    EXPECT_NEAR(std::stod(cells[3].substr(sign + 4)), distance.deviation, .051 * distance.deviation);  // two digits; the sign is two bytes
    EXPECT_NEAR(std::stod(cells[3]), distance.mean, distance.deviation / 2);                             // to the first of them
    spacings.push_back(std::log(rows[first]["points_per_mm2"].get<double>()) / -2);
    angles.push_back(std::log(expected_of(first, "angle_rms_arcmin").mean));
    first += 3;
  }
  EXPECT_EQ(page.find("seed 1 |"), std::string::npos);
  EXPECT_EQ(cells_of(page, "linear regular 16 per mm² seed 2").at(0), "1");  // alone: under its own name, without a deviation
  EXPECT_EQ(cells_of(page, "linear regular 16 per mm² seed 2").at(3).find("±"), std::string::npos);
  EXPECT_THAT(page, HasSubstr("- linear jittered 5000000 per mm² seed 1: not enough memory"));
  EXPECT_THAT(page, HasSubstr("- linear jittered 5000000 per mm² seed 2: not enough memory"));
  // Equal steps of the spacing: the slope of least squares is that from the first mean to the last.
  EXPECT_NEAR(std::stod(cells_of(page, "linear random").at(1)), (angles[2] - angles[0]) / (spacings[2] - spacings[0]), 5.1e-4);
  EXPECT_EQ(cells_of(page, "linear random").at(3), "3");
  const Expected spot = expected_of(3, "spot_rms_error_percent");
  const auto reference = cells_of(page, "random, points_per_mm2 16");
  ASSERT_GE(reference.size(), 5u);
  EXPECT_NEAR(std::stod(reference[2]), spot.mean, spot.deviation / 2);
  EXPECT_NEAR(std::stod(reference[3]), 100 * (spot.mean - 1), .051);
  EXPECT_EQ(reference[4], "3");
}

// SIGKILL while it measures: what had been finished is kept, whole.
TEST(StudyCommand, killed_in_the_middle_goes_on_where_it_was) {
  const Folder folder;
  folder.file("lens.yaml", lens);
  const std::string study = folder.file("study.yaml", head + "variants:\n  - {points_per_mm2: 400, rays: 20000, seed: [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12], arrangement: random}\n");
  const std::string out = folder.path("out"), log = folder.path("log");
  const pid_t child = fork();
  if (child == 0) {
    if (!std::freopen(log.c_str(), "w", stderr) || !std::freopen(log.c_str(), "w", stdout)) _exit(126);
    execl(SAGITTA_PROGRAM, SAGITTA_PROGRAM, "study", study.c_str(), "-o", out.c_str(), nullptr);
    _exit(127);
  }
  std::size_t rows = 0;
  for (int i = 0; i < 30000 && rows < 3; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    rows = lines_of(read_text(out + "/study.csv")).size();
  }
  kill(child, SIGKILL);
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status)) << "it was over before it was killed";
  const auto before = lines_of(read_text(out + "/study.csv"));
  ASSERT_GE(before.size(), 3u);
  ASSERT_LT(before.size(), 13u);
  const Outcome again = run_program("study '" + study + "' -o '" + out + "'");
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_THAT(again.err, HasSubstr(std::to_string(before.size() - 1) + " of 12 rows are kept"));
  const auto after = lines_of(read_text(out + "/study.csv"));
  ASSERT_EQ(after.size(), 13u);
  for (std::size_t i = 0; i < before.size(); ++i) EXPECT_EQ(after[i], before[i]);
}

// A file-size limit of 4 blocks of 512 bytes stands for a full disk: two rows have room, four have not.
TEST(StudyCommand, a_full_disk_loses_no_finished_row) {
  const Folder folder;
  const std::string two = "variants:\n  - {points_per_mm2: [4, 16], rays: 300}\n";
  ASSERT_EQ(run_study(folder, two).status, 0);
  const std::string before = read_text(folder.path("out/study.csv"));
  ASSERT_LT(before.size(), 2048u);
  const Outcome full = run_study(folder, few, "ulimit -f 4; ");
  EXPECT_EQ(full.status, 1);
  EXPECT_THAT(full.err, HasSubstr("study.csv"));
  EXPECT_EQ(lines_of(read_text(folder.path("out/study.csv")))[1], lines_of(before)[1]);
  const Outcome again = run_study(folder, few);
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_THAT(again.err, testing::ContainsRegex("[23] of 4 rows are kept"));
}

// What no process has memory for is one failed row, measured anew by the next run.
TEST(StudyCommand, a_variant_that_fails_takes_no_other_with_it) {
#if defined(__SANITIZE_ADDRESS__)
  GTEST_SKIP() << "AddressSanitizer takes more address space than the limit";
#endif
  const Folder folder;
  const Outcome run = run_study(folder, "variants:\n  - {points_per_mm2: [4, 5e6, 16], rays: 300}\n", "ulimit -v 1000000; ");
  EXPECT_EQ(run.status, 1);
  EXPECT_THAT(run.err, HasSubstr("linear regular 5000000 per mm²: not enough memory"));
  EXPECT_THAT(run.out, HasSubstr("2 of 3 variants measured"));
  const json found = json::parse(read_text(folder.path("out/study.json")));
  ASSERT_EQ(found["rows"].size(), 3u);
  EXPECT_EQ(found["rows"][1]["failed"], "not enough memory");
  EXPECT_TRUE(found["rows"][1]["distance_rms_um"].is_null());
  EXPECT_GT(found["rows"][2]["distance_rms_um"].get<double>(), 0);
  EXPECT_THAT(read_text(folder.path("out/study.md")), HasSubstr("- linear regular 5000000 per mm²: not enough memory"));
}

TEST(StudyCommand, variants_may_be_of_other_surfaces_and_fields) {
  const Folder folder;
  folder.file("two.yaml", "sagitta: 1\nname: Two\nwavelengths_nm: [855]\naperture: {entrance_pupil_diameter_mm: 4}\nfields: {angles_deg: [[0, 0], [0, 20]]}\nsurfaces:\n"
                          "  - {name: front, stop: true, conic: {radius_mm: 20, conic_constant: -3}, thickness_mm: 2, medium: {index: 1.5}}\n"
                          "  - {name: back, conic: {radius_mm: -15, conic_constant: -9}, thickness_mm: 20}\n  - {name: image}\n");
  const std::string study = folder.file("study.yaml", "sagitta_study: 1\nname: two\nsystem: two.yaml\nsurface: front\nvariants:\n"
                                                      "  - {interpolation: analytic, field: [0, 1], tolerance_mm: [0, 1e-3, 1e-13], rays: 300}\n"
                                                      "  - {interpolation: analytic, surface: back, field: 1, tolerance_mm: [0, 1e-3, 1e-13], rays: 300}\n");
  const Outcome run = run_program("study '" + study + "' -o '" + folder.path("out") + "' --threads 1");
  ASSERT_EQ(run.status, 0) << run.err;
  const json found = json::parse(read_text(folder.path("out/study.json")));
  ASSERT_EQ(found["rows"].size(), 9u);
  EXPECT_EQ(found["rows"][0]["variant"], "front 0°, as traced");
  EXPECT_EQ(found["rows"][8]["variant"], "back 20°, Newton to 1e-13 mm");
  EXPECT_EQ(found["rows"][8]["surface"], "back");
  EXPECT_EQ(found["rows"][8]["field"], 1);
  for (const json& row : found["rows"]) {
    EXPECT_EQ(row["only_one_finds"], 0) << row["variant"];
    const double tolerance = row["tolerance"].get<double>();
    EXPECT_EQ(row["looks_most"].is_null(), tolerance == 0) << row["variant"];
    if (tolerance > 0) {
      EXPECT_GE(row["looks_most"].get<double>(), row["looks_per_ray"].get<double>()) << row["variant"];
    }
    // |f| <= tolerance, and f falls along the ray by its cosine with z less the slope, .6 at least; beside rounding
    EXPECT_LE(row["distance_max_um"].get<double>(), 1e3 * (tolerance / .6 + 1e-14)) << row["variant"];
  }
  // Along z two looks are enough; under 20 degrees the second leaves some 1e-6 mm.
  EXPECT_EQ(found["rows"][2]["looks_most"], 2);
  EXPECT_GT(found["rows"][5]["looks_most"].get<double>(), 2);
  EXPECT_NE(found["rows"][7]["distance_max_um"], found["rows"][4]["distance_max_um"]);  // of other surfaces
  const std::string page = read_text(folder.path("out/study.md"));
  EXPECT_THAT(page, HasSubstr("System: Two, surfaces 1 (front), 2 (back), fields 0, 1, 855 nm."));
  for (const char* plot : {"error-tolerance-distance", "error-tolerance-angle", "looks-tolerance", "looks-most-tolerance"}) EXPECT_THAT(page, HasSubstr(std::string(plot) + ".svg"));
}

// The exact rays of the first row are 1e5 times two places and directions of long doubles, 20 MiB; the second begins when they are gone. Its 100 rays
// and batches of 4096 are a few hundred KiB, and pages of code and stacks some MiB. The third's 2e5 points are 24 bytes each and their 4e5 facets 64.
TEST(StudyCommand, memory_of_a_variant_is_its_own) {
#if defined(__SANITIZE_ADDRESS__)
  GTEST_SKIP() << "AddressSanitizer keeps freed memory";
#endif
  const Folder folder;
  const Outcome run = run_study(folder, "variants:\n  - {interpolation: analytic, pattern: random:1, rays: 100000}\n  - {interpolation: analytic, pattern: random:2, rays: 100}\n"
                                        "  - {points_per_mm2: 16000, pattern: random:2, rays: 100}\n");
  ASSERT_EQ(run.status, 0) << run.err;
  const json rows = json::parse(read_text(folder.path("out/study.json")))["rows"];
  ASSERT_EQ(rows.size(), 3u);
  const auto mib = [&](int row, const char* key) { return rows[static_cast<std::size_t>(row)][key].get<double>(); };
  EXPECT_GT(mib(0, "peak_mib") - mib(0, "own_mib"), mib(1, "peak_mib") - mib(1, "own_mib") + 18);
  EXPECT_LT(mib(1, "own_mib"), 6);
  EXPECT_GT(rows[2]["points"].get<double>(), 2e5);
  EXPECT_GT(mib(2, "own_mib"), 2e5 * (24 + 2 * 64) / 0x1p20);
}

TEST(StudyCommand, says_what_is_wrong_and_writes_nothing) {
  const Folder folder;
  const Outcome wrong = run_study(folder, "variants:\n  - {points_per_mm2: 4, interpolation: c2}\n");
  EXPECT_EQ(wrong.status, 1);
  EXPECT_THAT(wrong.err, HasSubstr("study.yaml:8:40: error: interpolation must be one of"));
  EXPECT_THAT(wrong.err, HasSubstr("hint: did you mean 'c1'?"));
  EXPECT_FALSE(fs::exists(folder.path("out")));
  const Outcome unknown = run_program("study lense -o '" + folder.path("out") + "'");
  EXPECT_EQ(unknown.status, 1);
  EXPECT_THAT(unknown.err, HasSubstr("there is no study 'lense'\n  hint: did you mean 'lens'?"));
  EXPECT_EQ(run_program("study lens").status, 2);
}

}  // namespace
}  // namespace sagitta::test
