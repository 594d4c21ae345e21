// SPDX-License-Identifier: Apache-2.0
// Parameters of a system: in every value that is a number, set from outside, and through `extends`. Errors of a file alone are in bad/.
#include "lib/prescription/arithmetic.h"

#include <gtest/gtest.h>

#include "lib/prescription/reader.h"
#include "tests/prescription/support.h"

namespace sagitta::prescription {
namespace {

Model model_of(const std::string& file, const Settings& settings = {}) {
  const ReadResult result = read_prescription(file, settings);
  EXPECT_EQ(test::text_of(result.findings), "");
  EXPECT_TRUE(result.model.has_value());
  return result.model.value_or(Model{});
}

std::string findings_of(const std::string& file, const Settings& settings = {}) {
  const ReadResult result = read_prescription(file, settings);
  EXPECT_FALSE(result.model);
  return test::text_of(result.findings);
}

const std::string everywhere = R"yaml(sagitta: 1
name: = not arithmetic
parameters: {A: 2, B: 0.5}
wavelengths_nm: [= 500 + A, 600]
primary_nm: = 600
aperture: {stop_diameter_mm: = 2 * A}
fields: {angles_deg: [[= A, "= -A"], [0, 5]]}
object: {distance_mm: = 1000 * A, medium: {index: = 1 + B}}
surfaces:
  - name: front
    stop: true
    conic: {radius_mm: = 8 - A, conic_constant: '= -B'}
    thickness_mm: =A+1
    medium: {nd: = 1.5 + B / 100, vd: = 60 - A}
    semi_diameter_mm: = 3 * A
    inner_semi_diameter_mm: = B
    decenter_mm: [= B, 0, = -B]
    tilt_deg: [0, = A, 0]
  - name: back
    zernike: {radius_mm: -5, normalization_radius_mm: = A, indexing: osa, coefficients_um: {4: = A / 10, 5: 1}}
    thickness_mm: >
      = A +
      B
  - {name: image, zernike: {normalization_radius_mm: 3, indexing: noll, coefficients_um: [0, "= max(A, B)"]}}
)yaml";

void expect_values(const Model& model, double A, double B) {
  EXPECT_EQ(model.name, "= not arithmetic");
  ASSERT_EQ(model.parameters.size(), 2u);
  EXPECT_EQ(model.parameters[0].name, "A");
  EXPECT_EQ(model.parameters[0].value, A);
  EXPECT_EQ(model.parameters[1].value, B);
  EXPECT_EQ(model.wavelengths_nm, (std::vector<double>{500 + A, 600}));
  EXPECT_EQ(model.primary_nm, 600);
  EXPECT_EQ(model.aperture.value, 2 * A);
  EXPECT_EQ(model.fields.points[0].x, A);
  EXPECT_EQ(model.fields.points[0].y, -A);
  EXPECT_EQ(model.object.distance_mm, 1000 * A);
  EXPECT_EQ(model.object.medium.index(0.55), 1 + B);
  const Surface& front = model.surfaces.at(0);
  EXPECT_EQ(front.shape.parameters.number("radius_mm"), 8 - A);
  EXPECT_EQ(front.shape.parameters.number("conic_constant"), -B);
  EXPECT_EQ(front.thickness_mm, A + 1);
  EXPECT_EQ(front.medium->index(0.6), medium::from_nd_vd(1.5 + B / 100, 60 - A).index(0.6));
  EXPECT_EQ(front.semi_diameter_mm, 3 * A);
  EXPECT_EQ(front.inner_semi_diameter_mm, B);
  EXPECT_EQ(front.decenter_mm.x, B);
  EXPECT_EQ(front.decenter_mm.z, -B);
  EXPECT_EQ(front.tilt_deg.y, A);
  const Surface& back = model.surfaces.at(1);
  EXPECT_EQ(back.shape.parameters.number("normalization_radius_mm"), A);
  EXPECT_EQ(back.shape.parameters.list("coefficients_um").front().second, A / 10);
  EXPECT_EQ(back.thickness_mm, A + B);
  EXPECT_EQ(model.surfaces.at(2).shape.parameters.list("coefficients_um").back().second, std::max(A, B));
}

TEST(Arithmetic, StandsWhereverANumberCan) {
  const test::TemporaryFolder folder;
  const std::string file = folder.write("system.yaml", everywhere);
  expect_values(model_of(file), 2, 0.5);
  expect_values(model_of(file, {{"B", 0.25}}), 2, 0.25);
  expect_values(model_of(file, {{"B", 0.25}, {"A", 3}}), 3, 0.25);
}

TEST(Arithmetic, NeedsNoParameters) {
  const test::TemporaryFolder folder;
  EXPECT_EQ(model_of(folder.write("s.yaml", "sagitta: 1\nwavelengths_nm: [550]\naperture: {entrance_pupil_diameter_mm: = 1/3}\nsurfaces: [{stop: true, thickness_mm: 1}, {}]\n")).aperture.value, 1.0 / 3);
}

std::string with_thickness(const std::string& text) {
  return "sagitta: 1\nparameters: {A: 2}\nwavelengths_nm: [550]\naperture: {entrance_pupil_diameter_mm: = A}\nsurfaces:\n  - stop: true\n    thickness_mm: " + text + "\n  - {}\n";
}

// The column is that of the fault where the text stands in the file as it is; else that of the value.
TEST(Arithmetic, AFaultIsToldWhereItStandsInTheFile) {
  struct Case {
    const char* text;
    int column;
  };
  for (const Case& one : {Case{"= 1 + C", 25}, {"\"= 1 + C\"", 26}, {"'= 1 + C'", 26}, {"\"= 1\\x20+ C\"", 19}, {">\n      = 1 + C", 19}, {"= 1 +\n      C", 19}, {"&a = 1 + C", 19}}) {
    const test::TemporaryFolder folder;
    const ReadResult result = read_prescription(folder.write("s.yaml", with_thickness(one.text)));
    ASSERT_EQ(result.findings.all().size(), 1u) << one.text << test::text_of(result.findings);
    const Finding& finding = result.findings.all().front();
    EXPECT_EQ(finding.what, "thickness_mm: there is no parameter 'C'");
    EXPECT_EQ(finding.hint, "did you mean 'A'?");
    EXPECT_EQ(finding.place.line, 7) << one.text;
    EXPECT_EQ(finding.place.column, one.column) << one.text;
  }
  // Behind an accent columns count bytes, as everywhere.
  const test::TemporaryFolder folder;
  const ReadResult result = read_prescription(folder.write("s.yaml", "sagitta: 1\nwavelengths_nm: [550]\naperture: {entrance_pupil_diameter_mm: 4}\nsurfaces: [{name: é, stop: true, thickness_mm: = 2 * C}, {}]\n"));
  ASSERT_EQ(result.findings.all().size(), 1u);
  EXPECT_EQ(result.findings.all().front().place.column, 55);
}

TEST(Arithmetic, WhatIsSetMustBeThereAndUsed) {
  const test::TemporaryFolder folder;
  const std::string file = folder.write("s.yaml", with_thickness("= A"));
  EXPECT_EQ(model_of(file, {{"A", 7}}).surfaces[0].thickness_mm, 7);
  EXPECT_EQ(findings_of(file, {{"a", 7}}), "--set a: error: " + file + " declares no such parameter\n  hint: did you mean 'A'?\n");
  EXPECT_EQ(findings_of(file, {{"something", 7}}), "--set something: error: " + file + " declares no such parameter\n  hint: its parameters are: A\n");
  EXPECT_EQ(findings_of(file, {{"A", std::numeric_limits<double>::quiet_NaN()}}), "--set A: error: a parameter must be at most 1e+100 in size, not nan\n");
  EXPECT_NE(findings_of(file, {{"A", -1}}).find("s.yaml:4:40: error: entrance_pupil_diameter_mm must be a number greater than 0, not -1, what '= A' comes to\n"), std::string::npos);
}

TEST(Arithmetic, AnExtendingFileSetsAndAddsParameters) {
  const test::TemporaryFolder folder;
  folder.write("base.yaml", with_thickness("= A").replace(0, 11, "sagitta: 1\nname: base\n"));
  const Model set = model_of(folder.write("set.yaml", "extends: base.yaml\nparameters: {A: 5}\n"));
  EXPECT_EQ(set.surfaces[0].thickness_mm, 5);
  EXPECT_EQ(set.aperture.value, 5);
  const std::string more = folder.write("more.yaml", "extends: base.yaml\nparameters: {B: 3}\naperture: {entrance_pupil_diameter_mm: = A * B}\n");
  EXPECT_EQ(model_of(more).aperture.value, 6);
  EXPECT_EQ(model_of(more, {{"A", 4}}).aperture.value, 12);
  ASSERT_EQ(model_of(more).parameters.size(), 2u);

  // What a base declares may lose its use, but cannot be set then.
  folder.write("simple.yaml", "sagitta: 1\nparameters: {A: 2}\nwavelengths_nm: [550]\naperture: {entrance_pupil_diameter_mm: = A}\nsurfaces: [{stop: true, thickness_mm: 1}, {}]\n");
  const std::string without = folder.write("without.yaml", "extends: simple.yaml\naperture: {entrance_pupil_diameter_mm: 9}\n");
  EXPECT_EQ(model_of(without).aperture.value, 9);
  EXPECT_EQ(findings_of(without, {{"A", 4}}), "--set A: error: nothing in " + without + " uses this parameter any more\n  hint: what it extends declares it\n");
  const std::string unused = folder.write("unused.yaml", "extends: simple.yaml\nparameters: {A: 3}\naperture: {entrance_pupil_diameter_mm: 9}\n");
  EXPECT_NE(findings_of(unused).find("unused.yaml:2:14: error: nothing uses the parameter 'A'\n"), std::string::npos);
}

TEST(Arithmetic, ManyFaultsAreToldInTime) {
  std::string text = "sagitta: 1\nparameters: {";
  for (int i = 0; i < 100; ++i) text += (i > 0 ? ", " : "") + std::string("parameter_with_a_long_name_of_its_own_") + std::to_string(i) + ": 1";
  text += "}\nwavelengths_nm: [550]\naperture: {entrance_pupil_diameter_mm: 4}\nsurfaces:\n  - {stop: true, thickness_mm: 1}\n";
  for (int i = 0; i < 9000; ++i) text += "  - {thickness_mm: = parameter_with_a_long_name_of_its_owm_" + std::to_string(i) + "x}\n";
  const test::TemporaryFolder folder;
  const ReadResult result = read_prescription(folder.write("s.yaml", text + "  - {}\n"));
  EXPECT_FALSE(result.model);
  EXPECT_EQ(result.findings.error_count(), most_told_errors);
  EXPECT_EQ(result.findings.all().back().what, "and 8900 more errors");
}

}  // namespace
}  // namespace sagitta::prescription
