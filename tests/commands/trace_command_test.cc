// SPDX-License-Identifier: Apache-2.0
// `sagitta trace` as it is shipped: files, exit status, and what is in the files.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

#include "tests/support/compared.h"
#include "tests/support/exr_file.h"
#include "tests/support/program.h"

namespace sagitta::test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

const std::string lens = "sagitta: 1\nname: A lens\nwavelengths_nm: [550, 633]\naperture: {entrance_pupil_diameter_mm: 8}\nfields: {angles_deg: [[0, 0], [1, 3]]}\nsurfaces:\n"
                         "  - {stop: true, conic: {radius_mm: 50}, thickness_mm: 4, medium: N-BK7, inner_semi_diameter_mm: 0.7}\n"
                         "  - {name: back, conic: {radius_mm: -50}, thickness_mm: 48, semi_diameter_mm: 3.9}\n  - {}\n";

std::vector<std::string> files_in(const std::string& folder) {
  std::vector<std::string> names;
  if (std::filesystem::exists(folder))
    for (const auto& entry : std::filesystem::directory_iterator(folder)) names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  return names;
}

TEST(TraceCommand, writes_pictures_data_and_summary) {
  const Folder folder;
  const Outcome run = run_program("trace " + folder.file("lens.yaml", lens) + " -o " + folder.path("a/b") + " --rays 500");
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(run.err, "");
  EXPECT_THAT(run.out, HasSubstr("A lens"));
  EXPECT_THAT(files_in(folder.path("a/b")), ::testing::ElementsAre("spot.exr", "spot.png", "summary.json", "wavefront.exr", "wavefront.png"));
}

TEST(TraceCommand, only_makes_what_is_asked_for) {
  const Folder folder;
  const std::string system = folder.file("lens.yaml", lens);
  EXPECT_EQ(run_program("trace " + system + " -o " + folder.path("s") + " --only spot --rays 100").status, 0);
  EXPECT_THAT(files_in(folder.path("s")), ::testing::ElementsAre("spot.exr", "spot.png", "summary.json"));
  const Outcome run = run_program("trace " + system + " -o " + folder.path("w") + " --only wavefront --json");
  EXPECT_EQ(run.status, 0);
  EXPECT_THAT(files_in(folder.path("w")), ::testing::ElementsAre("summary.json", "wavefront.exr", "wavefront.png"));
  const json summary = json::parse(run.out);
  for (const json& result : summary["results"]) {
    EXPECT_FALSE(result.contains("spot"));
    EXPECT_TRUE(result["wavefront"].is_object());
    EXPECT_EQ(result["rays"]["launched"], 3001);  // points of the grid in the disc
  }
  EXPECT_EQ(run_program("trace " + system + " -o " + folder.path("b") + " --only spot,wavefront --rays 100").status, 0);
  EXPECT_EQ(files_in(folder.path("b")).size(), 5u);
}

TEST(TraceCommand, json_on_the_screen_is_the_summary) {
  const Folder folder;
  const Outcome run = run_program("trace " + folder.file("lens.yaml", lens) + " -o " + folder.path("out") + " --rays 500 --json");
  EXPECT_EQ(run.out, read_text(folder.path("out/summary.json")));
  const json summary = json::parse(run.out);
  ASSERT_EQ(summary["results"].size(), 4u);
  for (const json& result : summary["results"]) {
    const json& rays = result["rays"];
    EXPECT_EQ(rays["launched"], 547);  // 13 rings
    int sum = 0;
    for (const char* status : {"ok", "missed", "clipped", "total_reflection", "outside_data", "not_converged"}) sum += rays[status].get<int>();
    EXPECT_EQ(sum, 547);
    EXPECT_GT(rays["clipped"].get<int>(), 10);
    int lost = 0;
    for (const json& loss : result["lost"]) lost += loss["count"].get<int>();
    EXPECT_EQ(lost, 547 - rays["ok"].get<int>());
    EXPECT_EQ(result["wavefront"]["zernike"]["coefficients_um"].size(), 36u);
    EXPECT_EQ(result["wavefront"]["zernike"]["indexing"], "osa");
    EXPECT_EQ(result["wavefront"]["zernike"]["pupil_semi_diameter_mm"], 4);
  }
  EXPECT_EQ(summary["results"][2]["angle_deg"], json({1, 3}));
  EXPECT_EQ(summary["results"][1]["wavelength_nm"], 633);
  EXPECT_EQ(summary["results"][3]["field"], 1);
}

