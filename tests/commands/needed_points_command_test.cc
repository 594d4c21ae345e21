// SPDX-License-Identifier: Apache-2.0
// What the commands make of a cloud of which they triangulate a part, against the library with all points.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "lib/analysis/job.h"
#include "tests/support/exr_file.h"
#include "tests/support/point_sets.h"
#include "tests/support/prescriptions.h"

namespace sagitta::test {
namespace {

using namespace sagitta::tests;
using ::testing::HasSubstr;
using ::testing::Not;

std::string points(int count, double half, double radius) {
  std::string text;
  for (const auto& p : cloud_of(uniform_random(count, half, 77), sphere(radius)).points) text += fmt::format("{:.17g},{:.17g},{:.17g}\n", p.x, p.y, p.z);
  return text;
}

// The program's summary and pictures hold the library's numbers of all points.
void expect_numbers_of_all_points(const std::string& system, const Folder& folder, const std::string& summary) {
  const auto read = prescription::read_prescription(system);
  ASSERT_TRUE(read.model);
  const CompiledScene whole = checked(scene::compile(*read.model));
  const auto results = analysis::run_job(whole.scene, {});
  const auto spots = read_exr(folder.path("out/spot.exr")), wavefronts = read_exr(folder.path("out/wavefront.exr"));
  ASSERT_EQ(spots.size(), 1 + results.size());
  for (std::size_t i = 0; i < results.size(); ++i) {
    const auto& result = results[i];
    EXPECT_THAT(summary, HasSubstr(fmt::format("\"rms_radius_mm\": {}", result.spot->rms_radius)));
    EXPECT_THAT(summary, HasSubstr(fmt::format("\"ok\": {}", result.rays[surface::Status::ok])));
    const auto& counts = result.spot_image->counts;
    EXPECT_EQ(spots[i + 1].floats.at("Y"), std::vector<float>(counts.begin(), counts.end()));
    ASSERT_TRUE(result.wavefront->wavefront);
    const auto& opd = result.wavefront->wavefront->opd_waves;
    const auto& pixels = wavefronts.at(i + 1).floats.at("Y");
    ASSERT_EQ(pixels.size(), opd.size());
    for (std::size_t k = 0; k < opd.size(); ++k)
      ASSERT_TRUE(pixels[k] == static_cast<float>(opd[k]) || (std::isnan(pixels[k]) && std::isnan(opd[k])));
  }
}

const std::string lens =
    "sagitta: 1\nwavelengths_nm: [550]\naperture: {entrance_pupil_diameter_mm: 1}\nfields: {angles_deg: [[0, 0], [0, 5]]}\nsurfaces:\n"
    "  - {name: front, stop: true, delaunay: {points: points.xyz}, thickness_mm: 30, medium: {index: 1.5}}\n  - {name: image}\n";

TEST(NeededPoints, TraceGivesTheNumbersOfAllPointsAndTellsHowManyItTriangulated) {
  const Folder folder;
  folder.file("points.xyz", points(20000, 6, 12));
  const std::string system = folder.file("system.yaml", lens);
  const Outcome run = run_program("trace " + system + " -o " + folder.path("out"));
  EXPECT_EQ(run.status, 0) << run.err;
  const std::string summary = read_text(folder.path("out/summary.json"));
  EXPECT_THAT(summary, HasSubstr("\"triangulated\": [\n  {\n   \"surface\": 1,\n   \"points\": 20000,\n   \"used\": "));
  expect_numbers_of_all_points(system, folder, summary);
}

TEST(NeededPoints, TraceStartsAgainWithAllPointsWhereARayLeavesThePart) {
  // Beyond 1 mm rays miss the front, and just within they are bent so much that no sample tells where they go.
  const Folder folder;
  folder.file("points.xyz", points(20000, 25, 400));
  const std::string system = folder.file(
      "system.yaml",
      "sagitta: 1\nwavelengths_nm: [550]\naperture: {entrance_pupil_diameter_mm: 2.9}\nsurfaces:\n"
      "  - {name: front, stop: true, conic: {radius_mm: 1}, thickness_mm: 20, medium: {index: 1.5}}\n"
      "  - {name: screen, delaunay: {points: points.xyz, interpolation: linear}, thickness_mm: 1, medium: {index: 1.6}}\n  - {name: image}\n");
  const auto read = prescription::read_prescription(system);
  ASSERT_TRUE(read.model);
  ASSERT_EQ(scene::compile(*read.model, analysis::beam_of_job()).parts.size(), 1u);  // as the sample has it
  const Outcome run = run_program("trace " + system + " -o " + folder.path("out"));
  EXPECT_EQ(run.status, 0) << run.err;
  const std::string summary = read_text(folder.path("out/summary.json"));
  EXPECT_THAT(summary, Not(HasSubstr("triangulated")));
  expect_numbers_of_all_points(system, folder, summary);
}

TEST(NeededPoints, RaysPrintsTheSameRowsWithAndWithoutARayThatWantsAllPoints) {
  const Folder folder;
  folder.file("points.xyz", points(20000, 6, 12));
  const std::string system = folder.file("system.yaml", lens);
  std::string given = "x_mm,y_mm,z_mm,l,m,n\n";
  Uniform u(3);
  for (int i = 0; i < 200; ++i) given += fmt::format("{:.17g},{:.17g},-1,0,0.6,0.8\n", u(-0.5, 0.5), u(-0.5, 0.5));
  const Outcome few = run_program("rays " + system + " --from " + folder.file("few.csv", given));
  const Outcome all = run_program("rays " + system + " --from " + folder.file("all.csv", given + "100,0,-1,0,0,1\n"));
  EXPECT_EQ(few.status, 0) << few.err;
  EXPECT_EQ(parse_rays(few.out).size(), 400u);
  EXPECT_TRUE(all.out.starts_with(few.out));
  EXPECT_THAT(all.out.substr(few.out.size()), HasSubstr("outside_data"));
}

TEST(NeededPoints, CompareTellsOfEachSystemHowManyItTriangulated) {
  const Folder folder;
  folder.file("points.xyz", points(20000, 6, 12));
  const std::string first = folder.file("first.yaml", "name: first\n" + lens);
  std::string other = "name: other\n" + lens;
  other.replace(other.find("points.xyz}"), 11, "points.xyz, interpolation: linear}");
  // its own pupil is wider than its data; the rays are those of the first
  other.replace(other.find("diameter_mm: 1}"), 15, "diameter_mm: 40}");
  const Outcome run = run_program("compare " + first + " " + folder.file("other.yaml", other) + " -o " + folder.path("out"));
  EXPECT_EQ(run.status, 0) << run.err;
  const std::string summary = read_text(folder.path("out/summary.json"));
  std::size_t told = 0;
  for (std::size_t at = 0; (at = summary.find("\"triangulated\"", at)) != std::string::npos; ++at) ++told;
  EXPECT_EQ(told, 2u);
}

}  // namespace
}  // namespace sagitta::test
