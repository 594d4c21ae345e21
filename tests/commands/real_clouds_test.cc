// SPDX-License-Identifier: Apache-2.0
// Clouds as topographers leave them, end to end: what of the beam is inside the data is counted from the points alone.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "tests/support/point_sets.h"
#include "tests/support/program.h"

namespace sagitta::test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

constexpr int ring_count = 24, meridian_count = 120;
constexpr double ring_step = 0.2;  // mm

double sag(double r) { return tests::sphere(7.8)(r, 0); }

struct Sample {
  int ring, meridian;
  double radius() const { return ring_step * ring; }
  double angle_deg() const { return 360.0 / meridian_count * meridian; }
};
enum class Is { there, missing, absent };  // missing: with a hole; absent: no line at all

// A polar file of a sphere.
template <class State>
std::string polar_file(State&& state, int first_ring = 1) {
  std::string text = "ring,meridian_deg,radius_mm,z_mm\n";
  for (int ring = first_ring; ring <= ring_count; ++ring)
    for (int meridian = 0; meridian < meridian_count; ++meridian) {
      const Sample s{ring, meridian};
      const Is is = state(s);
      if (is == Is::there) text += fmt::format("{},{},{},{:.17g}\n", ring, s.angle_deg(), s.radius(), -sag(s.radius()));
      if (is == Is::missing) text += fmt::format("{},{},-1,-1\n", ring, s.angle_deg());
    }
  return text;
}

std::string system_of(const Folder& folder, const std::string& points, double diameter, const std::string& more = {}) {
  return folder.file("s.yaml", fmt::format("sagitta: 1\nwavelengths_nm: [543]\naperture: {{entrance_pupil_diameter_mm: {}}}\nsurfaces:\n"
                                           "  - {{name: cornea, stop: true, delaunay: {{points: \"{}\", format: polar{}}}, thickness_mm: 31, medium: {{index: 1.333}}}}\n  - {{}}\n",
                                           diameter, points, more));
}

struct Traced {
  json result;
  std::string err;
  double coverage() const { return result["coverage"][0]["share"].get<double>(); }
};
Traced traced(const std::string& points, double diameter, const std::string& more = {}) {
  const Folder folder;
  const Outcome run = run_program("trace " + system_of(folder, folder.file("points.polar", points), diameter, more) + " -o " + folder.path("out") + " --json --only spot --rays 40000");
  EXPECT_EQ(run.status, 0) << run.err;
  const json summary = json::parse(run.out);
  const json& rays = summary["results"][0]["rays"];
  int sum = 0;
  for (const char* status : {"ok", "missed", "clipped", "total_reflection", "outside_data", "not_converged"}) sum += rays[status].get<int>();
  EXPECT_EQ(sum, rays["launched"].get<int>());
  EXPECT_EQ(rays["ok"].get<int>() + rays["outside_data"].get<int>(), sum);
  return {summary["results"][0], run.err};
}

// The share of the beam's disc that the quadrangles between neighbouring samples cover that are all there; the disc inside
// the first ring is surface. By area, in steps that are even in r^2 and angle, as a hexapolar pupil's are.
template <class State>
double expected_coverage(State&& state, double semi_diameter) {
  int inside = 0, all = 0;
  const auto is_there = [&](int ring, int meridian) { return ring == 0 || state(Sample{ring, meridian % meridian_count}) == Is::there; };
  for (int i = 0; i < 1000; ++i)
    for (int j = 0; j < 1000; ++j, ++all) {
      const double r = semi_diameter * std::sqrt((i + 0.5) / 1000);
      // the eye's frame has x to the examiner's left, which mirrors the angle and no area of a disc
      const int ring = static_cast<int>(r / ring_step), meridian = static_cast<int>(meridian_count * (j + 0.5) / 1000);
      inside += ring < ring_count && is_there(ring, meridian) && is_there(ring, meridian + 1) && is_there(ring + 1, meridian) && is_there(ring + 1, meridian + 1);
    }
  return static_cast<double>(inside) / all;
}

// Tolerance of a share: where a quadrangle lacks one corner of four its other half may be surface, so the boundary of the
// data, of length B, is uncertain by half a quadrangle: half of 0.2 mm on the rings, half of 0.1 mm along them; the
// share by 0.1 B/(pi R^2). Rays along the boundary, 2 of 3 mm apart in 1e4 a disc, add a fifth of that.
double tolerance(double boundary, double semi_diameter) { return 0.12 * boundary / (std::numbers::pi * semi_diameter * semi_diameter); }