// Of an eye every result says which one, and in which axes; Zernike coefficients are then the examiner's, who sees x mirrored.
TEST(TraceCommand, says_which_eye_it_is_and_in_which_axes) {
  const Folder folder;
  const std::string eye = lens + "eye: left\n", options = " --rays 500 -o ";
  const Outcome text = run_program("trace " + folder.file("eye.yaml", eye) + options + folder.path());
  ASSERT_EQ(text.status, 0) << text.err;
  EXPECT_THAT(text.out, HasSubstr("; left eye, x to the examiner's left, y up\n"));
  const json of_eye = json::parse(read_text(folder.path("summary.json"))), of_lens = traced(folder.file("lens.yaml", lens), "--rays 500");
  EXPECT_EQ(of_eye["eye"], "left");
  EXPECT_EQ(of_eye["frame"], "x to the examiner's left, y up");
  EXPECT_FALSE(of_lens.contains("eye"));
  for (const char* file : {"spot.exr", "wavefront.exr"}) EXPECT_EQ(read_exr(folder.path(file))[1].text("eye"), "left, x to the examiner's left, y up");
  const json &zernike = of_eye["results"][2]["wavefront"]["zernike"], &tracers = of_lens["results"][2]["wavefront"]["zernike"];
  EXPECT_EQ(zernike["frame"], "left eye, OSA axes: x to the examiner's right, y up");
  double odd = 0;
  for (int n = 0, m = 0, j = 0; j < 36; ++j, m += 2) {
    if (m > n) m = -++n;
    const bool is_odd = m > 0 ? m % 2 != 0 : m < 0 && m % 2 == 0;  // cos(m t) of odd m, sin(m t) of even m
    EXPECT_EQ(zernike["coefficients_um"][j].get<double>(), (is_odd ? -1 : 1) * tracers["coefficients_um"][j].get<double>()) << j;
    if (is_odd) odd += std::abs(tracers["coefficients_um"][j].get<double>());
  }
  EXPECT_GT(odd, .01);  // the field has an x
}

TEST(TraceCommand, spot_file_holds_the_ray_counts_of_the_summary) {
  const Folder folder;
  ASSERT_EQ(run_program("trace " + folder.file("lens.yaml", lens) + " -o " + folder.path() + " --rays 5000").status, 0);
  const json summary = json::parse(read_text(folder.path("summary.json")));
  const auto parts = read_exr(folder.path("spot.exr"));
  ASSERT_EQ(parts.size(), 5u);
  EXPECT_EQ(parts[0].name, "preview");
  ASSERT_EQ(parts[0].floats.size(), 3u);
  for (const char* channel : {"R", "G", "B"})
    for (const float value : parts[0].floats.at(channel)) ASSERT_TRUE(value >= 0 && value <= 1);
  for (std::size_t i = 0; i < 4; ++i) {
    const ExrFilePart& part = parts[i + 1];
    const json& result = summary["results"][i];
    EXPECT_EQ(part.name, fmt::format("spot.field{}.{}nm", i / 2, i % 2 == 0 ? 550 : 633));
    const auto& counts = part.floats.at("Y");
    EXPECT_EQ(std::accumulate(counts.begin(), counts.end(), 0.0), result["rays"]["ok"].get<double>());
    EXPECT_EQ(part.text("units.Y"), "rays");
    EXPECT_THAT(part.text("software"), HasSubstr("sagitta"));
    EXPECT_EQ(part.number("wavelength_nm"), i % 2 == 0 ? 550 : 633);
    EXPECT_EQ(part.integer("field"), static_cast<int>(i / 2));
    EXPECT_EQ(part.pair("angle_deg").y, i < 2 ? 0 : 3);
    EXPECT_EQ(part.number("rays_ok"), result["rays"]["ok"].get<double>());
    // the centroid from the pixels is that of the rays to a pixel, with row 0 at the largest y
    const double pixel = part.pair("pixel_size_mm").x, ok = result["rays"]["ok"].get<double>();
    double x = 0, y = 0;
    for (int row = 0; row < part.height; ++row)
      for (int column = 0; column < part.width; ++column) {
        const double count = counts[static_cast<std::size_t>(row * part.width + column)];
        x += count * (part.pair("centre_mm").x + (column + 0.5 - part.width / 2.0) * pixel);
        y += count * (part.pair("centre_mm").y - (row + 0.5 - part.height / 2.0) * pixel);
      }
    EXPECT_NEAR(x / ok, result["spot"]["centroid_mm"][0].get<double>(), pixel / 2);
    EXPECT_NEAR(y / ok, result["spot"]["centroid_mm"][1].get<double>(), pixel / 2);
  }
}

