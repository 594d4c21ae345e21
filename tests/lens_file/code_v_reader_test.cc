// SPDX-License-Identifier: Apache-2.0
// What the commands of CODE V sequences become. Rays of whole lenses are in tests/commands/import_command_test.cc.
#include <gmock/gmock.h>

#include "tests/lens_file/support.h"

namespace sagitta::lens_file::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using numerics::Vec3;

std::string sequence(const std::string& surfaces, const std::string& mode = "RDM") {
  return mode + ";LEN       \"VERSION: 11.2       LENS VERSION: 84\"\nTITLE 'Test lens'\nEPD   4.0\nDIM   M\nWL    656.3 587.6 486.1\nREF   2\nWTW   1 1 1\nINI   ' '\nXAN   0.0 0.0\nYAN   0.0 10.0\n"
         "WTF   1.0 1.0\nVUY   0.0 0.0\nVLY   0.0 0.0\nSO    0.0 0.1e14\n" + surfaces + "GO \n";
}
std::string messages_and(const Outcome& run) { return run.messages + run.prescription; }

TEST(CodeVFile, becomes_a_prescription_that_reads_as_if_written_by_hand) {
  const Outcome run = import_text("lens.seq", sequence("S     50.0 4.0 NBK7_SCHOTT ! the front\n  STO\n  CCY 0; THC 0\n  SLB \"front\"\nS     -80.0 &\n   60.0\n  CON; K -0.5\n  CIR 7.5\n  CIR EDG 8.0\nSI    0.0 -0.25\n"));
  EXPECT_EQ(run.messages, "");
  EXPECT_EQ(run.prescription, R"yaml(# Test lens.
# Source: lens.seq, a CODE V sequence, by sagitta import.
# What clips rays in it is an aperture that was set, not the size that a surface is drawn with.
sagitta: 1
name: Test lens
source: "lens.seq, a CODE V sequence"
wavelengths_nm: [656.3, 587.6, 486.1]
primary_nm: 587.6
aperture: {entrance_pupil_diameter_mm: 4}
fields: {angles_deg: [[0, 0], [0, 10]]}
surfaces:
  - {name: front, stop: true, conic: {radius_mm: 50}, thickness_mm: 4, medium: N-BK7}
  - {conic: {radius_mm: -80, conic_constant: -0.5}, thickness_mm: 59.75, semi_diameter_mm: 7.5}
  - {name: image}
)yaml");
}

// Lengths of fields are in its dimension, as all are; that program's rays pass its stop.
TEST(CodeVFile, may_have_image_heights_and_aims) {
  std::string text = sequence("S 0.5 0.1 NBK7_SCHOTT\nS -2 3\n STO\nSI 0 0\n");
  text.replace(text.find("DIM   M"), 7, "DIM   I").replace(text.find("XAN"), 3, "XRI").replace(text.find("YAN   0.0 10.0"), 14, "YRI   0.0 1.0");
  EXPECT_THAT(import_text("lens.seq", text).prescription, HasSubstr("aperture: {entrance_pupil_diameter_mm: 101.6, aim: stop}\nfields: {real_image_heights_mm: [[0, 0], [0, 25.4]]}\n"));
  text.replace(text.find("XRI"), 3, "XIM").replace(text.find("YRI"), 3, "YIM");
  EXPECT_THAT(import_text("lens.seq", text).prescription, HasSubstr("fields: {paraxial_image_heights_mm: [[0, 0], [0, 25.4]]}\n"));
}

TEST(CodeVFile, gives_curvatures_where_it_says_so) {
  EXPECT_THAT(import_text("lens.seq", sequence("S 0.02 4 NBK7_SCHOTT\nSTO\nS -0.0125 60\nSI 0 0\n", "RDM N")).prescription, HasSubstr("conic: {radius_mm: 50}, thickness_mm: 4"));
  EXPECT_THAT(import_text("lens.seq", sequence("S 0 0; CUY 0.02; THI 4\nSTO\nS 0.1 60; RDY S2 -80\nSI 0 0\nTHI S1 3.5; GLA S1 NBK7_SCHOTT\n", "RDM N")).prescription,
              HasSubstr("  - {stop: true, conic: {radius_mm: 50}, thickness_mm: 3.5, medium: N-BK7}\n  - {conic: {radius_mm: -80}, thickness_mm: 60}\n"));
}