const auto whole = [](const Sample&) { return Is::there; };
// Below the upper lid: rings cut off where y > 2.2 mm.
const auto lid = [](const Sample& s) { return s.radius() * std::sin(s.angle_deg() * std::numbers::pi / 180) > 2.2 ? Is::missing : Is::there; };
const auto sector = [](const Sample& s) { return s.ring > 8 && s.meridian > 10 && s.meridian < 30 ? Is::missing : Is::there; };
const auto spot = [](const Sample& s) { return s.ring >= 5 && s.ring <= 8 && s.meridian >= 60 && s.meridian <= 75 ? Is::missing : Is::there; };

TEST(RealCloud, without_gaps_covers_the_beam_though_it_has_no_apex) {
  const Traced t = traced(polar_file(whole), 6);
  EXPECT_EQ(t.coverage(), 1);
  EXPECT_EQ(t.err, "");
  // Beyond the last ring: (4.8/5)^2, less 5e-4 for its 120 chords. 4e4 rays of a hexapolar pupil are 115 rings, of which
  // the outer ones hold 1/57 each: the rim of the data is known to half a ring.
  EXPECT_NEAR(traced(polar_file(whole), 10).coverage(), 0.9216, 0.5 / 57 + 5e-4);
}

TEST(RealCloud, cut_off_by_a_lid_has_the_coverage_that_its_points_say) {
  const Traced t = traced(polar_file(lid), 6);
  EXPECT_NEAR(t.coverage(), expected_coverage(lid, 3), tolerance(2 * std::sqrt(9 - 2.2 * 2.2), 3));
  EXPECT_LT(t.coverage(), 0.95);
  EXPECT_THAT(t.err, HasSubstr("lines without radius or z (nan, empty, -1 or -1000), the first one here: holes"));
}

TEST(RealCloud, with_a_missing_sector_has_the_coverage_that_its_points_say) {
  const Traced t = traced(polar_file(sector), 7);
  // two radial sides of 1.9 mm, and an arc of 20 steps at 1.6 mm
  EXPECT_NEAR(t.coverage(), expected_coverage(sector, 3.5), tolerance(2 * 1.9 + 1.7, 3.5));
  EXPECT_LT(t.coverage(), 0.9);
}

TEST(RealCloud, with_a_hole_inside_has_the_coverage_that_its_points_say) {
  const Traced t = traced(polar_file(spot), 6);
  EXPECT_NEAR(t.coverage(), expected_coverage(spot, 3), tolerance(2 * 0.8 + 2 * 1.1, 3));
  EXPECT_LT(t.coverage(), 0.98);
}

// Lines that are not there leave no hole: facets bridge the gap, unless max_edge_mm forbids it.
TEST(RealCloud, whose_missing_samples_have_no_lines_is_bridged_unless_edges_are_bounded) {
  const auto absent = [](const Sample& s) { return spot(s) == Is::missing ? Is::absent : Is::there; };
  EXPECT_EQ(traced(polar_file(absent), 6).coverage(), 1);
  // the longest edge of a whole cell within 4.8 mm: a diagonal of 0.2 and 0.25 mm
  EXPECT_NEAR(traced(polar_file(absent), 6, ", max_edge_mm: 0.4").coverage(), expected_coverage(spot, 3), tolerance(2 * 0.8 + 2 * 1.1, 3) + 0.4 * 0.4 / 9);
}

TEST(RealCloud, with_its_apex_on_every_meridian_and_repeated_points_is_one_surface) {
  const Traced without = traced(polar_file(whole), 6), with = traced(polar_file(whole, 0) + fmt::format("3,0,{},{:.17g}\n", ring_step * 3, -sag(ring_step * 3)), 6);
  EXPECT_EQ(with.coverage(), 1);
  EXPECT_THAT(with.err, HasSubstr("120 points repeat another"));
  // One point more, on the sphere: c1 is right to the 4th order, here to nanometres of spot
  EXPECT_NEAR(with.result["spot"]["rms_radius_mm"].get<double>(), without.result["spot"]["rms_radius_mm"].get<double>(), 1e-5);
  const Folder folder;
  const Outcome cliff = run_program("check " + system_of(folder, folder.file("points.polar", polar_file(whole, 0) + "0,7,0,-0.1\n"), 6));
  EXPECT_EQ(cliff.status, 1);
  EXPECT_THAT(cliff.err, HasSubstr("two heights at one place (0, 0)"));
}

