// SPDX-License-Identifier: Apache-2.0
// The shipped systems against their published figures, and what is no figure of theirs: a lens and an obscuration (references.md, sections 2.3 and 2.4;
// tolerances are half a unit of the last printed digit, or as stated there).
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"

namespace sagitta::test {
namespace {

using nlohmann::json;

std::string shipped(const std::string& name) { return SAGITTA_SOURCE_DIR "/systems/" + name; }

json summary(const std::string& system, const std::string& options = "--rays 100") {
  const Folder folder;
  const Outcome run = run_program("trace " + system + " -o " + folder.path("out") + " --json " + options);
  EXPECT_EQ(run.status, 0) << run.err;
  return json::parse(run.out);
}

// systems/published-figures.txt, every line of it, by the script that users have for it.
Outcome check_systems(const std::string& figures = {}) { return run_program("'" SAGITTA_PROGRAM "' " + figures, {}, SAGITTA_SOURCE_DIR "/tools/check-systems"); }
bool has_python() { return std::system("python3 -c 'import json' 2>/dev/null") == 0; }
constexpr const char* no_python = "python3 is not installed: tools/check-systems needs it";

TEST(PublishedSystems, have_their_published_figures) {
  if (!has_python()) GTEST_SKIP() << no_python;
  const Outcome run = check_systems();
  EXPECT_EQ(run.status, 0) << run.out << run.err;
  EXPECT_GE(std::count(run.out.begin(), run.out.end(), '\n'), 150);
}

TEST(PublishedSystems, a_figure_that_is_missed_is_told) {
  if (!has_python()) GTEST_SKIP() << no_python;
  const Folder folder;
  const Outcome run = check_systems(folder.file("figures", "[hyperbolic-singlet] parameters: {index: 1.6}\nA | effective_focal_length_mm | 50 | 1e-12\nB | back_focal_length_mm | 50.1 | 0.01\n"));
  EXPECT_EQ(run.status, 1) << run.err;
  EXPECT_NE(run.out.find("\nhyperbolic-singlet with parameters: {index: 1.6}\ngood "), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("\nMISSED   50.1 "), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("back_focal_length_mm\n2 figures, 1 missed"), std::string::npos) << run.out;
  for (const char* faulty : {"", "[no-such-system]\nA | power_D | 1 | 1\n", "[hyperbolic-singlet]\nA | no such quantity | 1 | 1\n", "A | power_D | 1 | 1\n", "[hyperbolic-singlet]\nA | power_D | 1\n"})
    EXPECT_EQ(check_systems(folder.file("faulty", faulty)).status, 2) << faulty;
}

// ZOSPy's simple lens in OpticStudio (2.3).
constexpr const char* simple_lens = R"(sagitta: 1
wavelengths_nm: [543]
aperture: {stop_diameter_mm: 2}
surfaces:
  - {name: stop, stop: true, thickness_mm: 0}
  - {name: front, conic: {radius_mm: 20}, thickness_mm: 1, medium: {index: 1.5}}
  - {name: back, conic: {radius_mm: -20}, thickness_mm: 19.792}
  - {name: image}
)";

TEST(PublishedSystems, simple_lens_agrees_with_opticstudio) {
  const Folder folder;
  const std::string system = folder.file("simple.yaml", simple_lens);
  const json s = summary(system);
  const json& o = s["first_order"];
  EXPECT_NEAR(o["effective_focal_length_mm"].get<double>(), 20.168067, 1e-6);  // S1
  EXPECT_NEAR(o["back_focal_length_mm"].get<double>(), 19.831933, 1e-6);
  EXPECT_NEAR(o["principal_points_z_mm"][0].get<double>(), 0.336134, 1e-6);
  EXPECT_NEAR(o["principal_points_z_mm"][1].get<double>() - 1, -0.336134, 1e-6);
  EXPECT_NEAR(o["exit_pupil"]["z_mm"].get<double>() - 20.792, -20.46997, 1e-5);  // S2
  EXPECT_NEAR(2 * o["exit_pupil"]["semi_diameter_mm"].get<double>(), 2.033898, 1e-5);
  EXPECT_NEAR(o["effective_focal_length_mm"].get<double>() / 2, 10.08403, 1e-5);

  const auto rows = parse_rays(run_program("rays " + system + " --pupil 1,1 0,1").out);
  ASSERT_EQ(rows.size(), 8u);
  EXPECT_NEAR(rows[3].x, -0.0061213962872, 1e-12);  // S3
  EXPECT_NEAR(rows[3].y, -0.0061213962872, 1e-12);
  EXPECT_NEAR(1 / (2 * std::abs(rows[7].m)), 10.05939, 1e-5);  // S2, working F/#
  // S5: geometric path inside the lens, and the angle of incidence at the back (normal of a sphere around (0,0,-19))
  const RayRow &front = rows[1], &back = rows[2];
  EXPECT_NEAR(std::hypot(back.x - front.x, back.y - front.y, back.z - front.z), 0.9016235916, 1e-9);
  const double cosine = (back.x * front.l + back.y * front.m + (back.z + 19) * front.n) / 20;
  EXPECT_NEAR(std::acos(cosine) * 180 / std::acos(-1.0), 5.346530705, 1e-8);

  const json& wavefront = s["results"][0]["wavefront"];  // S4
  EXPECT_NEAR(wavefront["peak_to_valley_waves"].get<double>(), 0.02350529, 1e-8);
  EXPECT_NEAR(wavefront["rms_waves"].get<double>(), 0.00676187, 1e-8);
}

TEST(PublishedSystems, double_gauss_has_code_vs_exit_pupil) {  // D2, from the last vertex
  const json s = summary(shipped("double-gauss.yaml"));
  const double last_vertex = 8.75 + 0.5 + 12.5 + 3.8 + 16.36944492653564 + 13.74795696388906 + 3.8 + 11 + 0.5 + 7;
  EXPECT_NEAR(s["first_order"]["exit_pupil"]["z_mm"].get<double>() - last_vertex, -53.1569, 5e-5);
}

TEST(PublishedSystems, ritchey_chretien_counts_the_rays_its_obscuration_takes) {
  const json s = summary(shipped("ritchey-chretien.yaml"), "--rays 10000");
  const json& rays = s["results"][0]["rays"];
  // (300/990.7)^2 of the beam: 9.17 %; rings are 1/58 apart, so half a ring is 2 * 0.303 * 0.5/58 = 0.0052 of the area
  EXPECT_NEAR(rays["clipped"].get<double>() / rays["launched"].get<double>(), 0.0917, 0.0053);
  for (const json& result : s["results"]) {
    EXPECT_TRUE(result["wavefront"].is_object());  // the chief ray is clipped by the obscuration only, and still serves
    EXPECT_LT(result["spot"]["rms_radius_mm"].get<double>(), 0.05);
  }
}

}  // namespace
}  // namespace sagitta::test
