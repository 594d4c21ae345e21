// SPDX-License-Identifier: Apache-2.0
// Lens files of other programs, imported and traced by the program as it is shipped. The files are written here, with the operands and encodings that those programs use.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/lens_file/support.h"
#include "tests/support/program.h"

namespace sagitta::test {
namespace {

using lens_file::test::in_utf_16;
using lens_file::test::zemax;
using lens_file::test::zemax_surface;
using ::testing::HasSubstr;

const std::string systems = SAGITTA_SOURCE_DIR "/systems/";

// Imports a text as lens.yaml in the folder; its path.
std::string imported(const Folder& folder, const std::string& name, const std::string& text, const std::string& options = {}) {
  const std::string to = folder.path("lens.yaml");
  const Outcome run = run_program("import " + folder.file(name, text) + " -o " + to + " " + options);
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr(to + ": "));
  const Outcome check = run_program("check " + to);
  EXPECT_EQ(check.status, 0) << check.err << read_text(to);
  EXPECT_EQ(check.err, "");
  return to;
}

nlohmann::json first_order(const Folder& folder, const std::string& system) {
  const Outcome run = run_program("trace " + system + " -o " + folder.path("out") + " --only spot --rays 7 --json");
  EXPECT_EQ(run.status, 0) << run.err;
  return nlohmann::json::parse(run.out)["first_order"];
}

std::vector<RayRow> rays_of(const Folder& folder, const std::string& system, const std::vector<std::string>& rays) {
  std::string csv = "x_mm,y_mm,z_mm,l,m,n\n";
  for (const std::string& ray : rays) csv += ray + "\n";
  const Outcome run = run_program("rays " + system + " --from " + folder.file("rays.csv", csv));
  EXPECT_EQ(run.status, 0) << run.err;
  return parse_rays(run.out);
}

std::string standard(const std::string& lines) { return "TYPE STANDARD\n" + lines; }
const std::string object_at_infinity = zemax_surface(0, "TYPE STANDARD\nCURV 0.0 0 0 0 0 \"\"\nDISZ INFINITY");

// OpticStudio's own figures of this lens (ZOSPy's tests): R = +-20, t = 1, n = 1.5, the stop in front.
TEST(ImportCommand, brings_ZOSPys_simple_lens_with_its_first_order_and_its_skew_ray) {
  const Folder folder;
  const std::string system = imported(folder, "simple.zmx", in_utf_16(zemax(lens_file::test::on_axis_at_543,
      object_at_infinity + zemax_surface(1, "STOP\n" + standard("CURV 0\nDISZ 0\nDIAM 1 1 0 0 1 \"\"")) + zemax_surface(2, standard("CURV 5.000000000000000300E-002 0 0 0 0 \"\"\nDISZ 1\nGLAS ___BLANK 1 0 1.5 0 0 0 0 0 0 0")) +
      zemax_surface(3, standard("CURV -5.000000000000000300E-002 0 0 0 0 \"\"\nDISZ 1.979200000000E+1")) + zemax_surface(4, standard("CURV 0\nDISZ 0"))), true));
  const auto paraxial = first_order(folder, system);
  EXPECT_NEAR(paraxial["effective_focal_length_mm"], 20.168067, 1e-6);
  EXPECT_NEAR(paraxial["back_focal_length_mm"], 19.831933, 1e-6);
  const auto rays = rays_of(folder, system, {"1,1,-1,0,0,1"});
  ASSERT_EQ(rays.size(), 4u);
  EXPECT_NEAR(rays[3].x, -0.0061213962872, 1e-12);
  EXPECT_EQ(rays[3].x, rays[3].y);
}

// The curvatures of Thorlabs' own file; its figures at 855 nm.
TEST(ImportCommand, brings_an_achromat_with_catalogue_glasses) {
  const Folder folder;
  const std::string system = imported(folder, "ac508.zmx", zemax("ENPD 4.0E+1\nFTYP 0 0 1 3 0 0 0\nXFLN 0 0 0\nYFLN 0 0 0\nWAVM 1 7.065E-1 1\nWAVM 2 8.55E-1 1\nWAVM 3 1.015 1\n",
      object_at_infinity + zemax_surface(1, "STOP\n" + standard("CURV 0.0152045005321575\nDISZ 13\nGLAS N-LAK22 0 0 1.65 55.9 0 0 0 0 0 0\nCLAP 0 25.4 0")) +
      zemax_surface(2, standard("CURV -0.0178635226866738\nDISZ 2\nGLAS N-SF6HT 0 0 1.8 25.4 0 0 0 0 0 0\nCLAP 0 25.4 0")) +
      zemax_surface(3, standard("CURV -0.0035644270183568\nDISZ 91.18034738546\nCLAP 0 25.4 0")) + zemax_surface(4, standard("CURV 0\nDISZ 0"))));
  // PWAV is 1: 706.5 nm
  const auto paraxial = first_order(folder, system);
  EXPECT_NEAR(paraxial["effective_focal_length_mm"], 100.04378, 1e-4);
  EXPECT_NEAR(paraxial["back_focal_length_mm"], 91.45726, 1e-4);
  // and the rays are those of the prescription written by hand
  const auto here = rays_of(folder, system, {"3,4,-5,0,0.01,0.99994999874993751"}), there = rays_of(folder, systems + "ac508-100-b.yaml", {"3,4,-5,0,0.01,0.99994999874993751"});
  ASSERT_EQ(here.size(), 4u);
  ASSERT_EQ(there.size(), 4u);
  EXPECT_THAT(read_text(system), HasSubstr("conic: {radius_mm: 65.77}"));
  const auto at_706 = run_program("rays " + systems + "ac508-100-b.yaml --wavelength 706.5 --field 0 --pupil 0.3,0.7"), ours = run_program("rays " + system + " --wavelength 706.5 --pupil 0.3,0.7");
  const auto a = parse_rays(at_706.out), b = parse_rays(ours.out);
  ASSERT_EQ(a.size(), 4u);
  ASSERT_EQ(b.size(), 4u);
  EXPECT_NEAR(a[3].x, b[3].x, 1e-12);
  EXPECT_NEAR(a[3].y, b[3].y, 1e-12);
}

const char* const double_gauss = R"(RDM N;LEN      "VERSION: 10.7       LENS VERSION: 80       Creation Date: 16-Jul-2015"
TITLE 'Double Gauss F/2'
EPD   50.0
DIM   M
WL    656.3 587.6 486.1
REF   2
WTW   1 1 1
INI   ' '
XAN   0.0 0.0 0.0
YAN   0.0 10.0 14.0
WTF   1.0 1.0 1.0
VUY   0.0 0.0 0.0
VLY   0.0 0.0 0.0
SO    0.0 993938392063.0
S     0.01779284094091543 8.75 NSSK2_SCHOTT
  CCY 0
S     0.006566600536925569 0.5
S     0.02653743294670983 12.5 NSK2_SCHOTT
S     0.0 3.8 F5_SCHOTT
S     0.04126892878570084 16.36944492653564
  CCY 0; THC 0
S     0.0 13.74795696388906
  STO
S     -0.03523942654429074 3.8 F5_SCHOTT
S     0.0 11.0 NSK16_SCHOTT
S     -0.02636750828657709 0.5
S     0.005636604951748545 7.0 NSK16_SCHOTT
S     -0.0125926458590576 THICKNESS
  PIM
SI    0.0 -0.4002686453541377
DER   VAL I1 -0.6370618627459224e-5
GO
)";
std::string double_gauss_with(const std::string& thickness) {
  std::string text = double_gauss;
  return text.replace(text.find("THICKNESS"), 9, thickness);
}