TEST(CodeVFile, has_lengths_in_its_dimension) {
  std::string text = sequence("S 0.5 0.1 NBK7_SCHOTT\n STO; ASP; K -1; A 0.1; B 0\nS -2 3\n CIR 0.3; CIR OBS L'A' 0.1; DAR; YDE 0.7; ADE 5\nSI 0 0\n");
  text.replace(text.find("DIM   M"), 7, "DIM   I");
  const auto model = model_of("lens.seq", text);
  EXPECT_EQ(model.aperture.value, 101.6);
  EXPECT_EQ(model.surfaces[0].shape.parameters.number("radius_mm"), 12.7);
  EXPECT_EQ(model.surfaces[0].thickness_mm, 2.54);
  EXPECT_DOUBLE_EQ(at(model.surfaces[0], "coefficients", 4), 0.1 / (25.4 * 25.4 * 25.4));
  EXPECT_EQ(model.surfaces[1].semi_diameter_mm, 7.62);
  EXPECT_EQ(model.surfaces[1].inner_semi_diameter_mm, 2.54);
  EXPECT_EQ(model.surfaces[1].decenter_mm, (Vec3<double>{0, 17.78, 0}));
  EXPECT_EQ(model.surfaces[1].tilt_deg, (Vec3<double>{-5, 0, 0}));
}

TEST(CodeVAsphere, begins_at_the_fourth_power) {
  const auto model = model_of("lens.seq", sequence("S 50 4\n STO; ASP; K -0.5\n A -1e-4; B 2e-6; C -3e-8; D 4e-10; E 5e-12; F 6e-14; G 7e-16; H 8e-18; J 9e-20\nS 0 3\nSI 0 0\n"));
  EXPECT_EQ(model.surfaces[0].shape.parameters.list("coefficients").size(), 9u);
  EXPECT_EQ(at(model.surfaces[0], "coefficients", 4), -1e-4);
  EXPECT_EQ(at(model.surfaces[0], "coefficients", 6), 2e-6);
  EXPECT_EQ(at(model.surfaces[0], "coefficients", 18), 8e-18);
  EXPECT_EQ(at(model.surfaces[0], "coefficients", 20), 9e-20);
  EXPECT_EQ(model.surfaces[0].shape.parameters.number("conic_constant"), -0.5);
}

TEST(CodeVGlass, is_a_name_with_its_maker_or_a_code) {
  const auto with = [](const std::string& glass) { return import_text("lens.seq", sequence("S 50 4 " + glass + "\nSTO\nS 0 3\nSI 0 0\n")); };
  for (const char* name : {"NSK16_SCHOTT", "N-SK16", "'N-SK16'", "nsk16_schott"}) EXPECT_THAT(messages_and(with(name)), HasSubstr("medium: N-SK16}"));
  EXPECT_THAT(messages_and(with("NSF6HT_SCHOTT")), HasSubstr("medium: N-SF6HT}"));
  EXPECT_THAT(messages_and(with("REFL")), HasSubstr("medium: mirror}"));
  EXPECT_THAT(messages_and(with("AIR")), HasSubstr("thickness_mm: 4}"));
  EXPECT_THAT(messages_and(with("517.642")), HasSubstr("medium: {nd: 1.517, vd: 64.2}}"));
  EXPECT_THAT(messages_and(with("517642")), HasSubstr("medium: {nd: 1.517, vd: 64.2}}"));
  EXPECT_THAT(messages_and(with("516800.6417")), HasSubstr("medium: {nd: 1.5168, vd: 64.17}}"));
  EXPECT_THAT(with("1.517").messages, HasSubstr("lens.seq:15:8: error: '1.517' is neither a glass nor a glass code"));
}

