// SPDX-License-Identifier: Apache-2.0
// A prescription on top of another: what is replaced, what stays, and where files are looked for. Errors are in bad/.
#include "lib/prescription/extends.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/prescription/support.h"

namespace sagitta::prescription {
namespace {

const std::string lens = R"(sagitta: 1
name: Lens
wavelengths_nm: [550, 600]
aperture: {entrance_pupil_diameter_mm: 4}
surfaces:
  - {name: front, stop: true, conic: {radius_mm: 50}, thickness_mm: 4, medium: {index: 1.5}, semi_diameter_mm: 3}
  - {name: back, conic: {radius_mm: -50}, thickness_mm: 40}
  - {name: image}
)";

Model model_of(const std::string& file) {
  const ReadResult result = read_prescription(file);
  EXPECT_EQ(test::text_of(result.findings), "");
  EXPECT_TRUE(result.model.has_value());
  return result.model.value_or(Model{});
}

TEST(Extends, AFileThatChangesNothingIsItsBase) {
  const test::TemporaryFolder folder;
  const Model base = model_of(folder.write("lens.yaml", lens)), same = model_of(folder.write("same.yaml", "extends: lens.yaml\n"));
  EXPECT_EQ(same.name, base.name);
  EXPECT_EQ(same.wavelengths_nm, base.wavelengths_nm);
  EXPECT_EQ(same.aperture.value, base.aperture.value);
  ASSERT_EQ(same.surfaces.size(), base.surfaces.size());
  for (std::size_t i = 0; i < base.surfaces.size(); ++i) {
    EXPECT_EQ(same.surfaces[i].name, base.surfaces[i].name);
    EXPECT_EQ(same.surfaces[i].shape.kind, base.surfaces[i].shape.kind);
    EXPECT_EQ(same.surfaces[i].shape.parameters.numbers, base.surfaces[i].shape.parameters.numbers);
    EXPECT_EQ(same.surfaces[i].thickness_mm, base.surfaces[i].thickness_mm);
    EXPECT_EQ(same.surfaces[i].semi_diameter_mm, base.surfaces[i].semi_diameter_mm);
    EXPECT_EQ(same.surfaces[i].stop, base.surfaces[i].stop);
  }
}

TEST(Extends, KeysReplaceTheBasesAndAShapeReplacesAnyShape) {
  const test::TemporaryFolder folder;
  folder.write("lens.yaml", lens);
  const std::string file = folder.write("changed.yaml", "sagitta: 1\nextends: lens.yaml\nname: Changed\nwavelengths_nm: [480]\nsurfaces:\n"
                                                        "  - {name: back, plane: {}, thickness_mm: 30}\n  - {name: front, stop: false}\n  - {name: image, stop: true}\n");
  const Model model = model_of(file);
  EXPECT_EQ(model.file, file);
  EXPECT_EQ(model.name, "Changed");
  EXPECT_EQ(model.wavelengths_nm, std::vector<double>{480});
  EXPECT_EQ(model.aperture.value, 4);
  ASSERT_EQ(model.surfaces.size(), 3u);
  EXPECT_EQ(model.surfaces[0].name, "front");
  EXPECT_EQ(model.surfaces[0].shape.parameters.number("radius_mm"), 50);
  EXPECT_FALSE(model.surfaces[0].stop);
  EXPECT_EQ(model.surfaces[0].semi_diameter_mm, 3);
  EXPECT_EQ(model.surfaces[1].shape.kind, "plane");
  EXPECT_EQ(model.surfaces[1].thickness_mm, 30);
  EXPECT_TRUE(model.surfaces[2].stop);
}

TEST(Extends, FilesAreLookedForBesideTheFileThatNamesThem) {
  const test::TemporaryFolder folder;
  std::filesystem::create_directories(folder.path() + "/a");
  std::filesystem::create_directories(folder.path() + "/b");
  const auto medium = [&](const std::string& name, double index) {
    folder.write(name, fmt::format("DATA:\n  - type: tabulated n\n    data: |\n        0.4 {0}\n        0.7 {0}\n", index));
  };
  medium("a/glass.yml", 1.5);
  medium("b/glass.yml", 1.7);
  folder.write("a/points.xyz", "0 0 0\n1 0 0\n0 1 0\n1 1 0\n");
  folder.write("a/lens.yaml", "sagitta: 1\nwavelengths_nm: [550]\naperture: {entrance_pupil_diameter_mm: 1}\nsurfaces:\n"
                              "  - {name: one, stop: true, delaunay: {points: points.xyz}, thickness_mm: 1, medium: glass}\n"
                              "  - {name: two, thickness_mm: 1, medium: glass}\n  - {}\n");
  const Model model = model_of(folder.write("b/other.yaml", "extends: ../a/lens.yaml\nsurfaces: [{name: two, medium: glass}]\n"));
  ASSERT_EQ(model.surfaces.size(), 3u);
  ASSERT_TRUE(model.surfaces[0].shape.cloud);
  EXPECT_EQ(model.surfaces[0].shape.cloud->points.size(), 4u);
  EXPECT_EQ(model.surfaces[0].medium->index(0.55), 1.5);
  EXPECT_EQ(model.surfaces[1].medium->index(0.55), 1.7);
  ASSERT_EQ(model.documents.size(), 2u);
  EXPECT_EQ(model.documents[1].named_at.line, 1);
  EXPECT_EQ(model.documents[1].named_at.column, 10);
}

TEST(Extends, AChainHasAtMost16Files) {
  const test::TemporaryFolder folder;
  folder.write("1.yaml", lens);
  std::string file;
  for (int i = 2; i <= 16; ++i)
    file = folder.write(fmt::format("{}.yaml", i), fmt::format("extends: {}.yaml\nsurfaces: [{{name: back, thickness_mm: {}}}]\n", i - 1, i));
  EXPECT_EQ(model_of(file).surfaces[1].thickness_mm, 16);  // the last word is the extending file's
  const ReadResult result = read_prescription(folder.write("17.yaml", "extends: 16.yaml\n"));
  EXPECT_FALSE(result.model);
  ASSERT_EQ(result.findings.all().size(), 16u);  // the error, and how one gets there
  EXPECT_EQ(result.findings.all()[0].what, "a chain of more than 16 files that extend each other");
  EXPECT_EQ(result.findings.all()[0].place.file, folder.path() + "/2.yaml");
  EXPECT_EQ(result.findings.all()[15].place.file, folder.path() + "/17.yaml");
}

}  // namespace
}  // namespace sagitta::prescription