// CODE V's listing: the paraxial back focal length to fifteen digits.
TEST(ImportCommand, solves_the_image_of_CODE_Vs_double_Gauss) {
  const Folder folder;
  for (const char* thickness : {"0", "61.4875364179821"}) {
    const std::string system = imported(folder, "ag_dblgauss.seq", double_gauss_with(thickness));
    EXPECT_NEAR(first_order(folder, system)["back_focal_length_mm"], 61.4875364179821, 1e-12);
    EXPECT_NEAR(first_order(folder, system)["effective_focal_length_mm"], 100.0038, 5e-5);
    const std::string aimed = folder.file("aimed.yaml", "sagitta: 1\nextends: " + systems + "double-gauss.yaml\naperture: {entrance_pupil_diameter_mm: 50, aim: stop}\n"), ray = " --field 2 --wavelength 587.6 --pupil 0.3,-0.9";
    const auto here = parse_rays(run_program("rays " + system + ray).out), there = parse_rays(run_program("rays " + aimed + ray).out);
    ASSERT_EQ(here.size(), 12u);
    ASSERT_EQ(there.size(), 12u);
    EXPECT_NEAR(here[11].x, there[11].x, 1e-11);  // radii and thicknesses are written with 16 digits there
    EXPECT_NEAR(here[11].y, there[11].y, 1e-11);
  }
}

