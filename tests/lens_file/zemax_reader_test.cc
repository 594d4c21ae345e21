// SPDX-License-Identifier: Apache-2.0
// What the operands of Zemax files become. Rays of whole lenses are in tests/commands/import_command_test.cc.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <array>
#include <cmath>

#include "tests/lens_file/support.h"

namespace sagitta::lens_file::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

TEST(ZemaxFile, becomes_a_prescription_that_reads_as_if_written_by_hand) {
  const Outcome run = import_text("lens.zmx", zemax("ENPD 1.0E+1\nFTYP 0 0 2 3 0 0 0\nXFLN 0 0 0 0 0 0 0 0 0 0 0 0\nYFLN 0 7.5 0 0 0 0 0 0 0 0 0 0\nWAVM 1 4.861327E-1 1\nWAVM 2 5.875618E-1 1\nWAVM 3 6.562725E-1 1\nWAVM 4 5.5E-1 1\n",
      zemax_surface(0, "TYPE STANDARD\nCURV 0.0\nDISZ INFINITY") +
      zemax_surface(1, "STOP\nCOMM front, first\nTYPE STANDARD\nCURV 2.000000000000000000E-002 0 0 0 0 \"\"\nDISZ 4.0\nGLAS N-BK7 0 0 1.5 4.0E+1 0 0 0 0 0 0 \nDIAM 7.6 1 0 0 1 \"\"\nFLAP 0 7.6 0") +
      zemax_surface(2, "COMM back\nTYPE STANDARD\nCURV -1.250000000000000000E-002\nCONI -5.0E-1\nDISZ 6.0E+1\nMAZH 0 0\nDIAM 7.5 0 0 0 1 \"\"") + zemax_surface(3, "TYPE STANDARD\nCURV 0.0\nDISZ 0\nDIAM 1 0 0 0 1 \"\"")));
  EXPECT_EQ(run.messages, "");
  EXPECT_EQ(run.prescription, R"yaml(# Test lens.
# Source: lens.zmx, a Zemax lens file (VERS 140730 201 26155), by sagitta import.
# What clips rays in it is an aperture that was set, not the size that a surface is drawn with. Its glasses are of SCHOTT MISC.
sagitta: 1
name: Test lens
source: "lens.zmx, a Zemax lens file (VERS 140730 201 26155)"
wavelengths_nm: [486.1327, 587.5618, 656.2725]
aperture: {entrance_pupil_diameter_mm: 10}
fields: {angles_deg: [[0, 0], [0, 7.5]]}
surfaces:
  - {name: "front, first", stop: true, conic: {radius_mm: 50}, thickness_mm: 4, medium: N-BK7, semi_diameter_mm: 7.6}
  - {name: back, conic: {radius_mm: -80, conic_constant: -0.5}, thickness_mm: 60}
  - {name: image}
)yaml");
}

// 2026-11-23: MEMA, OEMA, OMMA, DBDT, SSID, LUID, EERA, IWDP, AUTH and IGNR 0, which every file of later versions has, were refused as not known.
TEST(ZemaxFile, may_be_of_any_version) {
  const std::string text = zemax_with("TYPE STANDARD\nCURV 0.05\nDISZ 5\nGLAS N-BK7 0 0 1.5168 64.17 0 0 0 0 0 0", "TYPE STANDARD\nCURV 0\nDISZ 5");
  std::string later = text;
  later.replace(0, later.find("MODE"), "VERS 231205 2763 20120530 20120530\nDBDT 0 38398 1.000E+10 0.000E+00\nDBDT 1 0 1 0 0 0 0\n\nAUTH \n\nIWDP 0\n");
  later.insert(later.find("ROPD"), "OMMA 1 1\n");
  for (std::size_t at = 0; (at = later.find("  HIDE", at)) != std::string::npos; at = later.find("  SLAB", at))
    later.insert(at, "  FIMP \n\n  SSID 1\n  LUID 1\n  EERA 0\n  IGNR 0\n  OEMA 0.5 0 0 0 0 \"\"\n  MEMA 6.25 0 0 0 1 \"\"\n");
  later.replace(later.find("FTYP 0 0 1 1 0 0 0"), 18, "FTYP 0 0 1 1 0 0 0 1");
  const Outcome run = import_text("lens.zmx", later);
  EXPECT_EQ(run.messages, "");
  EXPECT_EQ(run.prescription.substr(run.prescription.find("wavelengths_nm")), [&] { const std::string older = import_text("lens.zmx", text).prescription; return older.substr(older.find("wavelengths_nm")); }());
}

