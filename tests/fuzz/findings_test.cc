// SPDX-License-Identifier: Apache-2.0
// What fuzzing found, each with its input, what was wrong, and when.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <string>

#include "lib/medium/medium.h"
#include "tests/fuzz/targets.h"

namespace sagitta::fuzz {
namespace {

std::string lens(const std::string& medium, const std::string& wavelength_nm = "550") {
  return "sagitta: 1\nwavelengths_nm: [" + wavelength_nm + "]\naperture: {object_na: 0.2}\nobject: {distance_mm: 10}\n"
         "fields: {object_heights_mm: [[0, 0], [0, 1]]}\nsurfaces:\n"
         "  - {conic: {radius_mm: 5}, thickness_mm: 2, medium: " + medium + "}\n  - {conic: {radius_mm: -5}, thickness_mm: 5}\n"
         "  - {stop: true, thickness_mm: 3}\n  - {}\n";
}

// 2026-11-22, compile: behind a medium of index 1e99 a ray's direction was (0, 0, 0), with the status ok: what is left of it beside the normal
// is below the last digit. At the largest ratio of legal indices, 1e6, a direction's length is still 1 within 1e6 ulp.
TEST(Finding, AnIndexThatLeavesNoDigitsIsRefused) {
  const Folder folder;
  for (const std::string medium : {"{index: 1e99}", "{index: 1e-99}", "{nd: 1e99, vd: 50}", "{nd: 1.5, vd: 1e-99}"}) {
    EXPECT_TRUE(prescription::test::read_text(lens(medium)).findings.has_errors()) << medium;
    EXPECT_EQ(fuzz_compile(folder, lens(medium)), "") << medium;
  }
  for (const std::string index : {"0.001", "1000"}) {
    const std::string text = lens("{index: " + index + "}");
    EXPECT_TRUE(prescription::test::read_text(text).model) << index;
    EXPECT_EQ(fuzz_compile(folder, text), "") << index;
  }
  prescription::Findings findings;
  EXPECT_FALSE(prescription::read_material(folder.write("m.yml", "DATA:\n  - {type: formula 5, wavelength_range: 0.3 2.5, coefficients: 1001}\n"), findings));
  EXPECT_FALSE(prescription::read_material(folder.write("t.yml", "DATA:\n  - type: tabulated n\n    data: |\n      0.5 1001\n      0.6 1001\n"), findings));
  EXPECT_EQ(findings.error_count(), 3);  // the table has it in both rows
}

// 2026-11-22, compile: at 4.9e-324 nm, which is 0 um, a wavefront's rms was infinite.
TEST(Finding, AWavelengthThatIsNoneIsRefused) {
  const Folder folder;
  for (const std::string nm : {"4.9e-324", "9e-7", "1.1e12"}) EXPECT_TRUE(prescription::test::read_text(lens("{index: 1.5}", nm)).findings.has_errors()) << nm;
  for (const std::string nm : {"1e-6", "1e12"}) {
    EXPECT_TRUE(prescription::test::read_text(lens("{index: 1.5}", nm)).model) << nm;
    EXPECT_EQ(fuzz_compile(folder, lens("{index: 1.5}", nm)), "") << nm;
  }
  // what --wavelength is held against
  EXPECT_FALSE(medium::air().covers(4.9e-324));
  EXPECT_TRUE(medium::air().covers(1e-6 / 1000));
}

// 2026-11-22, compile: rays from an object 1e-300 mm before the pupil started with directions that were no numbers.
TEST(Finding, ANumberWhoseSquareIsZeroIsRefused) {
  const Folder folder;
  const auto near = [](const std::string& distance) {
    return "sagitta: 1\nwavelengths_nm: [550]\nobject: {distance_mm: " + distance + "}\naperture: {stop_diameter_mm: 1e-50}\nsurfaces:\n"
           "  - {stop: true, thickness_mm: 0, medium: {index: 1.5}}\n  - {}\n";
  };
  EXPECT_THAT(prescription::test::text_of(prescription::test::read_text(near("1e-300")).findings), testing::HasSubstr("distance_mm must be at least 1e-100 in size, not '1e-300'"));
  EXPECT_TRUE(prescription::test::read_text(near("1e-99")).model);
  EXPECT_EQ(fuzz_compile(folder, near("1e-99")), "");
}

// 2026-11-22, compile: on a conic of K = 1e50 refracted directions had the length 0.7, with the status ok; 1e20 did it too.
TEST(Finding, AConicConstantThatLeavesNoNormalIsRefused) {
  const Folder folder;
  const auto with = [](const std::string& K) {
    return "sagitta: 1\nwavelengths_nm: [550]\naperture: {entrance_pupil_diameter_mm: 1e-4}\nsurfaces:\n"
           "  - {stop: true, conic: {radius_mm: 8, conic_constant: " + K + "}, thickness_mm: 5, medium: {index: 1.5}, tilt_deg: [10, 0, 0]}\n  - {}\n";
  };
  for (const std::string K : {"1e50", "-1e50", "1.1e9"}) EXPECT_TRUE(prescription::test::read_text(with(K)).findings.has_errors()) << K;
  for (const std::string K : {"1e9", "-1e9"}) {
    EXPECT_TRUE(prescription::test::read_text(with(K)).model) << K;
    EXPECT_EQ(fuzz_compile(folder, with(K)), "") << K;
  }
}

std::string numbers_to(int last) {
  std::string list = "1";
  for (int i = 2; i <= last; ++i) list += fmt::format(", {}", i);
  return "[" + list + "]";
}
std::string repeated(const std::string& line, int count) {
  std::string all;
  for (int i = 0; i < count; ++i) all += line;
  return all;
}
const std::string study = "sagitta_study: 1\nname: s\nsystem: base.yaml\nsurface: front\nvariants:\n";

prescription::StudyReadResult read_study(const std::string& text) {
  const Folder folder;
  put_named_files(folder);
  return prescription::read_study(folder.write("study.yaml", text));
}

// 2026-11-22, study: 3 KB of blocks by alias, 10,000 variants each, took more than 2 GB; and so did a list of roughnesses.
TEST(Finding, AStudyIsRefusedBeforeItsVariantsFillTheMemory) {
  const std::string block = "  - &b {interpolation: linear, points_per_mm2: " + numbers_to(100) + ", seed: " + numbers_to(100) + "}\n";
  EXPECT_EQ(read_study(study + block).study.value().variants.size(), prescription::most_variants);
  const auto blocks = read_study(study + block + repeated("  - *b\n", 300));
  EXPECT_THAT(prescription::test::text_of(blocks.findings), testing::HasSubstr("more than 10000 variants"));
  const auto rough = read_study(study + "  - interpolation: analytic\n    roughness:\n      - &r {rms_um: " + numbers_to(100) + ", correlation_length_um: " + numbers_to(100) +
                                "}\n" + repeated("      - *r\n", 300));
  EXPECT_THAT(prescription::test::text_of(rough.findings), testing::HasSubstr("more than 10000 variants"));
}

// 2026-11-22, study: 500 printed figures were looked for among 10,000 variants each, 12 s in the sanitized build for 4 KB.
TEST(Finding, PrintedFiguresAreBounded) {
  const std::string text = study + "  - {interpolation: analytic, seed: [1, 2]}\npaper:\n  - &p {where: {seed: 2}}\n";
  EXPECT_EQ(read_study(text + repeated("  - *p\n", 199)).study.value().paper.size(), prescription::most_figures);
  EXPECT_THAT(prescription::test::text_of(read_study(text + repeated("  - *p\n", 200)).findings), testing::HasSubstr("201 printed figures are more than 200"));
}

// 2026-11-22, prescription: a cloud of 260 KB that 500 surfaces name, 4 KB in all, was read and kept 500 times.
TEST(Finding, ACloudIsReadOnceForAllSurfacesThatNameIt) {
  const Folder folder;
  put_named_files(folder);
  const std::string begin = "sagitta: 1\nwavelengths_nm: [550]\naperture: {entrance_pupil_diameter_mm: 2}\nsurfaces:\n  - {stop: true, thickness_mm: 1}\n";
  const std::string shape = "{thickness_mm: 1, delaunay: {points: points.xyz, interpolation: linear}}", ply = "{thickness_mm: 1, delaunay: {points: points.ply, format: ply, interpolation: linear}}";
  const auto read = prescription::read_prescription(
      folder.write("system.yaml", begin + "  - &s " + shape + "\n  - *s\n  - " + ply + "\n  - {thickness_mm: 1, delaunay: {points: points.xyz, axes: osa, interpolation: linear}}\n  - {}\n"));
  ASSERT_TRUE(read.model) << prescription::test::text_of(read.findings);
  const auto& surfaces = read.model->surfaces;
  EXPECT_EQ(surfaces[1].shape.cloud, surfaces[2].shape.cloud);
  EXPECT_NE(surfaces[1].shape.cloud, surfaces[3].shape.cloud);
  EXPECT_NE(surfaces[1].shape.cloud, surfaces[4].shape.cloud);
  EXPECT_EQ(surfaces[1].shape.cloud->points[3].x, -surfaces[4].shape.cloud->points[3].x);

  folder.write("points.xyz", "1 2\n");
  const auto refused = prescription::read_prescription(folder.write("system.yaml", begin + "  - &s " + shape + "\n  - *s\n  - " + shape + "\n  - {}\n"));
  EXPECT_EQ(refused.findings.error_count(), 3);  // one in the file, one for each further surface
  EXPECT_THAT(prescription::test::text_of(refused.findings), testing::HasSubstr("system.yaml:8:42: error: 'points.xyz' cannot be read\n  hint: see line 6"));
}

// What a target begins with is of use: it gets beyond the reader.
TEST(Seeds, AreReadAndCompiled) {
  const Folder folder;
  put_named_files(folder);
  const auto base = prescription::read_prescription(folder.path() + "/base.yaml");
  EXPECT_TRUE(base.model) << prescription::test::text_of(base.findings);
  for (const std::string format : {"xyz", "polar", "cso", "ply"}) {
    prescription::Findings findings;
    const auto cloud = prescription::read_cloud({folder.path() + "/points." + format, format}, findings);
    ASSERT_TRUE(cloud) << prescription::test::text_of(findings);
    EXPECT_GE(cloud->points.size(), 24u) << format;
  }
}

}  // namespace
}  // namespace sagitta::fuzz
