// SPDX-License-Identifier: Apache-2.0
// What fuzzing found, each with its input, what was wrong, and when.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <string>

#include "lib/medium/medium.h"
#include "lib/prescription/keys.h"
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
// is below the last digit. At the largest ratio of legal indices, 1e6, a direction's length is still 1 within 1e6 ulp;
// out of an index of 1e6 at the critical angle of 1e-6 it was off by 2e-8.
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
  std::string steps = lens("{index: 1000}");
  steps.replace(steps.find("thickness_mm: 5}"), 15, "thickness_mm: 5, medium: {index: 0.001}");
  EXPECT_TRUE(prescription::test::read_text(steps).model);
  EXPECT_EQ(fuzz_compile(folder, steps), "");
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

std::string zernike(const std::string& normalization_radius_mm, const std::string& coefficients_um, const std::string& diameter_mm = "2", const std::string& base = "") {
  return "sagitta: 1\nwavelengths_nm: [550]\naperture: {entrance_pupil_diameter_mm: " + diameter_mm + "}\nsurfaces:\n  - {stop: true, zernike: {" + base +
         "normalization_radius_mm: " + normalization_radius_mm + ", indexing: osa, coefficients_um: {" + coefficients_um + "}}, thickness_mm: 3, medium: {index: 1.5}}\n" +
         "  - {thickness_mm: 2}\n  - {}\n";
}

// 2026-11-22, compile: with a coefficient of 1e50 um or a normalisation radius of 1e-50 mm slopes were so large that their squares are none,
// and directions of length 0.8 had the status ok.
TEST(Finding, AZernikeSumOfNoUsableScaleIsRefused) {
  const Folder folder;
  const auto refused = [](const std::string& text) { return prescription::test::text_of(prescription::test::read_text(text).findings); };
  EXPECT_THAT(refused(zernike("1e-50", "4: 1")), testing::HasSubstr("system.yaml:5:53: error: normalization_radius_mm must be a number from 1e-15 to 1000000000000000, not '1e-50'\n"
                                                                    "  hint: it is in mm; powers of the radius over it would leave the range of numbers\n"));
  EXPECT_THAT(refused(zernike("1.1e15", "4: 1")), testing::HasSubstr("normalization_radius_mm must be"));
  EXPECT_THAT(refused(zernike("0", "4: 1")), testing::Not(testing::HasSubstr("hint")));
  EXPECT_THAT(refused(zernike("3", "4: 1e50")), testing::HasSubstr("system.yaml:5:92: error: coefficients_um of index 4 must be a number from -1e+18 to 1e+18, not '1e50'\n"
                                                                   "  hint: it is in um; the slopes of a larger one would leave the range of numbers\n"));
  EXPECT_THAT(refused(zernike("3", "4: -1.1e18")), testing::HasSubstr("coefficients_um of index 4 must be"));
}

// Rays far outside the normalisation radius meet powers up to the order: within the legal scales every one ends as it should.
TEST(Finding, RaysFarOutsideTheNormalizationRadiusEndWithAStatus) {
  const Folder folder;
  int compiled_count = 0;
  for (const std::string radius : {"1e-15", "1e-6", "1", "1e6", "1e15"})
    for (const std::string coefficient : {"-1e18", "1e-99", "1e-6", "1", "1e9", "1e18"})
      for (const std::string index : {"1", "4", "60", "90", "700", "5150"})
        for (const std::string diameter : {"1e-6", "2", "1e6", "1e99"})
          for (const std::string base : {"", "radius_mm: 8, conic_constant: -0.3, ", "radius_mm: 1e12, conic_constant: 1e9, "}) {
            const std::string text = zernike(radius, index + ": " + coefficient, diameter, base);
            compiled_count += prescription::test::read_text(text).model.has_value();
            EXPECT_EQ(fuzz_compile(folder, text), "") << text;
          }
  EXPECT_EQ(compiled_count, 5 * 6 * 6 * 4 * 3);
}