// 2026-11-23: all but IGNR were passed over in silence.
TEST(ZemaxFile, tells_what_changes_rays_beyond_its_surfaces) {
  struct Case {
    const char *line, *by, *expected;
  };
  for (const auto& [line, by, expected] : {Case{"GFAC 0 0", "GFAC 1 1", "8:1: error: GFAC: an apodized pupil"}, Case{"FTYP 0 0 1 1 0 0 0", "FTYP 0 0 1 1 0 0 1 1", "16:18: error: FTYP: an image space that is afocal"},
                                           Case{"SLAB", "IGNR 1", "33:3: error: IGNR: a surface that is ignored, and stands here"},
                                           Case{"GLAS N-BK7 0 0 1.5", "GLAS N-BK7 4 0 0.01", "48:14: error: GLAS: an offset from the index of a glass"},
                                           Case{"GLAS N-BK7 0 0 1.5", "GLAS N-BK7 5 0 1.5", "48:14: error: GLAS: what solve 5 is, is not known"},
                                           Case{"GLAS N-BK7 0 0 1.5", "GLAS N-BK7 3 0 1.5", "48:14: warning: GLAS: a glass that optimisation may substitute is taken as the one that is named"}}) {
    std::string text = zemax_with("TYPE STANDARD\nCURV 0.05\nDISZ 5\nGLAS N-BK7 0 0 1.5 40", "TYPE STANDARD\nCURV 0\nDISZ 5");
    EXPECT_EQ(import_text("lens.zmx", text).messages, "");
    EXPECT_THAT(import_text("lens.zmx", text.replace(text.find(line), std::string(line).size(), by)).messages, HasSubstr(std::string("lens.zmx:") + expected)) << by;
  }
}

TEST(ZemaxFile, may_be_in_any_encoding) {
  const std::string text = zemax_with("TYPE STANDARD\nCURV 0.1\nDISZ 5");
  const std::string expected = import_text("lens.zmx", text).prescription;
  EXPECT_THAT(expected, HasSubstr("radius_mm: 10"));
  for (const std::string& bytes : {in_utf_16(text, true), in_utf_16(text, false), "\xEF\xBB\xBF" + text}) EXPECT_EQ(import_text("lens.zmx", bytes).prescription, expected);
  std::string with_crlf;
  for (const char c : text) with_crlf += c == '\n' ? "\r\n" : std::string{c};
  EXPECT_EQ(import_text("LENS.ZMX", with_crlf).prescription.substr(60), import_text("LENS.ZMX", text).prescription.substr(60));
  const std::string latin_1 = zemax_with("COMM \xD8 5 mm\nTYPE STANDARD\nCURV 0.1\nDISZ 5");
  EXPECT_THAT(import_text("lens.zmx", latin_1).prescription, HasSubstr("name: \"\xC3\x98 5 mm\""));
}

TEST(ZemaxFile, has_lengths_in_its_unit) {
  std::string text = zemax_with("TYPE EVENASPH\nCURV 2.0\nPARM 2 0.1\nDISZ 0.1\nCLAP 0 0.3 0", "TYPE COORDBRK\nPARM 1 0.7\nPARM 3 5\nDISZ 0.2", "TYPE STANDARD\nCURV 0\nDISZ 1", "TYPE SZERNSAG\nCURV 0\nDISZ 1\nXDAT 1 4\nXDAT 2 2\nXDAT 6 1.0E-6");
  text.replace(text.find("UNIT MM"), 7, "UNIT IN");
  const Outcome run = import_text("lens.zmx", text);
  EXPECT_THAT(run.prescription, HasSubstr("Its lengths in inches are converted to mm."));
  EXPECT_THAT(run.prescription, HasSubstr("entrance_pupil_diameter_mm: 101.6"));
  EXPECT_THAT(run.prescription, HasSubstr("{stop: true, thickness_mm: 25.4}"));
  EXPECT_THAT(run.prescription, HasSubstr("asphere: {radius_mm: 12.7, coefficients: {4: 6.1"));
  const auto read = prescription::test::read_text(run.prescription);
  ASSERT_TRUE(read.model.has_value());
  const auto& surfaces = read.model->surfaces;
  ASSERT_EQ(surfaces.size(), 5u);
  EXPECT_DOUBLE_EQ(at(surfaces[1], "coefficients", 4), 0.1 / (25.4 * 25.4 * 25.4));
  EXPECT_EQ(surfaces[1].semi_diameter_mm, 7.62);
  EXPECT_EQ(surfaces[1].thickness_mm, 7.62);  // with that of the coordinate break
  EXPECT_EQ(surfaces[2].decenter_mm.x, 17.78);
  EXPECT_EQ(surfaces[2].tilt_deg.x, 5);
  EXPECT_EQ(surfaces[3].shape.parameters.number("normalization_radius_mm"), 50.8);
  EXPECT_DOUBLE_EQ(at(surfaces[3], "coefficients_um", 4), 0.0254);
}

