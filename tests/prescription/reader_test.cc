// SPDX-License-Identifier: Apache-2.0
#include "lib/prescription/reader.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>

#include "lib/prescription/keys.h"
#include "tests/prescription/support.h"

namespace sagitta::prescription {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

Model model_of(const std::string& text) {
  const ReadResult result = test::read_text(text);
  EXPECT_EQ(test::text_of(result.findings), "");
  EXPECT_TRUE(result.model.has_value());
  return result.model.value_or(Model{});
}

// A valid prescription with these lines, and with this text in place of the first surface's shape and extras.
std::string system_with(const std::string& aperture, const std::string& lines = "",
                        const std::string& first = "plane: {}") {
  return "sagitta: 1\nwavelengths_nm: [543]\naperture: {" + aperture + "}\n" + lines + "surfaces:\n  - {" + first +
         ", stop: true, thickness_mm: 20}\n  - {}\n";
}

const std::string pupil = "entrance_pupil_diameter_mm: 4";

TEST(Reader, TakesTheExampleOfTheContract) {
  const Model model = model_of(R"(sagitta: 1
name: Wide-angle eye
source: Escudero-Sanz and Navarro, J. Opt. Soc. Am. A 16, 1881 (1999)
wavelengths_nm: [543]
aperture: {entrance_pupil_diameter_mm: 4}      # or stop_diameter_mm, image_f_number, object_na
fields: {angles_deg: [[0, 0], [0, 10]]}        # or object_heights_mm
object: {distance_mm: .inf, medium: air}       # the default
surfaces:
  - {name: anterior cornea, conic: {radius_mm: 7.72, conic_constant: -0.26}, thickness_mm: 0.55, medium: {index: 1.3777}}
  - {name: posterior cornea, conic: {radius_mm: 6.5}, thickness_mm: 3.05, medium: navarro-aqueous}
  - {name: pupil, stop: true, thickness_mm: 0, medium: navarro-aqueous}      # no shape: a plane
  # ...
  - {name: retina, conic: {radius_mm: -12}}      # the last surface is the image surface
)");
  EXPECT_EQ(model.name, "Wide-angle eye");
  EXPECT_EQ(model.source, "Escudero-Sanz and Navarro, J. Opt. Soc. Am. A 16, 1881 (1999)");
  EXPECT_EQ(model.wavelengths_nm, std::vector<double>{543});
  EXPECT_FALSE(model.primary_nm);
  EXPECT_EQ(model.primary_wavelength_nm(), 543);
  EXPECT_EQ(model.aperture.kind, ApertureKind::entrance_pupil_diameter_mm);
  EXPECT_EQ(model.aperture.value, 4);
  EXPECT_EQ(model.fields.kind, FieldKind::angles_deg);
  ASSERT_EQ(model.fields.points.size(), 2u);
  EXPECT_EQ(model.fields.points[1].x, 0);
  EXPECT_EQ(model.fields.points[1].y, 10);
  EXPECT_EQ(model.object.distance_mm, infinity);
  EXPECT_EQ(model.object.medium.index(0.543), 1);

  ASSERT_EQ(model.surfaces.size(), 4u);
  const Surface& cornea = model.surfaces[0];
  EXPECT_EQ(cornea.name, "anterior cornea");
  EXPECT_EQ(cornea.shape.kind, "conic");
  EXPECT_EQ(cornea.shape.parameters.number("radius_mm"), 7.72);
  EXPECT_EQ(cornea.shape.parameters.number("conic_constant"), -0.26);
  EXPECT_EQ(cornea.thickness_mm, 0.55);
  EXPECT_EQ(cornea.medium->index(0.543), 1.3777);
  EXPECT_FALSE(cornea.stop);
  EXPECT_EQ(cornea.semi_diameter_mm, infinity);
  EXPECT_EQ(cornea.inner_semi_diameter_mm, 0);
  EXPECT_EQ(cornea.decenter_mm, (numerics::Vec3<double>{}));
  EXPECT_EQ(cornea.tilt_deg, (numerics::Vec3<double>{}));
  EXPECT_EQ(cornea.place.line, 9);
  EXPECT_EQ(model.surfaces[1].shape.parameters.number("conic_constant"), 0);
  EXPECT_NEAR(model.surfaces[1].medium->index(0.543), 1.3391, 1e-3);  // a name: which dispersion it has is not ours
  EXPECT_EQ(model.surfaces[2].shape.kind, "plane");
  EXPECT_TRUE(model.surfaces[2].stop);
  EXPECT_EQ(model.surfaces[3].shape.parameters.number("radius_mm"), -12);
  EXPECT_EQ(model.surfaces[3].medium->name, "air");
}

TEST(Reader, FillsInTheDefaults) {
  const Model model = model_of(system_with(pupil));
  EXPECT_EQ(model.name, "");
  EXPECT_EQ(model.fields.kind, FieldKind::angles_deg);
  ASSERT_EQ(model.fields.points.size(), 1u);
  EXPECT_EQ(model.fields.points[0].x, 0);
  EXPECT_EQ(model.fields.points[0].y, 0);
  EXPECT_EQ(model.object.distance_mm, infinity);
}

TEST(Reader, TakesEveryApertureKind) {
  const std::string finite = "object: {distance_mm: 100}\n";
  const Model by_pupil = model_of(system_with("entrance_pupil_diameter_mm: 4", finite));
  EXPECT_EQ(by_pupil.aperture.kind, ApertureKind::entrance_pupil_diameter_mm);
  const Model by_stop = model_of(system_with("stop_diameter_mm: 3.5"));
  EXPECT_EQ(by_stop.aperture.kind, ApertureKind::stop_diameter_mm);
  EXPECT_EQ(by_stop.aperture.value, 3.5);
  const Model by_f_number = model_of(system_with("image_f_number: 8"));
  EXPECT_EQ(by_f_number.aperture.kind, ApertureKind::image_f_number);
  EXPECT_EQ(by_f_number.aperture.value, 8);
  const Model by_na = model_of(system_with("object_na: 1.2", "object: {distance_mm: 100, medium: {index: 1.33}}\n"));
  EXPECT_EQ(by_na.aperture.kind, ApertureKind::object_na);
  EXPECT_EQ(by_na.aperture.value, 1.2);
}

TEST(Reader, TakesEveryFieldKindAndObject) {
  const Model angles =
      model_of(system_with(pupil, "fields: {angles_deg: [[-89.9, 0], [1, 2.5]]}\nobject: {distance_mm: -30}\n"));
  EXPECT_EQ(angles.fields.kind, FieldKind::angles_deg);
  EXPECT_EQ(angles.fields.points[0].x, -89.9);
  EXPECT_EQ(angles.fields.points[1].y, 2.5);
  EXPECT_EQ(angles.object.distance_mm, -30);
  const Model heights = model_of(system_with(
      pupil, "fields: {object_heights_mm: [[0, 200]]}\nobject: {distance_mm: 1e3, medium: {index: 1.33}}\n"));
  EXPECT_EQ(heights.fields.kind, FieldKind::object_heights_mm);
  EXPECT_EQ(heights.fields.points[0].y, 200);
  EXPECT_EQ(heights.object.distance_mm, 1000);
  EXPECT_EQ(heights.object.medium.index(0.5), 1.33);
}

TEST(Reader, TakesWhatEverySurfaceMayHave) {
  const Model model =
      model_of(system_with(pupil, "primary_nm: 587.6\n",
                           "conic: {radius_mm: .inf, conic_constant: -1}, semi_diameter_mm: 5, "
                           "inner_semi_diameter_mm: 1, decenter_mm: [1, -2, 3e-1], tilt_deg: [0, 4, -90], "
                           "medium: mirror"));
  EXPECT_EQ(model.primary_wavelength_nm(), 587.6);
  const Surface& surface = model.surfaces[0];
  EXPECT_TRUE(surface.is_mirror());
  EXPECT_FALSE(model.surfaces[1].is_mirror());
  EXPECT_EQ(surface.shape.parameters.number("radius_mm"), infinity);
  EXPECT_EQ(surface.semi_diameter_mm, 5);
  EXPECT_EQ(surface.inner_semi_diameter_mm, 1);
  EXPECT_EQ(surface.decenter_mm, (numerics::Vec3<double>{1, -2, 0.3}));
  EXPECT_EQ(surface.tilt_deg, (numerics::Vec3<double>{0, 4, -90}));
}

TEST(Reader, TakesMediaByNameAndInline) {
  const Model model = model_of(R"(sagitta: 1
wavelengths_nm: [587.5618]
aperture: {stop_diameter_mm: 4}
surfaces:
  - {stop: true, thickness_mm: 1, medium: {index: 1.376}}
  - {thickness_mm: 1, medium: {nd: 1.5168, vd: 64.17}}
  - {thickness_mm: 1, medium: N-BK7}
  - {thickness_mm: 1, medium: air}
  - {thickness_mm: 1}
  - {}
)");
  const auto index_after = [&](std::size_t i) { return model.surfaces[i].medium->index(0.5875618); };
  EXPECT_EQ(index_after(0), 1.376);
  EXPECT_NEAR(index_after(1), 1.5168, 1e-15);
  EXPECT_NEAR(index_after(2), 1.5168, 1e-5);  // the catalogue's nd has five decimals
  EXPECT_EQ(index_after(3), 1);
  EXPECT_EQ(index_after(4), 1);
}

TEST(Reader, CountsZernikeTermsByTheirIndexing) {
  const std::string head = "zernike: {normalization_radius_mm: 3, coefficients_um: ";
  using Terms = std::vector<std::pair<int, double>>;
  const auto terms = [&](const std::string& rest) {
    return model_of(system_with(pupil, "", head + rest + "}")).surfaces[0].shape.parameters.list("coefficients_um");
  };
  EXPECT_EQ(terms("[0.5, -1, 2], indexing: osa"), (Terms{{0, 0.5}, {1, -1}, {2, 2}}));
  EXPECT_EQ(terms("[0.5, -1, 2], indexing: noll"), (Terms{{1, 0.5}, {2, -1}, {3, 2}}));
  EXPECT_EQ(terms("[0.5], indexing: fringe"), (Terms{{1, 0.5}}));
  EXPECT_EQ(terms("{12: 1e-3, 4: 2}, indexing: osa"), (Terms{{4, 2}, {12, 1e-3}}));
  EXPECT_EQ(terms("{}, indexing: osa"), Terms{});
  const Model model = model_of(system_with(pupil, "", head + "[], indexing: osa}"));
  EXPECT_EQ(model.surfaces[0].shape.parameters.number("radius_mm"), infinity);
  EXPECT_EQ(model.surfaces[0].shape.parameters.number("conic_constant"), 0);
  EXPECT_EQ(model.surfaces[0].shape.parameters.text("indexing"), "osa");
}

TEST(Reader, ReadsAspheresBiconicsToroidsAndPolynomials) {
  using Terms = std::vector<std::pair<int, double>>;
  const auto read = [](const std::string& text) { return model_of(system_with(pupil, "", text)).surfaces[0].shape; };
  const auto asphere = read("asphere: {radius_mm: -8, coefficients: {4: 1e-4, 2: -0.001, 5: 3}}");
  EXPECT_EQ(asphere.kind, "asphere");
  EXPECT_EQ(asphere.parameters.number("radius_mm"), -8);
  EXPECT_EQ(asphere.parameters.number("conic_constant"), 0);
  EXPECT_EQ(asphere.parameters.list("coefficients"), (Terms{{2, -.001}, {4, 1e-4}, {5, 3}}));
  const auto biconic = read("biconic: {radius_x_mm: .inf, radius_y_mm: 7.7, conic_constant_y: -0.2}");
  EXPECT_EQ(biconic.parameters.number("radius_x_mm"), infinity);
  EXPECT_EQ(biconic.parameters.number("radius_y_mm"), 7.7);
  EXPECT_EQ(biconic.parameters.number("conic_constant_x"), 0);
  EXPECT_EQ(biconic.parameters.number("conic_constant_y"), -.2);
  const auto toroid = read("toroid: {radius_rotation_mm: -50, radius_mm: 40, conic_constant: -0.5, coefficients: {2: 5e-5}}");
  EXPECT_EQ(toroid.parameters.number("radius_rotation_mm"), -50);
  EXPECT_EQ(toroid.parameters.list("coefficients"), (Terms{{2, 5e-5}}));
  const auto polynomial = read("xy_polynomial: {coefficients: [0.1, 0.2, 0.3]}");
  EXPECT_EQ(polynomial.parameters.number("radius_mm"), infinity);
  EXPECT_EQ(polynomial.parameters.number("normalization_radius_mm"), 1);
  EXPECT_EQ(polynomial.parameters.list("coefficients"), (Terms{{1, .1}, {2, .2}, {3, .3}}));
}

TEST(Reader, FindsThePointsBesideThePrescriptionThenInTheDataFolder) {
  const std::string shape = "delaunay: {points: cornea.xyz}";
  const std::string near = "0 0 0\n1 0 0\n0 1 0\n", far = "0 0 5\n1 0 5\n0 1 5\n1 1 5\n";
  const test::TemporaryFolder beside, data;
  const std::string file = beside.write("system.yaml", system_with(pupil, "", shape));
  data.write("cornea.xyz", far);
  ::unsetenv("SAGITTA_DATA");
  EXPECT_FALSE(read_prescription(file).model);
  ::setenv("SAGITTA_DATA", data.path().c_str(), 1);
  const ReadResult from_data = read_prescription(file);
  beside.write("cornea.xyz", near);
  const ReadResult from_beside = read_prescription(file);
  ::unsetenv("SAGITTA_DATA");
  ASSERT_TRUE(from_data.model) << test::text_of(from_data.findings);
  EXPECT_EQ(from_data.model->surfaces[0].shape.cloud->points.size(), 4u);
  ASSERT_TRUE(from_beside.model);
  const Shape& cornea = from_beside.model->surfaces[0].shape;
  EXPECT_EQ(cornea.cloud->points.size(), 3u);
  EXPECT_EQ(cornea.parameters.text("format"), "xyz");
  EXPECT_EQ(cornea.parameters.text("interpolation"), "c1");
  EXPECT_EQ(cornea.parameters.number("max_edge_mm"), infinity);
}

TEST(Reader, TurnsPointsWithOsaAxes) {
  const test::TemporaryFolder folder;
  folder.write("cornea.xyz", "1 2 3\n4 5 6\n7 9 9\n");
  const auto first_point = [&](const std::string& axes) {
    const ReadResult result = read_prescription(
        folder.write("system.yaml", system_with(pupil, "", "delaunay: {points: cornea.xyz, axes: " + axes + "}")));
    return result.model ? result.model->surfaces[0].shape.cloud->points[0] : numerics::Vec3<double>{};
  };
  EXPECT_EQ(first_point("local"), (numerics::Vec3<double>{1, 2, 3}));
  EXPECT_EQ(first_point("osa"), (numerics::Vec3<double>{-1, 2, 3}));
}

TEST(Reader, ReadsTextsAsOneLine) {
  const Model model = model_of(system_with(pupil, "name: |\n  two\n  lines\nsource: 1999\n"));
  EXPECT_EQ(model.name, "two lines");
  EXPECT_EQ(model.source, "1999");
}

TEST(Reader, TakesAliases) {
  const Model model = model_of(R"(sagitta: 1
wavelengths_nm: [543]
aperture: {stop_diameter_mm: 4}
surfaces:
  - &lens {conic: {radius_mm: 10}, thickness_mm: 1, medium: {index: 1.5}}
  - *lens
  - {stop: true, thickness_mm: 1}
  - {}
)");
  ASSERT_EQ(model.surfaces.size(), 4u);
  EXPECT_EQ(model.surfaces[1].shape.parameters.number("radius_mm"), 10);
}

TEST(Keys, AreNamedOnceInEachTable) {
  std::vector<KeyTable> tables{system_keys, aperture_section_keys, field_keys, object_keys, surface_keys, medium_keys};
  for (const ShapeKind& kind : shape_kinds()) tables.push_back(kind.keys);
  EXPECT_GE(tables.size(), 10u);
  for (const KeyTable& table : tables)
    for (std::size_t i = 0; i < table.size(); ++i) {
      EXPECT_FALSE(table[i].meaning.empty()) << table[i].name;
      for (std::size_t j = 0; j < i; ++j) EXPECT_NE(table[i].name, table[j].name);
    }
}

// Once of a medium, however often it is used; what disperses as another is extrapolated with it.
TEST(Reader, WarnsWhereAFormulaIsExtrapolated) {
  const auto told = [](const std::string& wavelengths, const std::string& medium) {
    return test::text_of(test::read_text("sagitta: 1\nwavelengths_nm: [" + wavelengths + "]\naperture: {entrance_pupil_diameter_mm: 4}\nsurfaces:\n  - {stop: true, thickness_mm: 20, medium: " + medium +
                                         "}\n  - {thickness_mm: 20, medium: " + medium + "}\n  - {}\n").findings);
  };
  const std::string glass = "{nd: 1.5, vd: 60}", shifted = "{index: 1.4, reference_nm: 550, dispersion: " + glass + "}";
  EXPECT_EQ(told("380, 550, 780", glass), "");
  EXPECT_EQ(told("379, 780.1", "{index: 1.5}"), "");
  const std::string warning = told("379, 550, 780.1", glass);
  EXPECT_NE(warning.find(":5:44: warning: nd 1.5 vd 60 is meant for visible light, 380 to 780 nm, and extrapolated at 379, 780.1 nm\n  hint: "), std::string::npos) << warning;
  EXPECT_EQ(warning.find("warning", warning.find("warning") + 1), std::string::npos) << warning;
  EXPECT_NE(told("1064, 550", shifted).find("dispersing as nd 1.5 vd 60 is meant for visible light, 380 to 780 nm, and extrapolated at 1064 nm\n"), std::string::npos) << told("1064, 550", shifted);
}

}  // namespace
}  // namespace sagitta::prescription