// 2026-11-23: F5_CDGM, whose nd is 1.624353, was taken as Schott's F5, of 1.60342, without a word.
TEST(CodeVGlass, is_not_another_maker_s_of_the_same_name) {
  const prescription::test::TemporaryFolder folder;
  const auto with = [&](const std::string& glass, const std::vector<std::string>& catalogs) {
    const Imported run = import({folder.write("lens.seq", sequence("S 50 4 " + glass + "\nSTO\nS 0 3\nSI 0 0\n")), folder.path() + "/out.yaml", catalogs, false});
    return prescription::test::text_of(run.findings) + run.prescription.value_or("");
  };
  for (const char* glass : {"F5_CDGM", "F2_CDGM", "N-BK7_OHARA", "NBK7_S"})
    EXPECT_THAT(with(glass, {}), HasSubstr("lens.seq:15:8: error: unknown glass '" + std::string(glass) + "'\n  hint: '" + (glass[0] == 'F' ? std::string(glass, 2) : "N-BK7") +
                                           "' is another maker's here; --catalog FILE.agf looks in a maker's catalogue")) << glass;
  for (const char* glass : {"F5_SCHOTT", "F5_Schott", "F5_schott"}) EXPECT_THAT(with(glass, {}), AllOf(HasSubstr("medium: F5}"), Not(HasSubstr("warning")))) << glass;
  const std::string lines = "NM F5 2 624359 1.624353 35.938 0 1\nCD 1.3 0.009 0.2 0.045 0.9 110 0 0 0 0\nLD 0.35 2.3\n";
  const std::string of_the_maker = folder.write("cdgm.agf", lines), of_another = folder.write("one.agf", "CC Schott, 2020\n" + lines), unnamed = folder.write("mine.agf", lines);
  EXPECT_THAT(with("F5_CDGM", {of_the_maker}), AllOf(HasSubstr("medium: F5}"), Not(HasSubstr("warning"))));
  EXPECT_THAT(with("F5_CDGM", {of_another}), HasSubstr("error: unknown glass 'F5_CDGM'"));
  EXPECT_THAT(with("F5_CDGM", {unnamed}), AllOf(HasSubstr("medium: F5}"), HasSubstr("warning: 'F5_CDGM' is taken as F5, whose source names no maker")));
}

// ADE and BDE turn left-handed, CDE right-handed.
TEST(CodeVDecenter, with_return_is_the_surface_s_own) {
  const auto model = model_of("lens.seq", sequence("S 0 10\nSTO\nS 50 4\n DAR; XDE 1; YDE 2; ZDE 3; ADE 10; BDE 20; CDE 30\nS 0 3\nSI 0 0\n"));
  EXPECT_EQ(model.surfaces[1].decenter_mm, (Vec3<double>{1, 2, 3}));
  EXPECT_EQ(model.surfaces[1].tilt_deg, (Vec3<double>{-10, -20, 30}));
  EXPECT_EQ(model.surfaces[2].decenter_mm, Vec3<double>{});
  EXPECT_EQ(model.surfaces[2].tilt_deg, Vec3<double>{});
}

TEST(CodeVDecenter, without_return_moves_what_follows_until_it_is_reversed) {
  const auto model = model_of("lens.seq", sequence("S 0 10\nSTO\nS 50 4\n YDE 2; ADE -90\nS 0 7\n REV; YDE 2; ADE -90\nS 0 3\nSI 0 0\n"));
  EXPECT_EQ(model.surfaces[1].decenter_mm, (Vec3<double>{0, 2, 0}));
  EXPECT_EQ(model.surfaces[1].tilt_deg, (Vec3<double>{90, 0, 0}));
  // 4 mm along the turned axis, which points to -y; the reversing surface stands in the turned frame
  EXPECT_EQ(model.surfaces[2].decenter_mm, (Vec3<double>{0, -2, -4}));
  EXPECT_EQ(model.surfaces[2].tilt_deg, (Vec3<double>{90, 0, 0}));
  // back to the directions, at the reversed place: from (0, -2, 10) by (0, -2, 0), which is turned no more
  EXPECT_EQ(model.surfaces[3].tilt_deg, Vec3<double>{});
  EXPECT_EQ(model.surfaces[3].decenter_mm, (Vec3<double>{0, -4, -4}));
}