TEST(ZemaxShape, of_every_type_that_is_known) {
  struct Case {
    const char *lines, *expected;
  };
  for (const auto& [lines, expected] : {
           Case{"TYPE STANDARD\nCURV 0.05\nCONI -1", "conic: {radius_mm: 20, conic_constant: -1}"},
           Case{"TYPE STANDARD\nCURV 0\nCONI -1\nGLAS MIRROR 0 0 1.5 4.0E+1", "plane: {}"},
           // PARM 1 is the r^2 coefficient
           Case{"TYPE EVENASPH\nCURV 0.05\nPARM 1 1.0E-3\nPARM 2 2.0E-5\nPARM 8 -3.0E-20", "asphere: {radius_mm: 20, coefficients: {2: 0.001, 4: 2e-05, 16: -3e-20}}"},
           Case{"TYPE EVENASPH\nCURV 0\nPARM 3 1.0E-3", "asphere: {radius_mm: .inf, coefficients: {6: 0.001}}"},
           Case{"TYPE EVENASPH\nCURV 0.05\nPARM 1 0\nPARM 2 0", "conic: {radius_mm: 20}"},
           Case{"TYPE ODDASPHE\nCURV 0.05\nCONI 1\nPARM 2 1.0E-3\nPARM 3 2.0E-4\nPARM 8 3.0E-8", "asphere: {radius_mm: 20, conic_constant: 1, coefficients: {2: 0.001, 3: 0.0002, 8: 3e-08}}"},
           // PARM 1 is the x radius, 0 a plane
           Case{"TYPE BICONICX\nCURV 0.05\nCONI -0.5\nPARM 1 25\nPARM 2 -0.7", "biconic: {radius_x_mm: 25, radius_y_mm: 20, conic_constant_x: -0.7, conic_constant_y: -0.5}"},
           Case{"TYPE BICONICX\nCURV 0.05\nPARM 1 0", "biconic: {radius_x_mm: .inf, radius_y_mm: 20}"},
           Case{"TYPE TOROIDAL\nCURV 0.02\nCONI -0.5\nPARM 1 100\nPARM 2 0.05\nPARM 3 0.0002", "toroid: {radius_rotation_mm: 100, radius_mm: 50, conic_constant: -0.5, coefficients: {2: 0.05, 4: 0.0002}}"},
           Case{"TYPE TOROIDAL\nCURV 0.02\nPARM 1 0\nXDAT 1 0 0 0 1.0 0 0\nXDAT 2 0 0 0 1.0 0 0", "toroid: {radius_rotation_mm: .inf, radius_mm: 50}"},
           Case{"TYPE XPOLYNOM\nCURV 0.02\nXDAT 1 5\nXDAT 2 10\nXDAT 5 1.0E-2\nXDAT 7 -2.0E-2", "xy_polynomial: {radius_mm: 50, normalization_radius_mm: 10, coefficients: {3: 0.01, 5: -0.02}}"},
           // XDAT 1 is the number of terms, XDAT 2 the radius of normalisation, coefficients are lens units
           Case{"TYPE SZERNSAG\nCURV 0.02\nXDAT 1 11 0 0 1.0 0 0 \"\"\nXDAT 2 3 0 0 1.0 0 0 \"\"\nXDAT 6 1.0E-3 0 0 1.0 0 0 \"\"\nXDAT 13 -2.0E-4",
                "zernike: {radius_mm: 50, normalization_radius_mm: 3, indexing: noll, coefficients_um: {4: 1, 11: -0.2}}"},
           Case{"TYPE FZERNSAG\nCURV 0\nXDAT 1 37\nXDAT 2 3\nXDAT 11 1.0E-3\nXDAT 39 5.0E-4", "zernike: {radius_mm: .inf, normalization_radius_mm: 3, indexing: fringe, coefficients_um: {9: 1, 37: 0.5}}"},
           Case{"TYPE GRINSUR3\nCURV 0.05\nPARM 1 1.0\nPARM 2 1.368\nPARM 3 -0.001978\nPARM 4 1.0E-5\nPARM 6 0.049057\nPARM 7 -0.015427\nPARM 8 1.0E-6",
                "medium: {grin: {polynomial: {index: 1.368, z_coefficients: {1: 0.049057, 2: -0.015427, 3: 1e-06}, r_coefficients: {2: -0.001978, 4: 1e-05}}}}"},
           Case{"TYPE GRINSUR1\nCURV 0\nPARM 1 0.1\nPARM 2 1.5\nPARM 3 -0.002", "medium: {grin: {polynomial: {index: 1.5, r_coefficients: {2: -0.002}}}}"}}) {
    const Outcome run = import_text("lens.zmx", zemax_with(std::string(lines) + "\nDISZ 5", "TYPE STANDARD\nCURV 0\nDISZ 5"));
    EXPECT_THAT(run.prescription, HasSubstr(expected)) << run.messages;
    EXPECT_THAT(run.messages, Not(HasSubstr("error")));
  }
}

