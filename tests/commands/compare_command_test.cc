// SPDX-License-Identifier: Apache-2.0
// `sagitta compare` as it is shipped: the same rays through several systems, files, numbers, exit status.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <nlohmann/json.hpp>

#include "tests/support/compared.h"
#include "tests/support/exr_file.h"
#include "tests/support/program.h"

namespace sagitta::test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

std::string lens(const std::string& name, const std::string& top = {}, const std::string& back = {}) {
  return "sagitta: 1\nname: " + name + "\n" + (top.empty() ? "wavelengths_nm: [550, 633]\naperture: {entrance_pupil_diameter_mm: 8}\nfields: {angles_deg: [[0, 0], [1, 3]]}\n" : top) +
         "surfaces:\n  - {name: front, stop: true, conic: {radius_mm: 50}, thickness_mm: 4, medium: N-BK7}\n"
         "  - {name: back, conic: {radius_mm: -50}, thickness_mm: 48" + back + "}\n  - {name: image}\n";
}

TEST(CompareCommand, a_system_differs_from_itself_by_nothing) {
  const std::string eye = systems + "navarro-eye.yaml";
  const json summary = compared(eye + " " + eye + " --rays 300");
  ASSERT_EQ(summary["systems"].size(), 2u);
  EXPECT_NE(summary["systems"][0]["system"], summary["systems"][1]["system"]);
  EXPECT_NE(summary["systems"][0]["slug"], summary["systems"][1]["slug"]);
  ASSERT_EQ(summary["differences"].size(), 1u);
  ASSERT_EQ(summary["differences"][0]["results"].size(), 9u);
  for (const json& result : summary["differences"][0]["results"]) {
    EXPECT_EQ(result["spot"]["rms_radius_difference_um"], 0);
    EXPECT_EQ(result["spot"]["rms_radius_difference_percent"], 0);
    EXPECT_EQ(result["spot"]["centroid_shift_mm"], json({0, 0}));
    const json& wavefront = result["wavefront"];
    EXPECT_EQ(wavefront["rms_waves"], 0);
    EXPECT_EQ(wavefront["rms_without_tilt_waves"], 0);
    EXPECT_EQ(wavefront["peak_to_valley_waves"], 0);
    EXPECT_EQ(wavefront["samples"], 3001);
    EXPECT_EQ(wavefront["samples_only_in_first"], 0);
    EXPECT_EQ(wavefront["samples_only_in_this"], 0);
    ASSERT_EQ(wavefront["zernike"]["coefficients_um"].size(), 36u);
    for (const json& coefficient : wavefront["zernike"]["coefficients_um"]) EXPECT_EQ(coefficient, 0);
  }
  EXPECT_EQ(summary["systems"][0]["results"], summary["systems"][1]["results"]);
}

// 2026-11-23: differences of coefficients were in the tracer's frame beside coefficients in the examiner's.
TEST(CompareCommand, of_eyes_has_coefficients_in_the_examiners_frame) {
  const Folder folder;
  const json summary = compared(folder.file("a.yaml", lens("a") + "eye: right\n") + " " + folder.file("b.yaml", lens("b", {}, ", tilt_deg: [0, 2, 0]") + "eye: right\n") + " --rays 300");
  const json &difference = summary["differences"][0]["results"][0]["wavefront"]["zernike"];
  EXPECT_EQ(difference["frame"], "OSA axes: x to the examiner's right, y up");
  for (std::size_t j = 0; j < 36; ++j) {
    const auto of = [&](std::size_t system) { return summary["systems"][system]["results"][0]["wavefront"]["zernike"]["coefficients_um"][j].get<double>(); };
    EXPECT_EQ(difference["coefficients_um"][j].get<double>(), of(1) - of(0)) << j;
    if (j == 2) {
      EXPECT_GT(std::abs(of(1)), .01);  // tilt in x
    }
  }
}

