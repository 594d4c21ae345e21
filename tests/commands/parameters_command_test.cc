// SPDX-License-Identifier: Apache-2.0
// --set on every command that reads a system, and the two eyes that accommodate, against their published figures (references.md, E11
// and E16; a tolerance of 1e-3 D, and of half a unit of the last printed digit for the relaxed Arizona eye).
#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"

namespace sagitta::test {
namespace {

using nlohmann::json;

const std::string arizona = SAGITTA_SOURCE_DIR "/systems/arizona-eye.yaml", navarro = SAGITTA_SOURCE_DIR "/systems/navarro-accommodating-eye.yaml";

std::string at(double accommodation) { return fmt::format(" --set accommodation_D={}", accommodation); }

json summary(const std::string& system, double accommodation) {
  const Folder folder;
  const Outcome run = run_program("trace " + system + " -o " + folder.path("out") + " --json --only spot --rays 1" + at(accommodation));
  EXPECT_EQ(run.status, 0) << run.err;
  return json::parse(run.out);
}

// In D, at the vertex of the cornea: 1 over the distance of the point whose paraxial image is on the retina, by Newton's form of the
// image equation, (z - F) (z' - F') = f f'. Positive: behind the eye.
double refraction(const json& summary, double retina_mm) {
  const json& o = summary["first_order"];
  const double f = o["front_focal_length_mm"], f_rear = o["rear_focal_length_mm"], F = o["focal_points_z_mm"][0], F_rear = o["focal_points_z_mm"][1];
  const double beyond = retina_mm - F_rear;
  return 1000 * beyond / (F * beyond + f * f_rear);
}

TEST(Parameters, the_arizona_eye_has_its_power_and_refractions) {  // E11
  const json relaxed = summary(arizona, 0);
  const double focal_length = relaxed["first_order"]["effective_focal_length_mm"];
  EXPECT_NEAR(focal_length, 16.495479, 5e-7);
  EXPECT_NEAR(1000 / focal_length, 60.622671, 5e-7);
  EXPECT_NEAR(refraction(relaxed, 24), -0.0072, 1e-3);
  EXPECT_NEAR(refraction(summary(arizona, 2), 24), -1.9938, 1e-3);
  EXPECT_NEAR(refraction(summary(arizona, 8), 24), -8.0614, 1e-3);
}

TEST(Parameters, the_navarro_eye_accommodates_as_published) {  // E16
  const double retina_mm = 24.00398, relaxed = refraction(summary(navarro, 0), retina_mm);
  const struct {
    double parameter, achieved;
  } cases[] = {{1, 1.2216}, {2, 2.1899}, {4, 3.9230}, {6, 5.6461}, {8, 7.4841}, {10, 9.5010}};
  EXPECT_NEAR(relaxed, 0, 1e-3);
  for (const auto& one : cases) EXPECT_NEAR(relaxed - refraction(summary(navarro, one.parameter), retina_mm), one.achieved, 1e-3) << one.parameter;
}

TEST(Parameters, what_is_set_stands_in_every_result) {
  const Folder folder;
  const std::string name = "Arizona eye, accommodation_D = 2.5";
  const json s = summary(arizona, 2.5);
  EXPECT_EQ(s["system"], name);
  EXPECT_EQ(s["parameters"], (json{{"accommodation_D", 2.5}}));
  EXPECT_TRUE(run_program("check " + arizona + at(2.5)).out.find("\n" + name + ": 6 surfaces") != std::string::npos);
  EXPECT_TRUE(run_program("explain " + arizona + at(2.5)).out.starts_with(name + "\n"));
  EXPECT_TRUE(run_program("verify " + arizona + " --rays 1" + at(2.5)).out.starts_with(name));
  EXPECT_TRUE(run_program("trace " + arizona + " --rays 1 -o " + folder.path("t") + at(2.5)).out.starts_with(name + "\n"));
  const json compared = json::parse(run_program("compare " + arizona + " " + navarro + " --rays 1 --json -o " + folder.path("c") + at(2.5)).out);
  EXPECT_EQ(compared["systems"][0]["parameters"], (json{{"accommodation_D", 2.5}}));
  EXPECT_EQ(compared["systems"][1]["system"], "Navarro accommodating eye, accommodation_D = 2.5");
  EXPECT_NE(run_program("rays " + arizona + at(2.5)).out, run_program("rays " + arizona).out);
  EXPECT_EQ(run_program("rays " + arizona + at(0)).out, run_program("rays " + arizona).out);
}

TEST(Parameters, a_study_of_a_system_takes_them) {
  const Folder folder;
  const std::string flat = folder.file("flat.yaml", "sagitta: 1\nname: lens\nparameters: {R: 50}\nwavelengths_nm: [550]\naperture: {entrance_pupil_diameter_mm: 2}\nsurfaces:\n"
                                                    "  - {stop: true, conic: {radius_mm: = R}, thickness_mm: 100, medium: {index: 1.5}}\n  - {}\n");
  const Outcome run = run_program("study --system " + flat + " --set R=40 -o " + folder.path("s"));
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_TRUE(run.out.starts_with("lens, R = 40: ")) << run.out;
  EXPECT_EQ(run_program("study lens --set R=40 -o " + folder.path("l")).status, 2);
}

TEST(Parameters, a_system_without_them_says_nothing_of_them) {
  const Folder folder;
  const Outcome run = run_program("trace " SAGITTA_SOURCE_DIR "/systems/navarro-eye.yaml --json --only spot --rays 1 -o " + folder.path("out"));
  EXPECT_FALSE(json::parse(run.out).contains("parameters"));
}

TEST(Parameters, a_setting_that_means_nothing_is_wrong_usage) {
  const Folder folder;
  const auto usage = [&](const std::string& arguments, const std::string& message) {
    const Outcome run = run_program(arguments);
    EXPECT_EQ(run.status, 2) << arguments;
    EXPECT_NE(run.err.find(message), std::string::npos) << run.err;
    EXPECT_EQ(run.out, "") << arguments;
  };
  const std::string unknown = "--set acommodation_D: error: " + arizona + " declares no such parameter\n  hint: did you mean 'accommodation_D'?\n";
  for (const std::string& command : {"check " + arizona, "explain " + arizona, "verify " + arizona, "rays " + arizona, "trace " + arizona + " -o " + folder.path("out"),
                                     "study --system " + arizona + " -o " + folder.path("out"), "compare " + navarro + " " + arizona + " -o " + folder.path("out")})
    usage(command + " --set acommodation_D=1", unknown);
  EXPECT_FALSE(std::filesystem::exists(folder.path("out")));
  for (const char* text : {"accommodation_D", "accommodation_D=", "accommodation_D=x", "=1", "accommodation_D=nan", "accommodation_D=inf", "accommodation_D=1D", "accommodation_D=0x10"})
    usage("check " + arizona + " --set " + text, fmt::format("--set: {}: expected NAME=VALUE with a number", text));
  usage("check " + arizona + " --set accommodation_D=1 --set accommodation_D=2", "accommodation_D is set twice");
  EXPECT_EQ(run_program("check --set accommodation_D=1 " + arizona).status, 0);  // takes no further argument
  EXPECT_EQ(run_program("check " + navarro + " --set accommodation_D=-1").status, 1);  // ln(0): a value that the system cannot have
}

// A parameter has no range, but what is made of it has: the message names the key, what it came to, and the expression.
TEST(Parameters, a_value_out_of_all_proportion_is_told_where_it_is_used) {
  for (const std::string& command : {"check " + arizona, "refraction " + arizona, "rays " + arizona}) {
    const Outcome run = run_program(command + at(1e9));
    EXPECT_EQ(run.status, 1) << command;
    EXPECT_NE(run.err.find("error: nd must be a number from 0.001 to 1000, not -219999997439998.6, what '= 1.42 + 0.00256 * accommodation_D - 0.0...' comes to\n"), std::string::npos) << run.err;
  }
  const Outcome beyond = run_program("check " + arizona + " --set accommodation_D=1e101");
  EXPECT_EQ(beyond.status, 2);
  EXPECT_EQ(beyond.err, "--set accommodation_D: error: a parameter must be at most 1e+100 in size, not 1e+101\n");
}

TEST(Schema, is_printed_whole) {
  const Outcome run = run_program("schema");
  EXPECT_EQ(run.status, 0);
  const json schema = json::parse(run.out);
  EXPECT_EQ(schema["$schema"], "http://json-schema.org/draft-07/schema#");
  EXPECT_TRUE(schema["properties"].contains("parameters"));
  EXPECT_EQ(run_program("schema extra").status, 2);
}

}  // namespace
}  // namespace sagitta::test