// OpticStudio's help: "If the extrapolate flag is set to 0, the Zernike terms are ignored outside of the normalization radius."
// 2026-11-23: PARM 0 1, which is what `zernike` does, was refused, and PARM 0 0 was taken as it without a word.
TEST(ZemaxShape, of_Zernike_terms_may_end_at_the_radius_of_normalisation) {
  struct Case {
    const char *lines, *expected;
  };
  const std::string ends = "PARM 0 of SZERNSAG: the terms end at the radius of normalisation, 76.2 mm, and go on here; ";
  for (const auto& [lines, expected] : {Case{"PARM 0 1", ""}, Case{"PARM 0 1\nDIAM 9", ""}, Case{"", ""}, Case{"DIAM 9", ""}, Case{"PARM 0 0\nDIAM 3", ""}, Case{"PARM 0 0\nDIAM 9\nCLAP 0 3 0", ""},
                                        Case{"PARM 0 0", "how far the surface reaches is not known"}, Case{"PARM 0 0\nDIAM 0", "how far the surface reaches is not known"},
                                        Case{"PARM 0 0\nDIAM 4", "the surface reaches to 101.6 mm"}, Case{"PARM 0 0\nDIAM 1\nCLAP 0 4 0", "the surface reaches to 101.6 mm"},
                                        Case{"PARM 0 0\nDIAM 4\nOBSC 0 1 0", "the surface reaches to 101.6 mm"}}) {
    std::string text = zemax_with("TYPE SZERNSAG\nCURV 0.02\nDISZ 5\nXDAT 1 11\nXDAT 2 3\nXDAT 13 1.0E-3\n" + std::string(lines), "TYPE STANDARD\nCURV 0\nDISZ 5");
    const Outcome run = import_text("lens.zmx", text.replace(text.find("UNIT MM"), 7, "UNIT IN"));
    EXPECT_NE(run.prescription, "") << run.messages;
    if (*expected == '\0') EXPECT_EQ(run.messages, "") << lines;
    else EXPECT_THAT(run.messages, HasSubstr("lens.zmx:51:10: warning: " + ends + expected)) << lines;
  }
  EXPECT_THAT(import_text("lens.zmx", zemax_with("TYPE FZERNSAG\nCURV 0.02\nDISZ 5\nXDAT 1 11\nXDAT 2 3\nXDAT 13 1.0E-3\nPARM 0 2")).messages, HasSubstr("error: PARM 0 of FZERNSAG is neither 0 nor 1"));
  EXPECT_EQ(import_text("lens.zmx", zemax_with("TYPE FZERNSAG\nCURV 0.02\nDISZ 5\nXDAT 1 11\nXDAT 2 3\nPARM 0 0")).messages, "");
}