TEST(CompareCommand, of_a_left_and_a_right_eye_says_which_is_which) {
  const Folder folder;
  const std::string left = folder.file("a.yaml", lens("a") + "eye: left\n"), right = folder.file("b.yaml", lens("b") + "eye: right\n"), none = folder.file("c.yaml", lens("c"));
  const auto said = [&](const std::string& files) { return run_program("compare " + files + " --rays 300 -o " + folder.path("out")).out; };
  const std::string axes = ", OSA axes: x to the examiner's right, y up\n";
  EXPECT_THAT(said(left + " " + left), HasSubstr("; left eye" + axes));
  EXPECT_THAT(said(left + " " + right), HasSubstr("; a: left eye, b: right eye" + axes));
  EXPECT_THAT(said(none + " " + right), HasSubstr("; c: eye not said, b: right eye" + axes));
}

TEST(CompareCommand, the_first_systems_numbers_are_those_of_trace) {
  const json summary = compared(systems + "cornea-zernike.yaml " + systems + "cornea-delaunay.yaml --rays 700 --pattern random:3");
  const json alone = traced(systems + "cornea-zernike.yaml", "--rays 700 --pattern random:3");
  for (const char* key : {"system", "version", "first_order", "results"}) EXPECT_EQ(summary["systems"][0][key], alone[key]) << key;
  EXPECT_EQ(summary["rays_of"], alone["system"]);
  // the second one has the same aperture and fields, so it is as alone too; its coverage stands there, and what to think of it
  const json second = traced(systems + "cornea-delaunay.yaml", "--rays 700 --pattern random:3");
  EXPECT_EQ(summary["systems"][1]["results"].size(), second["results"].size());
  EXPECT_EQ(summary["systems"][1]["results"][0]["coverage"], second["results"][0]["coverage"]);
  EXPECT_EQ(summary["systems"][1]["note"], second["note"]);
  EXPECT_THAT(second["note"].get<std::string>(), HasSubstr("unusable for wavefronts"));
  EXPECT_FALSE(alone.contains("note"));
}

// The bounds are the issue's: c1 on points of a smooth cornea is within 0.02 waves; flat facets are far from that.
TEST(CompareCommand, points_by_c1_stand_for_the_surface_they_are_of_and_flat_facets_do_not) {
  const Folder folder;
  const std::string c1 = folder.file("c1.yaml", "extends: " + systems + "cornea-delaunay.yaml\nname: c1\nsurfaces:\n  - {name: anterior cornea, delaunay: {points: " +
                                                systems + "cornea-24x180.xyz}}\n");
  const json summary = compared(systems + "cornea-zernike.yaml " + c1 + " " + systems + "cornea-delaunay.yaml");
  ASSERT_EQ(summary["differences"].size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    const json &smooth = summary["differences"][0]["results"][i], &flat = summary["differences"][1]["results"][i];
    EXPECT_LE(smooth["wavefront"]["rms_waves"].get<double>(), 0.02);
    EXPECT_LE(std::abs(smooth["spot"]["rms_radius_difference_percent"].get<double>()), 0.3);
    EXPECT_GT(flat["wavefront"]["rms_waves"].get<double>(), 0.05);
    EXPECT_GT(flat["spot"]["rms_radius_difference_percent"].get<double>(), 100);
    EXPECT_EQ(smooth["wavefront"]["samples"], 3001);
  }
}

TEST(CompareCommand, the_rays_are_those_of_the_first_system) {
  const Folder folder;
  const std::string a = folder.file("a.yaml", lens("A"));
  // another beam, other fields, colours and object of its own: none of them plays a part
  const std::string b = folder.file("b.yaml", lens("B", "wavelengths_nm: [600]\nprimary_nm: 590\naperture: {object_na: 0.02}\nfields: {object_heights_mm: [[1, 1]]}\nobject: {distance_mm: 300}\n"));
  // the stop stands elsewhere: the beam is still the first one's, but the exit pupil is not
  std::string text = lens("C");
  text.replace(text.find("stop: true, "), 12, "");
  text.replace(text.find("name: back"), 10, "name: back, stop: true");
  const std::string c = folder.file("c.yaml", text);
  const json summary = compared(a + " " + b + " " + c + " --rays 400");
  EXPECT_EQ(summary["systems"][0]["results"], summary["systems"][1]["results"]);
  EXPECT_EQ(summary["systems"][0]["first_order"], summary["systems"][1]["first_order"]);
  ASSERT_EQ(summary["systems"][2]["results"].size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(summary["systems"][0]["results"][i]["spot"], summary["systems"][2]["results"][i]["spot"]);
    EXPECT_NE(summary["systems"][0]["results"][i]["wavefront"]["reference_sphere_radius_mm"],
              summary["systems"][2]["results"][i]["wavefront"]["reference_sphere_radius_mm"]);
  }
  EXPECT_NE(traced(c, "--rays 400")["results"][2]["spot"], summary["systems"][2]["results"][2]["spot"]);  // alone its beam differs
}