const char* const three_mirrors = R"(tit 'F/4.0, 4x4 deg., 3 Mirror Compact'
rdm y
SO 0 1e11
S 0 300.000000
! Primary mirror
S -1058.98937 -276.006853 REFL
CON
K -1.314566
DAR
YDE 48.695345; ADE 8.438645
S 0 -0.981318
STO
DAR
YDE 11.444717; ADE 10.219900
S -324.06500 319.160560  REFL   ! Secondary mirror
CON
K 0.889123
DAR
YDE 17.561821; ADE 9.661580
S -453.96516 -321.621031  REFL
ASP
K 0.226106; A 0.368950E-10
DAR
YDE 67.500535; ADE 9.514418
SI 0 15.407921
YDE -47.681342; ADE 8.716957
EPD      100.00000
DIM             MM
WL          500.00
REF              1
XAN        0.00000       0.00000       0.00000       2.00000       2.00000
YAN        2.00000       0.00000      -2.00000      -2.00000       2.00000
CA
PIM
)";

// CODE V's listing: places in the local frames of primary, secondary, tertiary and image.
TEST(ImportCommand, brings_CODE_Vs_three_mirrors) {
  const Folder folder;
  const std::string system = imported(folder, "threemir.seq", three_mirrors);
  EXPECT_THAT(read_text(system), HasSubstr("decenter_mm: [0, 48.695345, 0]\n    tilt_deg: [-8.438645, 0, 0]\n    thickness_mm: -276.006853\n"));
  const double m = std::sin(2 * std::acos(-1.0) / 180), n = std::cos(2 * std::acos(-1.0) / 180);
  const auto rays = rays_of(folder, system, {"0,112.848743,0,0,0,1", fmt::format("0,112.848743,0,0,{:.17g},{:.17g}", m, n), "0,144.927530,0,0,0,1"});
  ASSERT_EQ(rays.size(), 18u);
  // places in the local frame, of a surface moved by dy and turned by -ade, on the axis at z
  const auto local_y = [](const RayRow& row, double dy, double ade, double z) {
    const double a = ade * std::acos(-1.0) / 180;
    return (row.y - dy) * std::cos(a) - (row.z - z) * std::sin(a);
  };
  const double z_primary = 300, z_secondary = 300 - 276.006853 - 0.981318, z_tertiary = z_secondary + 319.16056, z_image = z_tertiary - 321.621031 + 15.407921;
  EXPECT_NEAR(local_y(rays[7], 48.695345, 8.438645, z_primary), 75.360070, 1e-5);
  EXPECT_NEAR(local_y(rays[9], 17.561821, 9.661580, z_secondary), -6.195034, 1e-5);
  EXPECT_NEAR(local_y(rays[10], 67.500535, 9.514418, z_tertiary), -89.201217, 1e-5);
  EXPECT_NEAR(local_y(rays[11], -47.681342, 8.716957, z_image), 14.075077, 1e-5);
  EXPECT_NEAR(local_y(rays[13], 48.695345, 8.438645, z_primary), 97.957122, 2e-6);
  // The prescription written by hand.
  const auto by_hand = rays_of(folder, systems + "three-mirror-compact.yaml", {"0,144.927530,0,0,0,1"});
  ASSERT_EQ(by_hand.size(), 6u);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_NEAR(by_hand[i].y, rays[12 + i].y, 1e-12 * 1000);  // of a system of a metre
    EXPECT_NEAR(by_hand[i].z, rays[12 + i].z, 1e-12 * 1000);
    EXPECT_NEAR(by_hand[i].m, rays[12 + i].m, 1e-13);
  }
}