TEST(ZemaxGlass, is_a_medium_a_model_or_a_mirror) {
  const auto with = [](const std::string& glass) { return import_text("lens.zmx", zemax_with("TYPE STANDARD\nCURV 0.05\nDISZ 5\nGLAS " + glass, "TYPE STANDARD\nCURV 0\nDISZ 5")); };
  EXPECT_THAT(with("N-BK7 0 0 1.5 4.0E+1 0 0 0 0 0 0").prescription, HasSubstr("medium: N-BK7}"));
  EXPECT_THAT(with("MIRROR 0 0 1.5 4.0E+1 0").prescription, HasSubstr("medium: mirror}"));
  const Outcome model = with("___BLANK 1 0 1.5168 6.417E+1 0 0 0 0 0 0");
  EXPECT_THAT(model.prescription, HasSubstr("medium: {nd: 1.5168, vd: 64.17}}"));
  EXPECT_THAT(model.prescription, HasSubstr("two-term formulas through nd and Vd here"));
  EXPECT_THAT(with("___BLANK 1 0 1.3777 0 0 0 0").prescription, HasSubstr("medium: {index: 1.3777}}"));
  EXPECT_THAT(with("___BLANK 1 0 1 0 0 0 0").prescription, HasSubstr("{conic: {radius_mm: 20}, thickness_mm: 5}"));
  const Outcome water = with("WATER 0 0 1.5 40");
  EXPECT_THAT(water.prescription, HasSubstr("medium: water}"));
  EXPECT_THAT(water.messages, HasSubstr("warning: 'WATER' is taken as water, whose formula may be of another source"));
}

// 2026-11-23: a glass of the same name of another maker was taken without a word.
TEST(ZemaxGlass, is_compared_with_what_the_file_says_of_it) {
  const auto with = [](const std::string& glass, const std::string& catalogs) {
    std::string text = zemax_with("TYPE STANDARD\nCURV 0.05\nDISZ 5\nGLAS " + glass, "TYPE STANDARD\nCURV 0\nDISZ 5");
    return import_text("lens.zmx", text.replace(text.find("GCAT SCHOTT MISC"), 16, "GCAT " + catalogs)).messages;
  };
  const std::string hint = "\n  hint: if it is another maker's, --catalog FILE.agf takes it from that catalogue\n";
  EXPECT_EQ(with("F5 0 0 1.624353 35.938 0 0 0 0 0 0", "CDGM"), "lens.zmx:48:3: warning: 'F5' has nd 1.60342 and Vd 38.03 here, where the file has 1.624353 and 35.938" + hint);
  EXPECT_EQ(with("F5 0 0 1.6034 40", "SCHOTT"), "lens.zmx:48:3: warning: 'F5' has nd 1.60342 and Vd 38.03 here, where the file has 1.6034 and 40" + hint);
  EXPECT_EQ(with("F5", "CDGM MISC"), "lens.zmx:48:3: warning: 'F5' is taken from another maker than the catalogues of the file, CDGM MISC\n  hint: --catalog FILE.agf takes it from a catalogue\n");
  EXPECT_EQ(with("F5 0 0 1.5 40 0 0 0 0 0 0", "CDGM").substr(0, 46), "lens.zmx:48:3: warning: 'F5' is taken from ano");
  for (const char* same : {"F5", "F5 0 0 1.603420 38.03", "F5 0 0 1.6 38", "F5 0 0 1.5 40", "F5 0 0 1 0", "F5 0 0 0 0"}) EXPECT_EQ(with(same, "CDGM SCHOTT"), "") << same;
  EXPECT_EQ(with("F5 0 0 1.60342 38.03", "CDGM"), "");
}