TEST(RealCloud, that_is_smoothed_says_so_everywhere) {
  const Folder folder;
  std::string points = "x,y,z\n";
  tests::Uniform u(4);
  for (const auto& p : tests::polar_rings(20, 90, 4, false)) points += fmt::format("{:.9f},{:.9f},{:.9f}\n", p.x, p.y, tests::sphere(7.8)(p.x, p.y) + u(-4e-4, 4e-4));
  const std::string file = folder.file("p.xyz", points);
  const auto system = [&](const char* smoothing_um) {
    return folder.file(fmt::format("s{}.yaml", smoothing_um), fmt::format("sagitta: 1\nwavelengths_nm: [543]\naperture: {{entrance_pupil_diameter_mm: 5}}\nsurfaces:\n"
        "  - {{name: cornea, stop: true, delaunay: {{points: \"{}\", smoothing_um: {}}}, thickness_mm: 31, medium: {{index: 1.333}}}}\n  - {{}}\n", file, smoothing_um));
  };
  const Outcome run = run_program("trace " + system("0.23") + " -o " + folder.path("out") + " --json --only spot");
  ASSERT_EQ(run.status, 0) << run.err;
  const json summary = json::parse(run.out), &smoothing = summary["smoothing"][0];
  EXPECT_EQ(smoothing["surface"], 1);
  EXPECT_EQ(smoothing["name"], "cornea");
  EXPECT_NEAR(smoothing["requested_um"].get<double>(), 0.23, 1e-15);
  EXPECT_NEAR(smoothing["residual_rms_um"].get<double>(), 0.23, 1e-5);
  EXPECT_GT(smoothing["residual_max_um"].get<double>(), 0.39);
  EXPECT_GT(smoothing["lambda_mm2"].get<double>(), 0);
  EXPECT_THAT(run.err, HasSubstr("s0.23.yaml:5:42: note: smoothed: the heights leave the points by 0.23 um rms"));
  EXPECT_THAT(run_program("trace " + system("0.23") + " -o " + folder.path("out") + " --only spot").out,
              HasSubstr("surface 1 cornea is smoothed: its heights leave the points by 0.23 um rms, 0."));
  EXPECT_THAT(run_program("check " + system("0.23")).err, HasSubstr("note: smoothed: the heights leave the points by 0.23 um rms"));
  const Outcome limit = run_program("check " + system("100"));
  EXPECT_EQ(limit.status, 0);
  EXPECT_THAT(limit.err, HasSubstr("the best-fit sphere and plane, as smooth as can be, for smoothing_um is more than they leave"));
  EXPECT_EQ(run_program("check " + system("-1")).status, 1);

  // 0 is none, to the last bit; and the focal length follows the smoothed points: 7.8/0.333 mm, to what noise of
  // 0.23 um leaves of a curvature over 1.25 mm (0.2 %), which it misses unsmoothed too, but not by the same
  const auto focal_length = [&](const char* smoothing_um) {
    const Outcome one = run_program("trace " + system(smoothing_um) + " -o " + folder.path("out") + " --json --only spot");
    return json::parse(one.out)["first_order"]["effective_focal_length_mm"].get<double>();
  };
  EXPECT_NEAR(focal_length("0.23"), 7.8 / 0.333, 0.2);
  EXPECT_NE(focal_length("0.23"), focal_length("0"));
  const std::string none = folder.file("none.yaml", read_text(system("0")).replace(read_text(system("0")).find(", smoothing_um: 0"), 17, ""));
  EXPECT_EQ(run_program("rays " + none + " --fan x:51").out, run_program("rays " + system("0") + " --fan x:51").out);
  EXPECT_FALSE(json::parse(run_program("trace " + none + " -o " + folder.path("out") + " --json --only spot").out).contains("smoothing"));
}

// 2026-11-22: "-nan" stood in the table, where no ray came to the points. All are clipped before.
TEST(RealCloud, no_coverage_is_told_where_no_ray_comes_to_the_points) {
  const Folder folder;
  const std::string points = folder.file("points.polar", polar_file([](const Sample&) { return Is::there; }));
  const std::string system = folder.file("s.yaml", fmt::format(
      "sagitta: 1\nwavelengths_nm: [543]\naperture: {{entrance_pupil_diameter_mm: 2}}\nsurfaces:\n"
      "  - {{stop: true, thickness_mm: 1, semi_diameter_mm: 2e-6, inner_semi_diameter_mm: 1e-6}}\n"
      "  - {{delaunay: {{points: \"{}\", format: polar}}, thickness_mm: 31, medium: {{index: 1.333}}}}\n  - {{}}\n", points));
  const Outcome run = run_program("trace " + system + " -o " + folder.path("out"));
  EXPECT_EQ(run.status, 1);
  EXPECT_THAT(run.out, HasSubstr("coverage"));
  EXPECT_THAT(run.out, ::testing::Not(HasSubstr("nan")));
}

}  // namespace
}  // namespace sagitta::test
