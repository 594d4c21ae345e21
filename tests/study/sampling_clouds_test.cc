// SPDX-License-Identifier: Apache-2.0
// Point clouds, triangulated in every interpolation.
#include <set>

#include "lib/study/settled.h"
#include "tests/study/subjects.h"

namespace sagitta::test {
namespace {

using study::CloudChange;

// Both surfaces of a lens as points of a plane, on which every interpolation is exact, in the middle of a cone of light: no interpolation
// changes anything but by rounding. The clouds differ in their given interpolation.
TEST(SamplingOfClouds, TriesEveryInterpolationOfEachAndLeavesTheOthers) {
  std::string points;
  for (int i = -12; i <= 12; ++i)
    for (int j = -12; j <= 12; ++j) points += std::to_string(i) + " " + std::to_string(j) + " " + std::to_string(.25 * i) + "\n";
  const Folder folder;
  folder.file("tilted.xyz", points);
  const auto read = prescription::read_prescription(folder.file("system.yaml",
      "sagitta: 1\nwavelengths_nm: [550, 600]\naperture: {entrance_pupil_diameter_mm: 10}\nsurfaces:\n"
      "  - {name: lens, stop: true, conic: {radius_mm: 40}, thickness_mm: 5, medium: {index: 1.5}}\n"
      "  - {name: wedge, delaunay: {points: tilted.xyz, interpolation: linear}, thickness_mm: 5, medium: {index: 1.6}}\n"
      "  - {delaunay: {points: tilted.xyz, interpolation: thin_plate}, thickness_mm: 70}\n  - {name: image}\n"));
  ASSERT_TRUE(read.model);
  study::SamplingRequest request;
  request.most_rays = 1000;
  request.most_grid = 24;
  const study::Sampling sampling = study::sample_system(*read.model, request, [](double) {});
  const std::vector<CloudChange> changes = study::changes_of(sampling);
  ASSERT_EQ(changes.size(), 10u);
  std::set<std::string> given;
  for (std::size_t i = 0; i < 10; ++i) {
    const study::CloudRun& run = *changes[i].run;
    EXPECT_EQ(run.surface_number, i < 5 ? 2 : 3);
    EXPECT_EQ(run.surface, i < 5 ? "wedge" : "");
    EXPECT_EQ(changes[i].finest, &sampling.clouds[i < 5 ? 0 : 5]);
    EXPECT_EQ(changes[i].finest->interpolation, "c1");
    EXPECT_EQ(run.reason, "");
    if (run.is_given) given.insert(run.surface + ": " + run.interpolation);
    EXPECT_GT(run.ns_per_ray(), 0);
    EXPECT_GT(run.prepare_s, 0);
    // Heights have 6 decimals, exact here; radial functions solve systems of condition 1e6 at most, in double: 1e-9 of 3 mm.
    EXPECT_LT(changes[i].change[0].percent, 1e-4) << run.interpolation;
    EXPECT_TRUE(std::isnan(changes[i].change[2].percent));
  }
  EXPECT_EQ(given, (std::set<std::string>{"wedge: linear", ": thin_plate"}));
}

// Flat facets of a sphere, 1 mm apart: linear differs from the smooth ones by far more than they do from each other.
TEST(SamplingOfClouds, TellsFlatFacetsFromSmoothSurfaces) {
  std::string points;
  for (int i = -8; i <= 8; ++i)
    for (int j = -8; j <= 8; ++j) points += std::to_string(i) + " " + std::to_string(j) + " " + std::to_string(40 - std::sqrt(1600.0 - i * i - j * j)) + "\n";
  const Folder folder;
  folder.file("sphere.xyz", points);
  const auto read = prescription::read_prescription(folder.file("system.yaml",
      "sagitta: 1\nwavelengths_nm: [550]\naperture: {entrance_pupil_diameter_mm: 10}\nsurfaces:\n"
      "  - {name: lens, stop: true, delaunay: {points: sphere.xyz}, thickness_mm: 100, medium: {index: 1.5}}\n  - {name: image}\n"));
  ASSERT_TRUE(read.model);
  study::SamplingRequest request;
  request.most_rays = 10000;
  request.most_grid = 48;
  const std::vector<CloudChange> changes = [&] {
    static study::Sampling sampling;
    sampling = study::sample_system(*read.model, request, [](double) {});
    return study::changes_of(sampling);
  }();
  ASSERT_EQ(changes.size(), 5u);
  EXPECT_TRUE(changes[0].run->is_given) << "c1 is the default";
  EXPECT_EQ(changes[0].change[0].percent, 0);
  ASSERT_EQ(changes[1].run->interpolation, "linear");
  for (std::size_t i = 2; i < 5; ++i) {
    EXPECT_GT(changes[1].change[0].percent, 3 * changes[i].change[0].percent) << changes[i].run->interpolation;
    EXPECT_GT(changes[i].change[0].percent, 0) << changes[i].run->interpolation;
  }
}

}  // namespace
}  // namespace sagitta::test