TEST(ZemaxAperture, is_told_in_one_of_four_ways) {
  const auto with = [](const std::string& aperture) {
    std::string text = zemax_with("TYPE STANDARD\nCURV 0.05\nDISZ 5");
    return import_text("lens.zmx", text.replace(text.find("ENPD 4.0E+0"), 11, aperture)).prescription;
  };
  EXPECT_THAT(with("ENPD 3"), HasSubstr("aperture: {entrance_pupil_diameter_mm: 3}"));
  EXPECT_THAT(with("FNUM 2.1 0"), HasSubstr("aperture: {image_f_number: 2.1}"));
  EXPECT_THAT(with("ENPD 3\nRAIM 0 2 1"), HasSubstr("aperture: {entrance_pupil_diameter_mm: 3, aim: stop}"));
  const auto of_fields = [&](const std::string& kind) {
    std::string text = zemax_with("TYPE STANDARD\nCURV 0.05\nDISZ 5");
    return import_text("lens.zmx", text.replace(text.find("FTYP 0"), 6, "FTYP " + kind).replace(text.find("YFLN 0"), 6, "YFLN 8")).prescription;
  };
  EXPECT_THAT(of_fields("2"), HasSubstr("fields: {paraxial_image_heights_mm: [[0, 8]]}"));
  EXPECT_THAT(of_fields("3"), HasSubstr("fields: {real_image_heights_mm: [[0, 8]]}"));
  // FLOA: the semi-diameter of the stop; its beam is not clipped there as well
  std::string text = zemax_with("TYPE STANDARD\nCURV 0.05\nDISZ 5\nFLAP 0 1.5 0");
  text.replace(text.find("ENPD 4.0E+0"), 11, "FLOA");
  text.insert(text.find("STOP\n") + 5, "  DIAM 1.5 1 0 0 1 \"\"\n  FLAP 0 1.5 0\n");
  const std::string floating = import_text("lens.zmx", text).prescription;
  EXPECT_THAT(floating, HasSubstr("aperture: {stop_diameter_mm: 3}"));
  EXPECT_THAT(floating, HasSubstr("{stop: true, thickness_mm: 1}"));
  EXPECT_THAT(floating, HasSubstr("thickness_mm: 5, semi_diameter_mm: 1.5}"));
  text = zemax_with("TYPE STANDARD\nCURV 0.05\nDISZ 5");
  text.replace(text.find("ENPD 4.0E+0"), 11, "OBNA 1.5E-1 0").replace(text.find("FTYP 0"), 6, "FTYP 1").replace(text.find("DISZ INFINITY"), 13, "DISZ 1.0E+2");
  text.replace(text.find("YFLN 0"), 6, "YFLN 8");
  const std::string finite = import_text("lens.zmx", text).prescription;
  EXPECT_THAT(finite, HasSubstr("aperture: {object_na: 0.15}\nfields: {object_heights_mm: [[0, 8]]}\nobject: {distance_mm: 100}\n"));
}

TEST(ZemaxAperture, of_a_surface_clips_where_it_was_set) {
  const auto with = [](const std::string& lines) { return import_text("lens.zmx", zemax_with("TYPE STANDARD\nCURV 0.05\nDISZ 5\n" + lines)).prescription; };
  EXPECT_THAT(with("DIAM 7.6 1 0 0 1 \"\""), HasSubstr("thickness_mm: 5}"));
  EXPECT_THAT(with("CLAP 0.5 7.6 0"), HasSubstr("thickness_mm: 5, semi_diameter_mm: 7.6, inner_semi_diameter_mm: 0.5}"));
  EXPECT_THAT(with("CLAP 0.5 INF 0"), HasSubstr("thickness_mm: 5, inner_semi_diameter_mm: 0.5}"));
  EXPECT_THAT(with("OBSC 0 2.5 0\nOBDC 0 0"), HasSubstr("thickness_mm: 5, inner_semi_diameter_mm: 2.5}"));
}

// A tilted and decentered lens as OpticStudio's tool makes it: the break, the lens, a surface that goes back, the inverse break, the way on.
TEST(ZemaxCoordinateBreaks, around_an_element_are_its_decenter_and_tilt) {
  const auto model = model_of("lens.zmx", zemax_with("TYPE COORDBRK\nPARM 1 0.3\nPARM 2 -1.7\nPARM 3 10\nPARM 4 -20\nPARM 5 33.3\nDISZ 0", "TYPE STANDARD\nCURV 0.02\nDISZ 5.6\nGLAS N-BK7",
      "TYPE STANDARD\nCURV -0.02\nDISZ -5.6", "TYPE COORDBRK\nPARM 1 -0.3\nPARM 2 1.7\nPARM 3 -10\nPARM 4 20\nPARM 5 -33.3\nPARM 6 1\nDISZ 5.6", "TYPE STANDARD\nCURV 0\nDISZ 44"));
  using numerics::Vec3;
  ASSERT_EQ(model.surfaces.size(), 5u);
  EXPECT_EQ(model.surfaces[1].decenter_mm, (Vec3<double>{0.3, -1.7, 0}));
  EXPECT_EQ(model.surfaces[1].tilt_deg, (Vec3<double>{10, -20, 33.3}));
  EXPECT_EQ(model.surfaces[1].thickness_mm, 5.6);
  EXPECT_EQ(model.surfaces[2].thickness_mm, 0);
  for (const std::size_t i : {0, 3, 4}) {
    EXPECT_EQ(model.surfaces[i].decenter_mm, Vec3<double>{});
    EXPECT_EQ(model.surfaces[i].tilt_deg, Vec3<double>{});
  }
}