// 2026-11-22, prescription: half a megabyte of name, which aliases give to 10,000 surfaces, took 2 GB; and so much of digits 20 s.
TEST(Finding, TextIsCountedWithEveryAliasExpanded) {
  const auto with = [](std::size_t length, int aliases) {
    return prescription::test::read_text("sagitta: 1\nname: &a " + std::string(length, 'x') + "\nwavelengths_nm: [550]\naperture: {entrance_pupil_diameter_mm: 2}\nsurfaces:\n" +
                                         "  - {stop: true, thickness_mm: 1}\n" + repeated("  - {name: *a, thickness_mm: 1}\n", aliases) + "  - {}\n");
  };
  EXPECT_TRUE(with(1 << 18, 2).model);  // three quarters of a mebibyte, and 200 bytes or so of other texts
  EXPECT_THAT(prescription::test::text_of(with(1 << 18, 3).findings), testing::HasSubstr("system.yaml:9:12: error: more than 1 MiB of text, with every alias expanded"));
  EXPECT_TRUE(with(1, 9000).model);
}

// 2026-11-22, prescription: of n surfaces or wavelengths every one was held against every medium: 5 s for a megabyte.
TEST(Finding, SurfacesAndWavelengthsAreBounded) {
  const auto with = [](int surface_count, int wavelength_count) {
    return prescription::test::read_text("sagitta: 1\nwavelengths_nm: " + numbers_to(wavelength_count) + "\naperture: {entrance_pupil_diameter_mm: 2}\nsurfaces:\n" +
                                         "  - {stop: true, thickness_mm: 1}\n" + repeated("  - {thickness_mm: 1}\n", surface_count - 2) + "  - {}\n");
  };
  EXPECT_TRUE(with(prescription::most_surfaces, 1).model);
  EXPECT_TRUE(with(2, prescription::most_wavelengths).model);
  EXPECT_THAT(prescription::test::text_of(with(prescription::most_surfaces + 1, 1).findings), testing::HasSubstr("system.yaml:5:3: error: 10001 surfaces are more than 10000"));
  EXPECT_THAT(prescription::test::text_of(with(2, prescription::most_wavelengths + 1).findings), testing::HasSubstr("system.yaml:2:17: error: 1001 wavelengths are more than 1000"));
}

// 2026-11-22, prescription and study: every surface that a file changed was looked for among all of its base, 7 s for half a megabyte; and of one
// that was not there the message listed all that were, 70 KB.
TEST(Finding, NamesOfManySurfacesAreFoundAndNotAllListed) {
  const Folder folder;
  constexpr int surface_count = 9000;
  std::string base = "sagitta: 1\nwavelengths_nm: [550]\naperture: {entrance_pupil_diameter_mm: 2}\nsurfaces:\n", changes = "extends: system.yaml\nsurfaces:\n", strange = changes;
  for (int i = 0; i < surface_count; ++i) {
    base += fmt::format("  - {{name: s{}, stop: {}, thickness_mm: 1}}\n", i, i == 0);
    changes += fmt::format("  - {{name: s{}, thickness_mm: {}}}\n", surface_count - 1 - i, surface_count - 1 - i);
    strange += fmt::format("  - {{name: quite another {}}}\n", i);
  }
  folder.write("system.yaml", base + "  - {}\n");
  const auto changed = prescription::read_prescription(folder.write("changed.yaml", changes));
  ASSERT_TRUE(changed.model) << prescription::test::text_of(changed.findings);
  for (int i = 0; i < surface_count; ++i) ASSERT_EQ(changed.model->surfaces[static_cast<std::size_t>(i)].thickness_mm, i);
  const auto refused = prescription::read_prescription(folder.write("strange.yaml", strange));
  EXPECT_THAT(prescription::test::text_of(refused.findings), testing::HasSubstr("hint: its surfaces are: s0, s1, s2, s3, s4, s5, s6, s7, s8, s9, s10, s11 and 8988 more\n"));
  EXPECT_THAT(prescription::test::text_of(refused.findings), testing::HasSubstr("and 8900 more errors"));
  const auto study_of = prescription::read_study(folder.write("study.yaml", "sagitta_study: 1\nname: s\nsystem: system.yaml\nsurface: quite another\nvariants: [{interpolation: analytic}]\n"));
  EXPECT_THAT(prescription::test::text_of(study_of.findings), testing::HasSubstr("s11 and 8988 more"));
}