// The wide-angle Navarro eye at the wavelength of its retina, in all the encodings of such files.
TEST(ImportCommand, brings_the_Navarro_eye_from_every_encoding) {
  const Folder folder;
  const auto model = [](const std::string& index) { return "\nGLAS ___BLANK 1 0 " + index + " 0 0 0 0 0 0 0"; };
  const auto curvature = [](double radius) { return fmt::format("CURV {:.18E} 0 0 0 0 \"\"", 1 / radius); };
  const std::string text = zemax("ENPD 4.0E+0\nFTYP 0 0 3 1 0 0 0\nXFLN 0 0 0 0 0 0 0 0 0 0 0 0\nYFLN 0 1.0E+1 2.0E+1 0 0 0 0 0 0 0 0 0\nWAVM 1 5.43E-1 1\nWAVM 2 5.5E-1 1\n",
      object_at_infinity + zemax_surface(1, "COMM anterior cornea\n" + standard(curvature(7.72) + "\nCONI -2.6E-1\nDISZ 5.5E-1" + model("1.3777"))) +
      zemax_surface(2, "COMM posterior cornea\n" + standard(curvature(6.5) + "\nDISZ 3.05" + model("1.3391"))) + zemax_surface(3, "STOP\nCOMM pupil\n" + standard("CURV 0\nDISZ 0" + model("1.3391"))) +
      zemax_surface(4, "COMM anterior lens\n" + standard(curvature(10.2) + "\nCONI -3.1316\nDISZ 4" + model("1.4222"))) +
      zemax_surface(5, "COMM posterior lens\n" + standard(curvature(-6) + "\nCONI -1\nDISZ 1.63203E+1" + model("1.3377"))) +
      zemax_surface(6, "COMM retina\n" + standard(curvature(-12) + "\nDISZ 0")));
  std::string expected;
  for (const char* field : {"0", "1", "2"}) expected += run_program("rays " + systems + "navarro-eye.yaml --wavelength 543 --pupil 0,0 --pupil 0.6,0.8 --pupil=-1,0 --field " + std::string(field)).out;
  for (const std::string& bytes : {text, in_utf_16(text, true), in_utf_16(text, false), "\xEF\xBB\xBF" + text, text + "NOTE 0 \xB5m\n"}) {
    const std::string system = imported(folder, "navarro_eye.zmx", bytes);
    std::string rays;
    for (const char* field : {"0", "1", "2"}) rays += run_program("rays " + system + " --pupil 0,0 --pupil 0.6,0.8 --pupil=-1,0 --field " + std::string(field)).out;
    EXPECT_EQ(rays, expected);
  }
  EXPECT_GT(expected.size(), 5000u);
}

