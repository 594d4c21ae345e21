// SPDX-License-Identifier: Apache-2.0
// What the program says it is, and what it takes from the machine before the first ray: the libraries and files that it needs, and
// no others.
#include <gmock/gmock.h>
#include <sys/inotify.h>
#include <unistd.h>

#include <array>
#include <set>

#include "lib/numerics/instruction_set.h"
#include "tests/support/program.h"

namespace sagitta::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::MatchesRegex;
using ::testing::Not;
using ::testing::StartsWith;

const std::string triplet = SAGITTA_SOURCE_DIR "/systems/cooke-triplet.yaml";

TEST(Version, lists_what_is_in_and_the_licence_of_the_whole) {
  const Outcome run = run_program("--version");
  EXPECT_EQ(run.status, 0);
  EXPECT_EQ(run.err, "");
  EXPECT_THAT(run.out, MatchesRegex("sagitta [0-9]+\\.[0-9]+\\.[0-9]+\n"
                                    "build             [A-Z].*, [A-Z].* [0-9]+\\.[0-9.]+\n"
                                    "instruction sets  .*\n"
                                    "delaunay          .*CGAL.*\n"
                                    "libraries         .*\n"
                                    "for pictures      .*\n"
                                    "licence           (GPL-3.0-or-later|Apache-2.0).*\n"));
  // CMake has found a version of each
  for (const char* library : {"Eigen", "fmt", "yaml-cpp", "nlohmann-json", "CLI11", "cairo", "OpenEXR", "libpng", "libdeflate"})
    EXPECT_THAT(run.out, testing::ContainsRegex(std::string(library) + " [0-9]+\\.[0-9]")) << library;
  EXPECT_EQ(run.out.find("by CGAL") == std::string::npos, run.out.find("licence           GPL") == std::string::npos);
}

TEST(Version, names_the_instructions_that_are_forced) {
#if !defined(SAGITTA_CHOOSES_INSTRUCTIONS)
  GTEST_SKIP() << "no choice of instructions in this build";
#endif
  EXPECT_THAT(run_program("--version", "SAGITTA_ISA=x86-64 ").out, HasSubstr("; here x86-64\n"));
  EXPECT_EQ(run_program("--version", "SAGITTA_ISA= ").out, run_program("--version").out);
  // 2026-11-22: taken for x86-64-v3
  const Outcome misspelt = run_program("--version", "SAGITTA_ISA=x86-64-v2 ");
  EXPECT_EQ(misspelt.status, 2);
  EXPECT_EQ(misspelt.err, "sagitta: SAGITTA_ISA is 'x86-64-v2'\n  hint: it may be x86-64, x86-64-v3, x86-64-v4\n");
}

// `--version` and `--help` on a full disk ended with 0 (2026-11-22): CLI11 prints them on its way out.
TEST(Program, says_that_standard_output_is_full) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full on this machine";
  const Folder folder;
  for (const char* arguments : {"--version", "--help", "check systems/cooke-triplet.yaml", "rays systems/cooke-triplet.yaml"}) {
    const Outcome run = run_program(std::string(arguments) + " >/dev/full 2>'" + folder.path("err") + "' #", "cd '" SAGITTA_SOURCE_DIR "' && ");
    EXPECT_EQ(run.status, 1) << arguments;
    EXPECT_TRUE(read_text(folder.path("err")).starts_with("sagitta: standard output cannot be written: ")) << arguments << '\n' << read_text(folder.path("err"));
  }
}

TEST(StartUp, loads_the_libraries_of_pictures_with_the_first_picture) {
  const Folder folder;
  const auto loaded_by = [](const std::string& arguments) { return run_program(arguments, "LD_DEBUG=files ").err; };
  const auto of_pictures = AllOf(HasSubstr("libcairo.so"), HasSubstr("libOpenEXRCore"), HasSubstr("libpng"), HasSubstr("libdeflate.so"), Not(HasSubstr("libOpenEXR-")));
  EXPECT_THAT(loaded_by("trace " + triplet + " --rays 50 -o " + folder.path("out")), of_pictures);
  for (const std::string& arguments : {std::string("--version"), "check " + triplet, "rays " + triplet}) {
    const std::string loaded = loaded_by(arguments);
    EXPECT_THAT(loaded, HasSubstr("libyaml-cpp")) << "the loader has said nothing";
    for (const char* library : {"libcairo", "libdeflate", "libOpenEXR", "libpng", "libfreetype", "libX11", "sagitta_pictures"}) EXPECT_THAT(loaded, Not(HasSubstr(library))) << arguments;
  }
}

TEST(StartUp, without_the_module_of_pictures_says_so_and_still_writes_the_numbers) {
  const Folder folder;
  const std::string program = folder.path("sagitta");
  std::filesystem::copy_file(SAGITTA_PROGRAM, program);
  folder.file("libsagitta_pictures.so", "no library");
  const Outcome run = run_program("trace " + triplet + " --rays 50 -o " + folder.path("out"), {}, program.c_str());
  EXPECT_EQ(run.status, 1);
  EXPECT_THAT(run.err, StartsWith("sagitta trace: no picture can be made: " + folder.path("libsagitta_pictures.so")));
  EXPECT_THAT(run.err, HasSubstr("\n  hint: the module belongs beside the program"));
  EXPECT_EQ(run.err.find("no picture"), run.err.rfind("no picture"));
  EXPECT_THAT(read_text(folder.path("out/summary.json")), HasSubstr("rms_radius_mm"));
  EXPECT_FALSE(std::filesystem::exists(folder.path("out/spot.png")));
}

// What is opened in `folder` while the program runs: names, and "." for the folder itself, which a scan opens.
std::set<std::string> opened_in(const std::string& folder, const std::string& arguments) {
  const int watcher = inotify_init1(IN_NONBLOCK);
  EXPECT_GE(inotify_add_watch(watcher, folder.c_str(), IN_OPEN), 0);
  const Outcome run = run_program(arguments);
  EXPECT_EQ(run.status, 0) << run.err;
  std::set<std::string> names;
  alignas(inotify_event) std::array<char, 1 << 16> buffer{};
  const auto size = static_cast<std::ptrdiff_t>(read(watcher, buffer.data(), buffer.size()));
  for (std::ptrdiff_t at = 0; at < size;) {
    const auto* event = reinterpret_cast<const inotify_event*>(buffer.data() + at);
    names.insert(event->len > 0 ? event->name : ".");
    at += static_cast<std::ptrdiff_t>(sizeof(inotify_event) + event->len);
  }
  close(watcher);
  return names;
}

TEST(StartUp, opens_the_materials_that_are_named_and_no_others) {
  const Folder folder;
  const std::string materials = folder.path("materials");
  std::filesystem::copy(SAGITTA_SOURCE_DIR "/materials", materials);
  const std::string system = folder.file("lens.yaml", "sagitta: 1\nwavelengths_nm: [587.6]\naperture: {entrance_pupil_diameter_mm: 5}\nsurfaces:\n"
                                                      "  - {stop: true, conic: {radius_mm: 50}, thickness_mm: 4, medium: N-BK7}\n"
                                                      "  - {conic: {radius_mm: -50}, thickness_mm: 40}\n  - {}\n");
  EXPECT_EQ(opened_in(materials, "check " + system), std::set<std::string>{"N-BK7.yml"});
  EXPECT_EQ(opened_in(folder.path(), "rays " + system), std::set<std::string>{"lens.yaml"});
}

}  // namespace
}  // namespace sagitta::test