TEST(CodeVDecenter, with_bend_is_a_fold) {
  const auto model = model_of("lens.seq", sequence("S 0 50\nSTO\nS 0 -30 REFL\n ADE -45; BEN\nS 0 -2\nSI 0 0\n"));
  EXPECT_EQ(model.surfaces[1].tilt_deg, (Vec3<double>{45, 0, 0}));
  EXPECT_EQ(model.surfaces[2].tilt_deg, (Vec3<double>{90, 0, 0}));
  EXPECT_EQ(model.surfaces[2].decenter_mm, (Vec3<double>{0, 30, 30}));
  EXPECT_EQ(model.surfaces[3].decenter_mm, (Vec3<double>{0, 32, 32}));
}

// A thin biconcave mirror: f = R/2.
TEST(CodeVImageSolve, finds_the_paraxial_image) {
  const std::string mirror = "S 0 60\nSTO\nS -100 -1 REFL\n PIM\nSI 0 0.25\n";
  const auto solved = import_text("lens.seq", sequence(mirror));
  EXPECT_THAT(solved.prescription, HasSubstr("thickness_mm: -49.75, medium: mirror"));
  EXPECT_THAT(solved.prescription, HasSubstr("at the primary wavelength, and the defocus of 0.25 mm beyond it."));
  EXPECT_THAT(solved.messages, HasSubstr("warning: the last thickness, -1 mm, is not the one to the paraxial image; it is solved: -50 mm"));
  // what a file gives to its digits stands
  std::string given = mirror;
  const Outcome stands = import_text("lens.seq", sequence(given.replace(given.find("-1 REFL"), 2, "-50.00003")));
  EXPECT_EQ(stands.messages, "");
  EXPECT_THAT(stands.prescription, HasSubstr("thickness_mm: -49.75003,"));
  given = mirror;
  const Outcome empty = import_text("lens.seq", sequence(given.replace(given.find("-1 REFL"), 2, "0")));
  EXPECT_EQ(empty.messages, "");
  EXPECT_THAT(empty.prescription, HasSubstr("thickness_mm: -49.75,"));
  // from 100 mm before a mirror of f = -50: 1:1
  std::string finite = sequence("S -100 0 REFL\nSTO\n PIM\nSI 0 0\n");
  finite.replace(finite.find("0.1e14"), 6, "100");
  EXPECT_THAT(import_text("lens.seq", finite).prescription, HasSubstr("thickness_mm: -100,"));
}

// 2026-11-23: a later AIR left the glass, a later glass took the mirror away, a later REFR left it.
TEST(CodeVFile, has_glasses_and_mirrors_that_later_commands_change) {
  const auto import_surface = [](const std::string& surface) { return import_text("lens.seq", sequence("S 50 4 NBK7_SCHOTT\nSTO\n" + surface + "\nSI 0 0\n")); };
  EXPECT_THAT(import_surface("S -50 40 NBK7_SCHOTT; GLA S2 AIR").prescription, HasSubstr("{conic: {radius_mm: -50}, thickness_mm: 40}"));
  EXPECT_THAT(import_surface("S -50 -40; GLA NBK7_SCHOTT; RMD REFL; GLA AIR").prescription, HasSubstr("thickness_mm: -40, medium: mirror}"));
  EXPECT_THAT(import_surface("S -50 40 REFL; RMD S2 REFR").prescription, HasSubstr("{conic: {radius_mm: -50}, thickness_mm: 40}"));
  for (const char* both : {"S -50 -40 REFL NBK7_SCHOTT", "S -50 -40 REFL; GLA NBK7_SCHOTT"}) EXPECT_THAT(import_surface(both).messages, HasSubstr("error: the glass of a mirror\n")) << both;
}

TEST(CodeVFile, may_name_surfaces_by_their_labels) {
  const auto prescription = import_text("lens.seq", sequence("S 50 4 NBK7_SCHOTT\nSLB 'front'\nS -50 3\nSLB \"Iris\"\nSI 0 0\nSTO S'iris'\nTHI S'front' 5\n")).prescription;
  EXPECT_THAT(prescription, HasSubstr("{name: front, conic: {radius_mm: 50}, thickness_mm: 5, medium: N-BK7}"));
  EXPECT_THAT(prescription, HasSubstr("{name: Iris, stop: true, conic: {radius_mm: -50}"));
}

TEST(CodeVFile, may_come_back_to_its_image_surface) {
  const std::string lens = "S 50 4 NBK7_SCHOTT\nSTO\nS -50 40\n";
  EXPECT_EQ(import_text("lens.seq", sequence(lens + "SI 0 0\nSI 0 -0.1\n")).prescription, import_text("lens.seq", sequence(lens + "SI 0 -0.1\n")).prescription);
}