// The axis goes along +y behind a mirror that turns +y toward +z by 45 degrees.
TEST(ZemaxCoordinateBreaks, turn_right_handed) {
  const auto model = model_of("lens.zmx", zemax_with("TYPE COORDBRK\nPARM 3 45\nDISZ 0", "TYPE STANDARD\nCURV 0\nDISZ 0\nGLAS MIRROR", "TYPE COORDBRK\nPARM 3 45\nDISZ -30", "TYPE STANDARD\nCURV 0\nDISZ -2"));
  using numerics::Vec3;
  EXPECT_EQ(model.surfaces[1].tilt_deg, (Vec3<double>{45, 0, 0}));
  EXPECT_EQ(model.surfaces[1].thickness_mm, -30);
  EXPECT_EQ(model.surfaces[2].tilt_deg, (Vec3<double>{90, 0, 0}));
  EXPECT_EQ(model.surfaces[2].decenter_mm, (Vec3<double>{0, 30, 30}));
  EXPECT_EQ(model.surfaces[3].decenter_mm, (Vec3<double>{0, 32, 32}));
}

// z = x/64 + y/16 on 5 x 6 nodes, row by row from the top, on a sphere: as no other order of the rows would have it. What comes beside the prescription is found there.
TEST(ZemaxFile, has_heights_on_a_grid) {
  std::string lines = "TYPE GRID_SAG\nCURV 0.05\nCONI -0.5\nDISZ 5\nPARM 0 0\nPARM 9 0.3\nXDAT 1 8\nXDAT 2 1.5\nGDAT 5 6 -0.5 2.5E-1 0 0 0\n";
  int number = 0;
  for (const double y : {0.625, 0.375, 0.125, -0.125, -0.375, -0.625})
    for (const double x : {-1.0, -0.5, 0.0, 0.5, 1.0}) lines += fmt::format("GARR {} {} {} {} {}\n", number++, x / 64 + y / 16, 0.015625, 0.0625, x == 1 ? 0.25 : 0.0);
  const prescription::test::TemporaryFolder folder;
  for (const char* output : {"out.yaml", "my \xC3\xB6ut.yaml"}) {
    const Imported imported = import({folder.write("lens.zmx", zemax_with(lines)), folder.path() + "/" + output, {}, false});
    ASSERT_TRUE(imported.prescription.has_value()) << prescription::test::text_of(imported.findings);
    EXPECT_THAT(prescription::test::text_of(imported.findings), HasSubstr("lens.zmx:53:3: warning: GARR: its rows are taken to run as"));
    ASSERT_EQ(imported.files.size(), 1u);
    const std::string name = output[0] == 'o' ? "out-2.dat" : "data-2.dat";
    EXPECT_EQ(imported.files[0].path, folder.path() + "/" + name);
    EXPECT_THAT(*imported.prescription, HasSubstr("grid: {points: " + name + ", radius_mm: 20, conic_constant: -0.5}, thickness_mm: 5"));
    EXPECT_THAT(imported.files[0].text, StartsWith("! By sagitta import, from line 53 of a Zemax lens file on.\n5 6 -0.5 0.25 0 0 0\n0.0234375 0.015625 0.0625 0\n"));
    folder.write(name, imported.files[0].text);
    const auto read = prescription::read_prescription(folder.write("out.yaml", *imported.prescription));
    ASSERT_TRUE(read.model.has_value()) << prescription::test::text_of(read.findings);
    const auto& grid = *read.model->surfaces[1].shape.grid;
    ASSERT_EQ(grid.nodes.size(), 30u);
    EXPECT_EQ((std::array{grid.first_x, grid.first_y, grid.spacing_x, grid.spacing_y}), (std::array{-1.0, -0.625, 0.5, 0.25}));
    for (std::size_t i = 0; i < 30; ++i) {
      const double x = -1 + 0.5 * static_cast<double>(i % 5), y = -0.625 + 0.25 * static_cast<double>(i / 5);
      EXPECT_EQ(grid.nodes[i].z, x / 64 + y / 16) << i;
      EXPECT_EQ(grid.nodes[i].dz_dx, 0.015625);
      EXPECT_EQ(grid.nodes[i].dz_dy, 0.0625);
      EXPECT_EQ(grid.nodes[i].d2z_dxdy, x == 1 ? 0.25 : 0);
    }
  }
  // Counted from 1 they are the same.
  std::string from_1 = lines;
  number = 0;
  for (std::size_t at = 0; (at = from_1.find("GARR ", at)) != std::string::npos; at += 5) from_1.replace(at + 5, std::to_string(number).size(), std::to_string(number + 1)), ++number;
  const auto files_of = [&](const std::string& text) { return import({folder.write("lens.zmx", zemax_with(text)), folder.path() + "/out.yaml", {}, false}).files; };
  ASSERT_EQ(files_of(from_1).size(), 1u);
  EXPECT_EQ(files_of(from_1)[0].text, files_of(lines)[0].text);
}

