// SPDX-License-Identifier: Apache-2.0
// The study newton as it is shipped, and a small one like scaling, through the program.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"

namespace sagitta::test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

double number(const json& row, const char* key) { return row[key].is_null() ? std::nan("") : row[key].get<double>(); }

// Seconds of "..., about 12 s" or "..., about 3 min".
double promised_s(const std::string& text) {
  const std::size_t at = text.find("about ");
  if (at == std::string::npos) return std::nan("");
  return std::atof(text.c_str() + at + 6) * (text.find(" min", at) == std::string::npos ? 1 : 60);
}

struct Studied {
  std::vector<json> rows;
  double promised_s = 0, taken_s = 0;
  std::string page;
};
Studied run_study(const std::string& study, const Folder& folder) {
  const auto start = std::chrono::steady_clock::now();
  const Outcome run = run_program("study '" + study + "' -o '" + folder.path("out") + "'");
  Studied result;
  result.taken_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  EXPECT_EQ(run.status, 0) << run.err;
  result.promised_s = promised_s(run.err);
  result.rows = json::parse(read_text(folder.path("out/study.json")))["rows"].get<std::vector<json>>();
  result.page = read_text(folder.path("out/study.md"));
  fmt::print("[ report   ] {}: {:.0f} s promised, {:.1f} s taken\n", study, result.promised_s, result.taken_s);
  return result;
}

TEST(NewtonStudy, TellsWhatAToleranceLeavesAndCosts) {
  const Folder folder;
  const Studied study = run_study("newton", folder);
  ASSERT_EQ(study.rows.size(), 78u);
  int to_tolerance = 0;
  for (const json& row : study.rows) {
    const double tolerance = number(row, "tolerance"), distance_um = number(row, "distance_max_um"), looks = number(row, "looks_per_ray"), most = number(row, "looks_most");
    const std::string name = row["variant"];
    if (tolerance == 0) {
      // Rounding of the tracer: places of 5 mm to some units in the last place, 1e-15 mm each, magnified at 40 degrees.
      EXPECT_LT(distance_um, 1e3 * 16 * 8.9e-16) << name;
      EXPECT_TRUE(std::isnan(looks)) << name;
      continue;
    }
    ++to_tolerance;
    // |f| <= tolerance, and f falls along the ray by N - L dS/dx - M dS/dy: of light at 40 degrees that meets slopes of at most .45 (2.5 mm of R 7.72 under its
    // own beam is .34), .766 - .643 * .45 = .47 at least, by 30 degrees and less in the other surfaces more.
    EXPECT_LT(distance_um, 1e3 * (tolerance / .47 + 16 * 8.9e-16)) << name;
    if (tolerance >= 1e-14) {
      EXPECT_EQ(number(row, "only_one_finds"), 0) << name;
    }
    EXPECT_GE(looks, 1) << name;
    EXPECT_GE(most, looks) << name;
    // Looks along z: the start and one step. Elsewhere every step leaves the square: from .1 mm to 1e-12 in four steps, where f''/(2 f'^2) is below 1 per mm.
    if (name.find("cornea 0°") == 0) {
      EXPECT_LE(most, 2) << name;
    }
    if (tolerance >= 1e-12) {
      EXPECT_LE(most, 5) << name;
    }
  }
  EXPECT_EQ(to_tolerance, 72);
  // Several seconds, twelve times as long in a sanitizer's or a loaded machine's run; a slip of a unit would be a thousand.
  EXPECT_GT(study.promised_s, study.taken_s / 20);
  EXPECT_LT(study.promised_s, study.taken_s * 20);
}

TEST(ScalingStudy, MemoryGrowsWithThePointsAndNotWithTheRays) {
#if defined(__SANITIZE_ADDRESS__)
  GTEST_SKIP() << "AddressSanitizer keeps freed memory";
#endif
  const Folder folder;
  const std::string file = folder.file("study.yaml",
      "sagitta_study: 1\nname: small\nsystem: " SAGITTA_SOURCE_DIR "/systems/studies/lens-system.yaml\nsurface: front\nvariants:\n"
      "  - {interpolation: [linear, c1], arrangement: random, cloud_radius_mm: 14.1047, points_per_mm2: [160, 640], pattern: random:3, rays: 100000, compared_rays: 1000}\n"
      "  - {interpolation: analytic, pattern: random:3, rays: [100000, 20000000], compared_rays: 1000, threads: [1, 2]}\n");
  const Studied study = run_study(file, folder);
  ASSERT_EQ(study.rows.size(), 8u);
  for (int shape = 0; shape < 2; ++shape) {
    const json &few = study.rows[static_cast<std::size_t>(2 * shape)], &many = study.rows[static_cast<std::size_t>(2 * shape + 1)];
    EXPECT_NEAR(number(many, "points"), 4e5, 1e3);
    // A point is 24 bytes, its two facets 64 each; preparation holds them and CGAL's triangulation at once.
    const double bytes = (number(many, "own_mib") - number(few, "own_mib")) * 0x1p20 / (number(many, "points") - number(few, "points"));
    fmt::print("[ report   ] {}: {:.0f} bytes a point\n", many["variant"].get<std::string>(), bytes);
    EXPECT_GT(bytes, 24 + 2 * 64);
    EXPECT_LT(bytes, 1000);
  }
  // One column of 2e7 doubles would be 153 MiB. On several threads 64 batches of 4096 rays of seven columns are launched at once, 15 MiB.
  EXPECT_LT(number(study.rows[6], "own_mib"), number(study.rows[4], "own_mib") + 4);
  EXPECT_LT(number(study.rows[7], "own_mib"), number(study.rows[4], "own_mib") + 30);
  EXPECT_EQ(study.rows[7]["variant"], "analytic 2e7 rays 2 threads");
  EXPECT_EQ(number(study.rows[7], "rays"), 2e7);
  EXPECT_EQ(number(study.rows[7], "threads"), 2);
  for (const char* plot : {"memory-points", "memory-rays", "time-density", "time-rays", "clock-rays"}) EXPECT_THAT(study.page, HasSubstr(std::string(plot) + ".svg"));
  EXPECT_GT(study.promised_s, study.taken_s / 20);
  EXPECT_LT(study.promised_s, study.taken_s * 20);
}

}  // namespace
}  // namespace sagitta::test