TEST(TraceCommand, wavefront_file_holds_the_map_and_its_mask) {
  const Folder folder;
  ASSERT_EQ(run_program("trace " + folder.file("lens.yaml", lens) + " -o " + folder.path() + " --rays 100").status, 0);
  const json summary = json::parse(read_text(folder.path("summary.json")));
  const auto parts = read_exr(folder.path("wavefront.exr"));
  ASSERT_EQ(parts.size(), 5u);
  for (const auto& [channel, values] : parts[0].floats)
    for (const float value : values) ASSERT_FALSE(std::isnan(value)) << channel;
  for (std::size_t i = 0; i < 4; ++i) {
    const ExrFilePart& part = parts[i + 1];
    const json& wavefront = summary["results"][i]["wavefront"];
    EXPECT_EQ(part.name, fmt::format("wavefront.field{}.{}nm", i / 2, i % 2 == 0 ? 550 : 633));
    const auto& opd = part.floats.at("Y");
    const auto& mask = part.counts.at("wavefront.mask");
    ASSERT_EQ(opd.size(), 64u * 64u);
    int ok = 0, clipped = 0, inside = 0;
    double sum = 0, squares = 0, low = INFINITY, high = -INFINITY;
    for (std::size_t k = 0; k < opd.size(); ++k) {
      EXPECT_EQ(std::isnan(opd[k]), mask[k] != 0);
      inside += mask[k] != 255, clipped += mask[k] == 2;
      if (mask[k] == 0) ++ok, sum += opd[k], squares += static_cast<double>(opd[k]) * opd[k], low = std::min<double>(low, opd[k]), high = std::max<double>(high, opd[k]);
    }
    EXPECT_EQ(inside, 3001);
    EXPECT_GT(clipped, 60);
    EXPECT_EQ(ok, wavefront["samples"].get<int>());
    // the floats' rounding of some waves: 1e-6
    EXPECT_NEAR(std::sqrt(squares / ok - sum / ok * sum / ok), wavefront["rms_waves"].get<double>(), 1e-5);
    EXPECT_NEAR(high - low, wavefront["peak_to_valley_waves"].get<double>(), 1e-5);
    EXPECT_EQ(part.text("units.Y"), "waves");
    EXPECT_THAT(part.text("sign"), HasSubstr("OPL(chief ray) - OPL(ray)"));
    // The middle of the picture, as for spots: half a pixel before the chief ray's sample, which is at column 32, row 31.
    EXPECT_FLOAT_EQ(part.pair("pixel_size_mm").x, 4.0f / 31);
    EXPECT_FLOAT_EQ(part.pair("centre_mm").x, -2.0f / 31);
    EXPECT_FLOAT_EQ(part.pair("centre_mm").y, -2.0f / 31);
    EXPECT_EQ(part.number("wavelength_nm"), i % 2 == 0 ? 550 : 633);
    EXPECT_EQ(part.number("rays_launched"), 3001);
  }
}

TEST(TraceCommand, gives_the_same_bytes_for_any_thread_count) {
  const Folder folder;
  const std::string system = folder.file("lens.yaml", lens);
  ASSERT_EQ(run_program("trace " + system + " -o " + folder.path("1") + " --threads 1").status, 0);
  ASSERT_EQ(run_program("trace " + system + " -o " + folder.path("2") + " --threads 2").status, 0);
  ASSERT_EQ(run_program("trace " + system + " -o " + folder.path("3") + " --threads 3", "SAGITTA_ISA=x86-64 ").status, 0);
  for (const std::string& file : files_in(folder.path("1")))
    for (const char* other : {"2/", "3/"}) EXPECT_TRUE(read_text(folder.path("1/" + file)) == read_text(folder.path(other + file))) << other << file;
}

TEST(TraceCommand, exit_status_tells_wrong_usage_from_wrong_input) {
  const Folder folder;
  const std::string system = folder.file("lens.yaml", lens), out = " -o " + folder.path("out");
  for (const std::string& arguments : std::vector<std::string>{"", "trace", "trace " + system, "trace" + out, "trace " + system + out + " --only spots", "trace " + system + out + " --rays 0",
                                      "trace " + system + out + " --rays many", "trace " + system + out + " --pattern hexagonal", "trace " + system + out + " --pattern random:x",
                                      "trace " + system + out + " --threads 0", "trace " + system + out + " --nonsense", "trase " + system}) {
    const Outcome run = run_program(arguments);
    EXPECT_EQ(run.status, 2) << arguments;
    EXPECT_NE(run.err, "") << arguments;
    EXPECT_EQ(run.out, "") << arguments;
  }
  EXPECT_EQ(files_in(folder.path("out")).size(), 0u);
  EXPECT_EQ(run_program("--help").status, 0);
  EXPECT_EQ(run_program("trace --help").status, 0);
  EXPECT_EQ(run_program("--version").status, 0);
  EXPECT_EQ(run_program("trace " + folder.path("none.yaml") + out).status, 1);
  EXPECT_EQ(run_program("trace " + folder.file("bad.yaml", "sagitta: 1\n") + out).status, 1);
}