// 2026-11-22, prescription: of keys, too, every one was looked for among all of the base.
TEST(Finding, KeysOfAFileThatExtendsAnotherReplaceTheBasesInItsOrder) {
  const Folder folder;
  std::string base = "sagitta: 1\n", changes = "extends: base.yaml\n";
  for (int i = 0; i < 30'000; ++i) base += fmt::format("b{}: 1\n", i), changes += fmt::format("c{}: 1\n", i);
  folder.write("base.yaml", base);
  const auto read = prescription::read_prescription(folder.write("changed.yaml", changes));
  EXPECT_THAT(prescription::test::text_of(read.findings), testing::HasSubstr("and 59903 more errors"));  // 60,000 unknown keys, three that are missing
}

// 2026-11-22, material: a table whose one row stood at 4.9e-324 um had no index half-way between its ends, which is 0.
TEST(Finding, AMaterialsWavelengthThatIsNoneIsRefused) {
  const Folder folder;
  const auto errors_of = [&](const std::string& entry) {
    prescription::Findings findings;
    const auto medium = prescription::read_material(folder.write("m.yml", "DATA:\n  - " + entry + "\n"), findings);
    EXPECT_EQ(medium.has_value(), findings.error_count() == 0);
    EXPECT_EQ(fuzz_material(folder, "DATA:\n  - " + entry + "\n"), "");
    return prescription::test::text_of(findings);
  };
  for (const std::string um : {"4.9e-324", "9e-10", "1.1e9"}) {
    EXPECT_THAT(errors_of("{type: tabulated n, data: " + um + " 1.5}"), testing::HasSubstr("the wavelength must be from 1e-09 to 1000000000 um")) << um;
    EXPECT_THAT(errors_of("{type: formula 5, wavelength_range: " + um + " " + um + ", coefficients: 1.5}"), testing::HasSubstr("is not two wavelengths in um, 1e-09 <= shortest <= longest <= 1000000000")) << um;
  }
  for (const std::string um : {"1e-9", "1e9"}) {
    EXPECT_EQ(errors_of("{type: tabulated n, data: " + um + " 1.5}"), "") << um;
    EXPECT_EQ(errors_of("{type: formula 5, wavelength_range: " + um + " " + um + ", coefficients: 1.5}"), "") << um;
  }
}

// 2026-11-22, material: this Sellmeier formula has a pole at 2 um, so narrow that the reader does not see it. A system that is used there does.
TEST(Finding, ANarrowPoleIsSeenWhereItIsUsed) {
  const Folder folder;
  const std::string pole = "DATA:\n  - {type: formula 1, wavelength_range: 0.5 2.5, coefficients: 1.2 0.5 0.01 0.3 0.02 1.01 100 0.001 2}\n";
  EXPECT_EQ(fuzz_material(folder, pole), "");
  folder.write("pole.yml", pole);
  const auto at = [&](const std::string& nm) { return prescription::read_prescription(folder.write("system.yaml", lens("pole", nm))); };
  EXPECT_TRUE(at("1999").model);
  EXPECT_THAT(prescription::test::text_of(at("2000").findings), testing::HasSubstr("pole has no index from 0.001 to 1000 at 2000 nm"));
}

// 2026-11-22, material: 116 errors of one file, where 20 are enough.
TEST(Finding, AMaterialOfManyRepeatedKeysIsToldInAFew) {
  const Folder folder;
  std::string keys = "DATA:\n  - {type: formula 5, wavelength_range: 0.4 0.7, coefficients: 1.5}\n";
  for (int i = 0; i < 130; ++i) keys += "A: 1\n";
  EXPECT_EQ(fuzz_material(folder, keys), "");
  prescription::Findings findings;
  EXPECT_FALSE(prescription::read_material(folder.write("keys.yml", keys), findings));
  EXPECT_EQ(findings.error_count(), 20);
  EXPECT_THAT(prescription::test::text_of(findings), testing::HasSubstr("too many errors, the rest of this file was not read"));
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