TEST(CodeVFile, has_defaults_that_are_told) {
  std::string text = sequence("S 50 4 NBK7_SCHOTT\nS 0 3\nSI 0 0\n");
  text.replace(text.find("REF   2"), 7, "");
  const Outcome run = import_text("lens.seq", text);
  EXPECT_EQ(run.messages, "lens.seq:1:1: warning: no REF: the middle wavelength is taken as the primary one\nlens.seq:1:1: warning: no STO: surface 1 is taken as the stop\n");
  EXPECT_THAT(run.prescription, HasSubstr("primary_nm: 587.6"));
  EXPECT_THAT(run.prescription, HasSubstr("{stop: true, conic: {radius_mm: 50}"));
}

// 2026-11-23: "'HMY' is not a number", also in part.
TEST(CodeVFile, has_numbers_for_its_solves) {
  const auto with = [](const std::string& front, const std::string& lines, bool takes_parts = false) { return import_text("lens.seq", sequence(front + "\nSTO\n" + lines + "\nS -80 60\nSI 0 0\n"), takes_parts); };
  struct Case {
    const char *front, *lines, *expected;
  };
  for (const auto& [front, lines, expected] : {Case{"S 50 4", "THI HMY 0.0", "lens.seq:17:1: note: THI HMY: the solve is not kept; the number in line 15 is\n"},
                                               Case{"S 50 4", "CUY umy -0.1", "lens.seq:17:1: note: CUY UMY: the solve is not kept; the number in line 15 is\n"},
                                               Case{"S 50 4", "RDY S1 ICX 0.2", "lens.seq:17:1: note: RDY ICX: the solve is not kept; the number in line 15 is\n"},
                                               Case{"S 50 4", "THI S1 PIM", "lens.seq:17:1: error: THI PIM is not known; the number in line 15 stands for it\n"},
                                               Case{"S 50 0", "THI HMY 0.0", "lens.seq:17:1: error: THI HMY: a solve, and the surface has no number that it was solved to\n"},
                                               Case{"S 0 4", "CUY UMY 0.1", "lens.seq:17:1: error: CUY UMY: a solve, and the surface has no number that it was solved to\n"}}) {
    const Outcome run = with(front, lines), part = with(front, lines, true);
    EXPECT_THAT(run.messages, ::testing::StartsWith(expected)) << lines;
    EXPECT_EQ(run.prescription.empty(), run.messages.find("error") != std::string::npos);
    const std::string plain = with(front, "").prescription;
    EXPECT_EQ(part.prescription.substr(part.prescription.find("surfaces:")), plain.substr(plain.find("surfaces:"))) << lines;
  }
}

// 2026-11-23: pickups were passed over in silence, also where the numbers of the file are others.
TEST(CodeVFile, has_the_numbers_of_its_pickups) {
  const auto with = [](const std::string& pickup, bool takes_parts = false) {
    return import_text("lens.seq", sequence("S 50 4\nSTO\nS -50 60\n ADE 3\nS 25 -60\n ADE 6.5; K -1\nSI 0 0\nPIK " + pickup + "\n"), takes_parts);
  };
  for (const char* same : {"RDY S2 Z1 RDY S1 Z1 -1.0", "RDY S2 S1 -1", "CUY S3 S1 2", "thi s3 z1 thi s2 z1 -1.0", "THI S2 THI S1 1.0 56", "ADE S3 ADE S2 2 0.5", "ADE S3 S2 2 .500000001", "THI SI THI S1 0 0"}) EXPECT_EQ(with(same).messages, "") << same;
  struct Case {
    const char *pickup, *expected;
  };
  for (const auto& [pickup, expected] : {Case{"CUY S2 S1 1", "error: PIK: CUY S2 is -0.02 in the file, where the pickup from CUY S1 makes it 0.02\n  hint: a lens that CODE V saves has the number that was picked up\n"},
                                         Case{"THI S3 Z1 THI S2 Z1", "error: PIK: THI S3 is -60 in the file, where the pickup from THI S2 makes it 60\n"},
                                         Case{"ADE S3 ADE S2 2", "error: PIK: ADE S3 is 6.5 in the file, where the pickup from ADE S2 makes it 6\n"}, Case{"K S1 K S3", "error: PIK: K S1 is 0 in the file"},
                                         Case{"GLA S2 Z1 GLA S1 Z1", "note: PIK GLA S2 Z1 GLA S1 Z1: the pickup is neither kept nor checked; the number in the file is kept\n"}, Case{"THI S9 S1", "note: PIK THI S9 S1: the pickup is"},
                                         Case{"THI S3 S2 x", "note: PIK THI S3 S2 x: "}, Case{"THI S3 S2 -1 0 0", "note: "}, Case{"THI S3", "note: "}, Case{"", "note: "}, Case{"THI S3 S", "note: "}}) {
    EXPECT_THAT(with(pickup).messages, ::testing::StartsWith(std::string("lens.seq:22:1: ") + expected)) << pickup;
    EXPECT_NE(with(pickup, true).prescription, "") << pickup;
  }
}