TEST(CompareCommand, the_medium_before_every_system_is_that_of_the_first) {
  const Folder folder;
  const std::string eye = systems + "navarro-eye.yaml", in_water = folder.file("water.yaml", "extends: " + eye + "\nname: In water\nobject: {medium: {index: 1.33}}\n");
  for (const std::string& both : {eye + " " + in_water, in_water + " " + eye}) {
    const json summary = compared(both + " --rays 300");
    EXPECT_EQ(summary["systems"][0]["results"], summary["systems"][1]["results"]) << both;
    EXPECT_EQ(summary["systems"][0]["first_order"], summary["systems"][1]["first_order"]) << both;
  }
}

TEST(CompareCommand, a_finite_object_of_the_first_is_before_every_system) {
  const Folder folder;
  const std::string top = "wavelengths_nm: [550]\naperture: {object_na: 0.02}\nfields: {object_heights_mm: [[0, 0], [2, 3]]}\nobject: {distance_mm: 100}\n";
  const std::string a = folder.file("a.yaml", lens("A", top)), b = folder.file("b.yaml", lens("B"));
  const json summary = compared(a + " " + b + " --rays 400");
  EXPECT_EQ(summary["systems"][0]["results"], summary["systems"][1]["results"]);
  EXPECT_EQ(summary["systems"][1]["results"][1]["object_height_mm"], json({2, 3}));
  EXPECT_EQ(summary["differences"][0]["results"][1]["object_height_mm"], json({2, 3}));
}