// The lens of Liou and Brennan's eye: two media of Gradient 3.
TEST(ImportCommand, brings_gradient_index_media) {
  const Folder folder;
  const auto model = [](const std::string& index) { return "\nGLAS ___BLANK 1 0 " + index + " 0 0 0 0 0 0 0"; };
  std::string head = lens_file::test::on_axis_at_543;
  head.replace(head.find("5.43E-1"), 7, "5.55E-1");
  const std::string system = imported(folder, "liou-brennan.zmx", zemax(head,
      object_at_infinity + zemax_surface(1, standard("CURV 0.1287001287001287\nCONI -0.18\nDISZ 0.5" + model("1.376"))) + zemax_surface(2, standard("CURV 0.15625\nCONI -0.6\nDISZ 3.16" + model("1.336"))) +
      zemax_surface(3, "STOP\n" + standard("CURV 0\nDISZ 0" + model("1.336"))) +
      zemax_surface(4, "TYPE GRINSUR3\nCURV 0.08064516129032258\nCONI -0.94\nDISZ 1.59\nPARM 1 1.0\nPARM 2 1.368\nPARM 3 -0.001978\nPARM 4 0\nPARM 5 0\nPARM 6 0.049057\nPARM 7 -0.015427\nPARM 8 0") +
      zemax_surface(5, "TYPE GRINSUR3\nCURV 0\nDISZ 2.43\nPARM 1 1.0\nPARM 2 1.407\nPARM 3 -0.001978\nPARM 6 0\nPARM 7 -0.006605") +
      zemax_surface(6, standard("CURV -0.12345679012345678\nCONI 0.96\nDISZ 16.27" + model("1.336"))) + zemax_surface(7, standard("CURV -0.08333333333333333\nDISZ 0"))));
  const std::vector<std::string> rays{"0,1,-2,0,0,1", "0.5,2,-2,0,0,1", "0,3,-2,0.05,0,0.99874921777190895"};
  const auto here = rays_of(folder, system, rays), there = rays_of(folder, systems + "liou-brennan-eye.yaml", rays);
  ASSERT_EQ(here.size(), 21u);
  ASSERT_EQ(there.size(), 21u);
  for (const std::size_t i : {6, 13, 20}) {
    // Liou and Brennan's dispersion adds 4.9e-5 to their indices at 555 nm, its own reference, which moves hits by less than a micrometre and a half
    EXPECT_NEAR(here[i].x, there[i].x, 1.5e-3);
    EXPECT_NEAR(here[i].y, there[i].y, 1.5e-3);
  }
}

TEST(ImportCommand, refuses_what_it_does_not_understand_unless_a_part_is_enough) {
  const Folder folder;
  std::string text = double_gauss_with("61.4875364179821");
  text.replace(text.find("VUY   0.0 0.0 0.0"), 17, "VUY   0.0 0.2 0.4");
  const std::string file = folder.file("lens.seq", text), to = folder.path("lens.yaml");
  const Outcome refused = run_program("import " + file + " -o " + to);
  EXPECT_EQ(refused.status, 1);
  EXPECT_EQ(refused.out, "");
  EXPECT_EQ(refused.err, file + ":12:1: error: VUY: vignetting factors\n  hint: apertures of surfaces clip rays instead\nsagitta import: " + to + " is not written; --partial leaves out what is only not understood\n");
  EXPECT_FALSE(std::filesystem::exists(to));
  const Outcome partial = run_program("import " + file + " -o " + to + " --partial");
  EXPECT_EQ(partial.status, 0);
  EXPECT_EQ(partial.out, to + ": 12 surfaces, 1 thing left out: its head comment lists them\n");
  EXPECT_EQ(partial.err, file + ":12:1: warning: VUY: vignetting factors\n  hint: apertures of surfaces clip rays instead\n");
  EXPECT_THAT(read_text(to), HasSubstr("# Left out of that file, by line:\n#   12: VUY: vignetting factors\n"));
}

TEST(ImportCommand, speaks_of_partial_only_where_that_helps) {
  const Folder folder;
  const std::string to = folder.path("lens.yaml"), missing = folder.path("none.zmx"), no_surfaces = folder.file("broken.zmx", "VERS 1\nMODE SEQ\n");
  const std::string written = "sagitta import: " + to + " is not written\n";
  for (const char* partial : {"", " --partial"}) {
    EXPECT_EQ(run_program("import " + missing + " -o " + to + partial).err, missing + ":1:1: error: there is no such file\n" + written);
    const Outcome broken = run_program("import " + no_surfaces + " -o " + to + partial);
    EXPECT_EQ(broken.status, 1);
    EXPECT_THAT(broken.err, HasSubstr("error: "));
    EXPECT_THAT(broken.err, ::testing::EndsWith("\n" + written));
  }
}