TEST(ZemaxFile, may_go_on_with_what_has_no_optics) {
  const std::string text = zemax_with("TYPE STANDARD\nCURV 0.1\nDISZ 5");
  const Outcome run = import_text("lens.zmx", text + "EFLY 1 43 0 0\nREAY 43 1 0 1\nTOL TOFF\nCRVT 1 0.2\n");
  EXPECT_EQ(run.messages, "lens.zmx:63:1: note: from here on 3 lines are not read: merit function, tolerances and configurations have no optics\n");
  EXPECT_EQ(run.prescription, import_text("lens.zmx", text).prescription);
  // Lines of a surface that are not indented may be optics, and are not passed over.
  EXPECT_NE(import_text("lens.zmx", "UNIT MM\nENPD 2\nWAVL 0.5\nSURF 0\nSURF 1\nSTOP\nCRVT 1\nDISZ 1\nSURF 2\n").messages.find("lens.zmx:7:1: error: CRVT is not known"), std::string::npos);
}

// 2026-11-23: the prescription was written twice with the same wavelength, which its reader refused.
TEST(ZemaxFile, may_repeat_a_wavelength) {
  std::string text = zemax_with("TYPE STANDARD\nCURV 0.1\nDISZ 5");
  text.replace(text.find("FTYP 0 0 1 1"), 12, "FTYP 0 0 1 3");
  text.replace(text.find("PWAV 1"), 6, "PWAV 3");
  const Outcome run = import_text("lens.zmx", text);
  EXPECT_EQ(run.messages, "lens.zmx:21:8: warning: the wavelength 550 nm is repeated; it is taken once\n");
  EXPECT_THAT(run.prescription, HasSubstr("wavelengths_nm: [543, 550]\nprimary_nm: 550\n"));
}

TEST(ZemaxFile, partly_understood_lists_what_is_left_out) {
  const std::string text = zemax_with("TYPE GRID_PHA\nCURV 0.05\nDISZ 5\nGPHA whatever", "TYPE STANDARD\nCURV 0\nDISZ 5\nSQAP 5 5 0");
  const Outcome refused = import_text("lens.zmx", text), partial = import_text("lens.zmx", text, true);
  EXPECT_EQ(refused.prescription, "");
  EXPECT_EQ(partial.left_out_count, 3);
  const std::string list = "# Left out of that file, by line:\n#   45: a surface of type GRID_PHA is not known; its conic (CURV, CONI) stands for it\n#   48: GPHA is not known\n#   57: SQAP: a rectangular aperture\n";
  EXPECT_THAT(partial.prescription, HasSubstr(list));
  EXPECT_THAT(partial.prescription, HasSubstr("{conic: {radius_mm: 20}, thickness_mm: 5}"));
  std::string as_warnings = refused.messages;
  for (std::size_t at; (at = as_warnings.find(": error: ")) != std::string::npos;) as_warnings.replace(at, 9, ": warning: ");
  EXPECT_EQ(partial.messages, as_warnings);
}

}  // namespace
}  // namespace sagitta::lens_file::test