TEST(CompareCommand, the_parts_hold_every_system_and_every_difference) {
  const Folder folder;
  const std::string a = folder.file("a.yaml", lens("Lens A")), b = folder.file("b.yaml", lens("Lens B", "", ", semi_diameter_mm: 3"));
  ASSERT_EQ(run_program("compare " + a + " " + b + " -o " + folder.path("out") + " --rays 500").status, 0);
  const json summary = json::parse(read_text(folder.path("out/summary.json")));
  const auto all = read_exr(folder.path("out/comparison.exr"));
  ASSERT_EQ(all.size(), 1u + 2 * 8 + 4);
  EXPECT_EQ(all[0].name, "preview");
  std::map<std::string, const ExrFilePart*> by_name;
  for (const ExrFilePart& part : all) by_name[part.name] = &part;
  ASSERT_EQ(by_name.size(), all.size());
  for (int field = 0; field < 2; ++field)
    for (int w = 0; w < 2; ++w) {
      const std::string at = fmt::format("field{}.{}nm", field, w == 0 ? 550 : 633);
      for (const char* name : {"lens-a.spot.", "lens-a.wavefront.", "lens-b.spot.", "lens-b.wavefront.", "lens-b-minus-lens-a.wavefront."})
        ASSERT_TRUE(by_name.contains(name + at)) << name << at;
      const ExrFilePart &first = *by_name["lens-a.wavefront." + at], &other = *by_name["lens-b.wavefront." + at],
                        &difference = *by_name["lens-b-minus-lens-a.wavefront." + at];
      const json& told = summary["differences"][0]["results"][static_cast<std::size_t>(2 * field + w)]["wavefront"];
      const auto &y = difference.floats.at("Y"), &of_first = first.floats.at("Y"), &of_other = other.floats.at("Y");
      const auto& mask = difference.counts.at("difference.mask");
      std::map<unsigned, int> counts;
      double sum = 0, squares = 0;
      for (std::size_t i = 0; i < y.size(); ++i) {
        ++counts[mask[i]];
        EXPECT_EQ(std::isnan(y[i]), mask[i] != 0);
        if (mask[i] != 0) continue;
        // three roundings to float of some waves: 3 * 2^-24 * 10
        EXPECT_NEAR(y[i], of_other[i] - of_first[i], 2e-6);
        sum += y[i], squares += static_cast<double>(y[i]) * y[i];
      }
      EXPECT_EQ(counts[0], told["samples"]);
      EXPECT_EQ(counts[1], told["samples_only_in_first"]);
      EXPECT_EQ(counts[2], 0);
      EXPECT_EQ(counts[0] + counts[1], 3001);
      EXPECT_GT(counts[1], 500);  // clipped beyond 3 of 4 mm
      EXPECT_NEAR(std::sqrt(squares / counts[0] - std::pow(sum / counts[0], 2)), told["rms_waves"].get<double>(), 1e-5);
      EXPECT_EQ(difference.text("first_system"), "Lens A");
      EXPECT_EQ(difference.text("units.Y"), "waves");
      EXPECT_THAT(difference.text("sign"), HasSubstr("OPD(system) - OPD(first_system)"));
      EXPECT_EQ(difference.number("rms_waves"), told["rms_waves"].get<double>());
      EXPECT_EQ(difference.number("rms_without_tilt_waves"), told["rms_without_tilt_waves"].get<double>());
      // spots at one scale
      EXPECT_EQ(by_name["lens-a.spot." + at]->pair("pixel_size_mm").x, by_name["lens-b.spot." + at]->pair("pixel_size_mm").x);
    }
  EXPECT_TRUE(std::filesystem::exists(folder.path("out/comparison.png")));
  EXPECT_TRUE(std::filesystem::exists(folder.path("out/comparison.field1.png")));
  EXPECT_FALSE(std::filesystem::exists(folder.path("out/comparison.field2.png")));
}

TEST(CompareCommand, gives_the_same_bytes_for_any_thread_count) {
  const Folder folder;
  const std::string arguments = "compare " + systems + "cornea-zernike.yaml " + systems + "cornea-delaunay.yaml --rays 3000 -o ";
  ASSERT_EQ(run_program(arguments + folder.path("1") + " --threads 1").status, 0);
  ASSERT_EQ(run_program(arguments + folder.path("3") + " --threads 3").status, 0);
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path("1"))) {
    const std::string name = entry.path().filename();
    EXPECT_TRUE(read_text(entry.path()) == read_text(folder.path("3/" + name))) << name;
    ++count;
  }
  EXPECT_EQ(count, 4);
}

TEST(CompareCommand, says_which_medium_of_which_system_does_not_reach) {
  const Folder folder;
  const std::string a = folder.file("a.yaml", "sagitta: 1\nwavelengths_nm: [550]\nprimary_nm: 200\naperture: {entrance_pupil_diameter_mm: 4}\nsurfaces:\n  - {stop: true, conic: {radius_mm: 50}, thickness_mm: 100, medium: {index: 1.5}}\n  - {}\n");
  const std::string b = folder.file("b.yaml", lens("B"));
  const Outcome run = run_program("compare " + a + " " + b + " -o " + folder.path("out"));
  EXPECT_EQ(run.status, 1);
  EXPECT_EQ(run.out, "");
  EXPECT_THAT(run.err, HasSubstr("sagitta compare: " + b + ", by the rays of " + a + ": 200 nm lies outside the range of N-BK7"));
  EXPECT_FALSE(std::filesystem::exists(folder.path("out")));
}