// 2026-11-23: dropped in silence, but for a curvature.
TEST(CodeVFile, tells_of_an_object_that_is_no_plane) {
  const auto with = [](const std::string& lines) {
    std::string text = sequence("S 50 4\nSTO\nSI 0 0\n");
    return import_text("lens.seq", text.replace(text.find("SO    0.0 0.1e14"), 16, "SO 0 100\n" + lines)).messages;
  };
  EXPECT_EQ(with("CIR 5"), "lens.seq:15:1: error: CIR: an aperture of the object\n");
  EXPECT_EQ(with("ASP; K -1; A 0; B 1e-4"), "lens.seq:15:17: error: SO: an aspheric object\n");
  EXPECT_EQ(with("RDY 20; K -1"), "lens.seq:14:6: error: SO: a curved object\nlens.seq:15:9: error: SO: an aspheric object\n");
  EXPECT_EQ(with("ASP; K -1; A 0"), "");
}

// 2026-11-23: the object as the stop was told at 1:1, and of DAR and BEN the last was taken without a word.
TEST(CodeVFile, tells_its_faults_where_they_are) {
  std::string text = sequence("S 50 4\nS -80 60\nSI 0 0\n");
  EXPECT_EQ(import_text("lens.seq", text.replace(text.find("SO "), 3, "STO\nSO ")).messages, "lens.seq:14:1: error: the object is the stop\n  hint: STO stands behind the S of its surface, or names it: STO S3\n");
  const auto with = [](const std::string& lines) { return import_text("lens.seq", sequence("S 50 4\nSTO\nS -80 60\n" + lines + "\nSI 0 0\n")).messages; };
  EXPECT_EQ(with("ADE 5; DAR\nBEN"), "lens.seq:19:1: error: BEN: the surface is decentered in another way in line 18\n  hint: it is one of DAR, REV and BEN\n");
  EXPECT_EQ(with("ADE 5; DAR\nDAR"), "");
}

TEST(CodeVFile, partly_understood_lists_what_is_left_out) {
  const std::string text = sequence("S 50 4 NBK7_SCHOTT\nSTO\n REX 5; REY 6\nS 0 3\n DIF DOE\nSI 0 0\nVUX 0.1 0.2\n");
  const Outcome refused = import_text("lens.seq", text), partial = import_text("lens.seq", text, true);
  EXPECT_EQ(refused.prescription, "");
  EXPECT_THAT(refused.messages, HasSubstr("lens.seq:17:2: error: REX: a rectangular aperture\n  hint: apertures here are circles about a surface's vertex\nlens.seq:17:9: error: REY: a rectangular aperture\n  hint: apertures here are circles about a surface's vertex\nlens.seq:19:2: error: DIF is not known\nlens.seq:21:1: error: VUX: vignetting factors\n"));
  EXPECT_EQ(partial.left_out_count, 4);
  EXPECT_THAT(partial.prescription, HasSubstr("#   17: REX: a rectangular aperture\n#   17: REY: a rectangular aperture\n#   19: DIF is not known\n#   21: VUX: vignetting factors\n"));
  EXPECT_THAT(partial.messages, Not(HasSubstr("error")));
}

}  // namespace
}  // namespace sagitta::lens_file::test