TEST(ImportCommand, looks_for_glasses_in_catalogues) {
  const Folder folder;
  const std::string agf = folder.file("maker.agf", "CC a maker\nNM MY-GLASS 2 0 1.5 60 0 1\nCD 1.25 0 0 0 0 0\nLD 0.3 2.5\n");
  std::string text = double_gauss_with("0");
  while (text.find("F5_SCHOTT") != std::string::npos) text.replace(text.find("F5_SCHOTT"), 9, "MYGLASS_MAKER");
  const std::string file = folder.file("lens.seq", text), to = folder.path("lens.yaml");
  const Outcome unknown = run_program("import " + file + " -o " + to);
  EXPECT_EQ(unknown.status, 1);
  EXPECT_THAT(unknown.err, HasSubstr(file + ":19:15: error: unknown glass 'MYGLASS_MAKER'\n  hint: --catalog FILE.agf looks in a maker's catalogue\n"));
  const std::string system = imported(folder, "lens.seq", text, "--catalog " + agf);
  EXPECT_THAT(read_text(system), HasSubstr("catalogs: [maker.agf]\n"));
  EXPECT_THAT(read_text(system), HasSubstr("{plane: {}, thickness_mm: 3.8, medium: MY-GLASS}"));
}

TEST(ImportCommand, does_what_README_shows) {
  const Folder folder;
  const std::string readme = read_text(SAGITTA_SOURCE_DIR "/README.md"), to = folder.path("achromat.yaml"), before = "cd '" SAGITTA_SOURCE_DIR "' && ";
  const std::string command = "import tests/lens_file/achromat.zmx -o ";
  EXPECT_THAT(readme, HasSubstr("\n    build/sagitta " + command + "achromat.yaml\n"));
  std::string refused = run_program(command + to, before).err;
  refused.replace(refused.find(to), to.size(), "achromat.yaml");
  EXPECT_THAT(readme, HasSubstr("\n```\n" + refused + "```\n"));
  EXPECT_EQ(run_program(command + to + " --partial", before).status, 0);
  EXPECT_THAT(readme, HasSubstr("\n```yaml\n" + read_text(to) + "```\n"));
}

TEST(ImportCommand, tells_wrong_usage_and_never_overwrites_its_input) {
  const Folder folder;
  const std::string file = folder.file("lens.seq", double_gauss_with("0"));
  EXPECT_EQ(run_program("import " + file).status, 2);
  EXPECT_EQ(run_program("import " + file + " -o " + folder.path("lens.txt")).err, "sagitta import: -o " + folder.path("lens.txt") + ": expected LENS.yaml\n");
  EXPECT_EQ(run_program("import " + folder.file("lens.len", "x") + " -o " + folder.path("lens.yaml")).err, "sagitta import: " + folder.path("lens.len") + ": expected LENS.zmx or LENS.seq\n");
  const Outcome none = run_program("import " + folder.path("none.zmx") + " -o " + folder.path("lens.yaml"));
  EXPECT_EQ(none.status, 1);
  EXPECT_THAT(none.err, HasSubstr("none.zmx:1:1: error: there is no such file\n"));
  std::filesystem::create_symlink("lens.seq", folder.path("link.yaml"));
  const Outcome over = run_program("import " + file + " -o " + folder.path("link.yaml"));
  EXPECT_EQ(over.status, 2);
  EXPECT_THAT(over.err, HasSubstr("link.yaml is the lens file, which would be overwritten"));
  EXPECT_EQ(run_program("import " + file + " -o " + folder.path("no/such/folder.yaml")).status, 1);
  EXPECT_EQ(read_text(file), double_gauss_with("0"));
}

}  // namespace
}  // namespace sagitta::test