TEST(CompareCommand, a_system_that_no_ray_passes_or_that_is_afocal_says_so) {
  const Folder folder;
  const std::string a = folder.file("a.yaml", lens("A")), dark = folder.file("dark.yaml", lens("Dark", "", ", inner_semi_diameter_mm: 20")),
                    afocal = folder.file("afocal.yaml", "sagitta: 1\nname: Afocal\nwavelengths_nm: [550]\naperture: {entrance_pupil_diameter_mm: 4}\nsurfaces:\n  - {stop: true, thickness_mm: 4}\n  - {}\n");
  const Outcome run = run_program("compare " + a + " " + dark + " -o " + folder.path("out") + " --rays 100");
  EXPECT_EQ(run.status, 1);
  EXPECT_THAT(run.err, HasSubstr("not one ray arrived at the image surface of Dark"));
  const json with_dark = json::parse(read_text(folder.path("out/summary.json")));
  EXPECT_TRUE(with_dark["differences"][0]["results"][0]["spot"]["rms_radius_difference_um"].is_null());
  const json with_afocal = compared(a + " " + afocal + " --rays 100");
  EXPECT_TRUE(with_afocal["differences"][0]["results"][0]["wavefront"].is_null());
  EXPECT_EQ(with_afocal["systems"][1]["results"][0]["reason"], "the image is afocal");
}

TEST(CompareCommand, exit_status_tells_wrong_usage_from_wrong_input) {
  const Folder folder;
  const std::string a = folder.file("a.yaml", lens("A")), bad = folder.file("bad.yaml", "sagitta: 2\n"), worse = folder.file("worse.yaml", "- 1\n"),
                    out = " -o " + folder.path("out"), points = systems + "measured-cornea.xyz";
  const std::string variants = "compare " + a + out + " --surface front --with " + points;
  for (const std::string& arguments : std::vector<std::string>{"compare" + out, "compare " + a + " " + a, "compare " + a + out, "compare " + a + " " + a + out + " --rays 0",
           "compare " + a + " " + a + out + " --pattern x", "compare " + a + out + " --surface front", variants, variants + " --as delaunay", "compare " + a + " " + a + out + " --as delaunay,zernike:3",
           "compare " + a + " " + a + out + " --surface front --with " + points + " --as delaunay,zernike:3", variants + " --as delaunay,zernik:3", variants + " --as delaunay,zernike:0",
           variants + " --as delaunay,zernike:x", variants + " --as delaunay,zernike:9999", variants + " --as delaunay,delaunay:quintic", variants + " --as delaunay,zernike:3 --radius-mm 0",
           variants + " --as delaunay,zernike:3 --format csv", variants + " --as delaunay,",
           variants + " --as zernike:1,zernike:2,zernike:3,zernike:4,zernike:5,zernike:6,zernike:7,zernike:8,zernike:9,zernike:10,zernike:11,zernike:12,zernike:13,zernike:14,zernike:15,zernike:16,zernike:17"}) {
    const Outcome run = run_program(arguments);
    EXPECT_EQ(run.status, 2) << arguments;
    EXPECT_NE(run.err, "") << arguments;
    EXPECT_EQ(run.out, "") << arguments;
  }
  EXPECT_FALSE(std::filesystem::exists(folder.path("out")));
  const Outcome faults = run_program("compare " + bad + " " + worse + out);
  EXPECT_EQ(faults.status, 1);
  EXPECT_THAT(faults.err, HasSubstr(bad + ":1:10: error: sagitta must be 1"));
  EXPECT_THAT(faults.err, HasSubstr(worse + ":1:1: error:"));  // all findings in one run
  const Outcome unknown = run_program("compare " + a + out + " --surface frond --with " + points + " --as delaunay,zernike:3");
  EXPECT_EQ(unknown.status, 1);
  EXPECT_THAT(unknown.err, HasSubstr("no surface of " + a + " is named 'frond'\n  hint: did you mean 'front'?"));
  const Outcome missing = run_program("compare " + a + out + " --surface front --with none.txt --as delaunay,zernike:3");
  EXPECT_EQ(missing.status, 1);
  EXPECT_THAT(missing.err, HasSubstr("--with: error: there is no file 'none.txt'"));
  const Outcome axes = run_program(variants + " --as delaunay,zernike:3 --format cso --axes osa");
  EXPECT_EQ(axes.status, 1);
  EXPECT_THAT(axes.err, HasSubstr("--with: error: axes must be local for the format cso"));
  EXPECT_EQ(run_program("compare --help").status, 0);
}

}  // namespace
}  // namespace sagitta::test