TEST(TraceCommand, says_that_not_one_ray_arrived) {
  const Folder folder;
  std::string dark = lens;
  dark.replace(dark.find("inner_semi_diameter_mm: 0.7"), 27, "inner_semi_diameter_mm: 20");
  const Outcome run = run_program("trace " + folder.file("dark.yaml", dark) + " -o " + folder.path("out") + " --rays 100");
  EXPECT_EQ(run.status, 1);
  EXPECT_THAT(run.err, HasSubstr("not one ray arrived"));
  const json summary = json::parse(read_text(folder.path("out/summary.json")));  // the counts are there all the same
  EXPECT_EQ(summary["results"][0]["rays"]["clipped"], 127);
  EXPECT_TRUE(summary["results"][0]["spot"]["rms_radius_mm"].is_null());
  EXPECT_TRUE(summary["results"][0]["wavefront"].is_null());
  EXPECT_NE(summary["results"][0]["reason"], "");
  EXPECT_EQ(read_text(folder.path("out/summary.json")).find("nan"), std::string::npos);
  // the same for the rays of the wavefront's grid
  const Outcome wavefront = run_program("trace " + folder.path("dark.yaml") + " -o " + folder.path("out") + " --only wavefront --json");
  EXPECT_EQ(wavefront.status, 1);
  EXPECT_EQ(json::parse(wavefront.out)["results"][0]["rays"]["clipped"], 3001);
}

TEST(TraceCommand, an_afocal_system_has_spots_and_a_reason_for_no_wavefront) {
  const Folder folder;
  const std::string system = folder.file("afocal.yaml", "sagitta: 1\nwavelengths_nm: [550]\naperture: {entrance_pupil_diameter_mm: 4}\nsurfaces:\n  - {stop: true, thickness_mm: 4, medium: {index: 1.5}}\n"
                                                        "  - {thickness_mm: 4}\n  - {}\n");
  for (const std::string only : {"", " --only wavefront"}) {
    const Outcome run = run_program("trace " + system + " -o " + folder.path("out") + " --json" + only);
    EXPECT_EQ(run.status, 0) << run.err;
    const json summary = json::parse(run.out);
    EXPECT_TRUE(summary["first_order"]["effective_focal_length_mm"].is_null());
    EXPECT_TRUE(summary["results"][0]["wavefront"].is_null());
    EXPECT_EQ(summary["results"][0]["reason"], "the image is afocal");
    const auto parts = read_exr(folder.path("out/wavefront.exr"));
    EXPECT_EQ(parts.size(), 1u);  // the preview says so
  }
}

TEST(TraceCommand, a_folder_that_cannot_be_written_is_an_error) {
  const Folder folder;
  const std::string system = folder.file("lens.yaml", lens), file = folder.file("file", "x");
  for (const std::string& out : std::vector<std::string>{file, file + "/sub", "/proc/sagitta-test"}) {
    const Outcome run = run_program("trace " + system + " -o " + out + " --rays 10");
    EXPECT_EQ(run.status, 1) << out;
    EXPECT_THAT(run.err, HasSubstr(out)) << out;
  }
  EXPECT_EQ(read_text(file), "x");
  // a folder in the place of one of the files
  std::filesystem::create_directories(folder.path("out/spot.exr"));
  const Outcome run = run_program("trace " + system + " -o " + folder.path("out") + " --rays 10");
  EXPECT_EQ(run.status, 1);
  EXPECT_THAT(run.err, HasSubstr("spot.exr"));
}

TEST(TraceCommand, traces_every_shipped_system) {
  const Folder folder;
  const bool has_cgal = run_program("--version").out.find("by CGAL") != std::string::npos;
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(SAGITTA_SOURCE_DIR "/systems")) {
    if (entry.path().extension() != ".yaml") continue;
    ++count;
    const Outcome run = run_program("trace " + entry.path().string() + " -o " + folder.path("out") + " --rays 200 --json");
    if (!has_cgal && run.err.find("without CGAL") != std::string::npos) continue;
    EXPECT_EQ(run.status, 0) << entry.path() << run.err;
    EXPECT_EQ(run.err, "") << entry.path();
    const json summary = json::parse(run.out);
    for (const json& result : summary["results"]) EXPECT_TRUE(result["wavefront"].is_object()) << entry.path();
  }
  EXPECT_GE(count, 8);
}

}  // namespace
}  // namespace sagitta::test
