// SPDX-License-Identifier: Apache-2.0
// The JSON Schema and the reader say the same: of the keys at every level, which the reader itself lists, and of values, by an
// independent validator (python3-jsonschema with python3-yaml, where they are installed).
#include "lib/prescription/schema.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "lib/prescription/keys.h"
#include "tests/prescription/support.h"

namespace sagitta::prescription {
namespace {

using nlohmann::json;

const json& schema() {
  static const json parsed = json::parse(json_schema());
  return parsed;
}

std::set<std::string> keys_of_schema(const json& mapping) {
  EXPECT_EQ(mapping.at("additionalProperties"), false);
  std::set<std::string> keys;
  for (const auto& [key, value] : mapping.at("properties").items()) {
    EXPECT_FALSE(value.at("description").get<std::string>().empty()) << key;
    EXPECT_GT(value.size(), 1u) << key << " has no kind of value";
    keys.insert(key);
  }
  return keys;
}

// What the reader lists as its keys where it finds one that it does not know.
std::set<std::string> keys_of_reader(const std::string& text) {
  const std::string begin = "the keys here are: ";
  const ReadResult read = test::read_text(text);
  for (const Finding& finding : read.findings.all()) {
    if (finding.what.find("unknown key 'qqqqqqqqqqqqqqqq'") == std::string::npos) continue;
    std::set<std::string> keys;
    if (!finding.hint.starts_with(begin)) return keys;
    std::string rest = finding.hint.substr(begin.size()) + ", ";
    for (std::size_t at; (at = rest.find(", ")) != std::string::npos; rest.erase(0, at + 2)) keys.insert(rest.substr(0, at));
    return keys;
  }
  ADD_FAILURE() << text;
  return {};
}

TEST(Schema, HasAtEveryLevelTheKeysOfTheReader) {
  const std::string unknown = "qqqqqqqqqqqqqqqq: 1";
  const json &top = schema().at("properties"), &surface = schema().at("definitions").at("surface"), &medium = schema().at("definitions").at("medium");
  const auto with_surface = [](const std::string& inside) { return "surfaces: [{" + inside + "}, {}]\n"; };
  EXPECT_EQ(keys_of_schema(schema()), keys_of_reader(unknown));
  for (const char* level : {"aperture", "fields", "object"})
    EXPECT_EQ(keys_of_schema(top.at(level)), keys_of_reader(std::string(level) + ": {" + unknown + "}")) << level;
  EXPECT_EQ(keys_of_schema(surface), keys_of_reader(with_surface(unknown)));
  EXPECT_EQ(keys_of_schema(medium.at("anyOf").at(1)), keys_of_reader(with_surface("medium: {" + unknown + "}")));
  const json& grin = medium.at("anyOf").at(1).at("properties").at("grin");
  EXPECT_EQ(keys_of_schema(grin), keys_of_reader(with_surface("medium: {grin: {" + unknown + "}}")));
  for (const ShapeKind& kind : gradient_kinds())
    EXPECT_EQ(keys_of_schema(grin.at("properties").at(std::string(kind.name))), keys_of_reader(with_surface("medium: {grin: {" + std::string(kind.name) + ": {" + unknown + "}}}"))) << kind.name;
  for (const ShapeKind& kind : shape_kinds())
    EXPECT_EQ(keys_of_schema(surface.at("properties").at(std::string(kind.name))), keys_of_reader(with_surface(std::string(kind.name) + ": {" + unknown + "}"))) << kind.name;
}

// Whether there is what checks YAML files against the schema.
bool has_validator() { return std::system("python3 -c 'import jsonschema, yaml' 2>/dev/null") == 0; }

// By the name of the file; of those in `folder` that end with .yaml.
std::map<std::string, bool> verdicts(const test::TemporaryFolder& here, const std::string& folder) {
  const std::string script = here.write("validate.py", R"(import glob, json, os, sys
import jsonschema, yaml
schema = json.load(open(sys.argv[1]))
jsonschema.Draft7Validator.check_schema(schema)
validator = jsonschema.Draft7Validator(schema)
def as_json(value):  # keys are texts there, and YAML 1.1 takes 1e3 for one
    if isinstance(value, dict): return {str(key): as_json(one) for key, one in value.items()}
    if isinstance(value, list): return [as_json(one) for one in value]
    if isinstance(value, str):
        try: return float(value)
        except ValueError: return value
    return value
for file in sorted(glob.glob(sys.argv[2] + '/*.yaml')):
    print(os.path.basename(file), int(validator.is_valid(as_json(yaml.safe_load(open(file))))))
)");
  const std::string out = here.path() + "/verdicts";
  EXPECT_EQ(std::system(fmt::format("python3 '{}' '{}' '{}' > '{}'", script, here.write("schema.json", json_schema()), folder, out).c_str()), 0);
  std::map<std::string, bool> result;
  std::ifstream stream(out);
  std::string name;
  for (bool is_valid = false; stream >> name >> is_valid;) result[name] = is_valid;
  return result;
}

TEST(Schema, TakesEveryShippedSystem) {
  if (!has_validator()) GTEST_SKIP() << "python3-jsonschema and python3-yaml are not installed";
  const test::TemporaryFolder folder;
  const auto found = verdicts(folder, SAGITTA_SOURCE_DIR "/systems");
  EXPECT_GE(found.size(), 12u);
  for (const auto& [name, is_valid] : found) EXPECT_TRUE(is_valid) << name;
}

// Files of bad/ whose fault is one of structure.
TEST(Schema, RefusesWhatTheReaderRefuses) {
  if (!has_validator()) GTEST_SKIP() << "python3-jsonschema and python3-yaml are not installed";
  const test::TemporaryFolder folder, files;
  const std::set<std::string> names{"unknown_key", "two_shapes", "two_apertures", "two_kinds_of_fields", "no_stop", "stop_is_false", "missing_keys", "several_findings", "bad_medium", "bad_field", "no_field",
                                    "wrong_type", "wrong_type_in_surface", "infinite", "bad_zernike", "one_surface", "no_surfaces", "no_aperture", "bad_aperture", "no_wavelength", "wrong_version",
                                    "object_at_zero", "bad_delaunay", "bad_parameters", "parameters_in_a_list", "not_a_mapping", "unit_in_number"};
  for (const std::string& name : names)
    std::filesystem::copy_file(fmt::format("{}/tests/prescription/bad/{}.yaml", SAGITTA_SOURCE_DIR, name), fmt::format("{}/{}.yaml", files.path(), name));
  const auto found = verdicts(folder, files.path());
  EXPECT_EQ(found.size(), names.size());
  for (const auto& [name, is_valid] : found) EXPECT_FALSE(is_valid) << name;
}

// Every key with every kind of value, right and wrong: the schema takes what the reader takes.
TEST(Schema, TakesTheValuesThatTheReaderTakes) {
  if (!has_validator()) GTEST_SKIP() << "python3-jsonschema and python3-yaml are not installed";
  const auto system = [](const std::string& lines, const std::string& surface) {
    return "sagitta: 1\nwavelengths_nm: [550]\n" + lines + "surfaces:\n  - {stop: true, thickness_mm: 1}\n  - {name: two, " + surface + ", thickness_mm: 2}\n  - {}\n";
  };
  const std::string pupil = "aperture: {entrance_pupil_diameter_mm: 4}\n", plane = "plane: {}";
  // A system around "KEY: VALUE".
  const auto around = [&](const std::string& level, const std::string& with) {
    if (level == "top") return system(pupil + with + "\n", plane);
    if (level == "aperture") return system("aperture: {" + with + "}\n" + (with.starts_with("object_na") ? "object: {distance_mm: 100, medium: {index: 9}}\n" : ""), plane);
    if (level == "object") return system(pupil + "object: {" + with + "}\n", plane);
    if (level == "surface") return system(pupil, with);
    if (level == "medium") return system(pupil, "medium: {" + with + (with.starts_with("nd") ? ", vd: 50" : with.starts_with("vd") ? ", nd: 1.5" : with.starts_with("reference_nm") ? ", index: 1.5, dispersion: {index: 1.4}" :
                                                      with.starts_with("dispersion") ? ", index: 1.5, reference_nm: 550" : "") + "}");
    static const std::map<std::string, std::vector<std::string>> required{{"conic", {"radius_mm: 5"}}, {"zernike", {"normalization_radius_mm: 3", "indexing: osa", "coefficients_um: [1]"}},
                                                                          {"asphere", {"radius_mm: 5"}}, {"xy_polynomial", {"coefficients: [1]"}}, {"delaunay", {"points: points.xyz", "interpolation: multiquadric"}}};
    std::string others;
    for (const std::string& one : required.at(level))
      if (!with.starts_with(one.substr(0, one.find(' ')))) others += one + ", ";
    return system(pupil, level + ": {" + others + with + "}");
  };
  struct Level {
    std::string name;
    KeyTable keys;
  };
  std::vector<Level> levels{{"top", system_keys}, {"aperture", aperture_section_keys}, {"object", object_keys}, {"surface", surface_keys}, {"medium", medium_keys}};
  for (const ShapeKind& kind : shape_kinds())
    if (kind.name == "conic" || kind.name == "zernike" || kind.name == "delaunay" || kind.name == "asphere" || kind.name == "xy_polynomial") levels.push_back({std::string(kind.name), kind.keys});
  const test::TemporaryFolder folder, files;
  files.write("points.xyz", "0 0 0\n1 0 0\n0 1 0\n1 1 0\n");
  std::map<std::string, std::string> written;
  std::map<std::string, bool> taken;
  int count = 0;
  for (const auto& [level, keys] : levels)
    for (const numerics::Key& key : keys) {
      using numerics::ValueKind;
      // Those that stand there already, and what depends on other files.
      const bool is_there = key.name == "sagitta" || key.name == "wavelengths_nm" || key.name == "aperture" || key.name == "surfaces" || key.name == "thickness_mm" || key.name == "stop" || (level == "surface" && key.name == "name");
      if (is_there || key.kind == ValueKind::file || key.name == "parameters" || !key.choices.empty()) continue;
      for (const char* value : {"text", "-1", "0", "0.5", "1.5", "2", ".inf", "-.inf", "1e101", "-1e120", "1e-101", "[1]", "[1, 2, 3]", "[[1, 2]]", "[1, [2]]", "{a: 1}", "{3: 1}", "true", "'= 2'", "''"}) {
        if ((key.kind == ValueKind::medium || key.kind == ValueKind::homogeneous_medium) && std::string_view(value) != "0.5" && value[0] != '[') continue;
        if (std::string_view(value) == "'= 2'" && !key.range.contains(2)) continue;  // nor work out
        const std::string name = fmt::format("{}.yaml", ++count), text = around(level, fmt::format("{}: {}", key.name, value));
        const bool is_taken = !read_prescription(files.write(name, text)).findings.has_errors();
        written[name] = text;
        taken[name] = is_taken;
      }
    }
  const auto found = verdicts(folder, files.path());
  EXPECT_EQ(found.size(), static_cast<std::size_t>(count));
  EXPECT_GT(count, 400);
  EXPECT_GT(std::count_if(taken.begin(), taken.end(), [](const auto& one) { return one.second; }), 100);
  for (const auto& [name, is_valid] : found) EXPECT_EQ(is_valid, taken[name]) << written[name] << (taken[name] ? "" : test::text_of(read_prescription(files.path() + "/" + name).findings));
}

// What the schema once took and the reader did not, a fault each, beside the nearest that both take.
TEST(Schema, AgreesWithTheReaderAtTheEdges) {
  if (!has_validator()) GTEST_SKIP() << "python3-jsonschema and python3-yaml are not installed";
  const auto system = [](const std::string& lines, const std::string& surface) {
    return "sagitta: 1\naperture: {entrance_pupil_diameter_mm: 4}\n" + lines + "surfaces:\n  - {stop: true, thickness_mm: 1}\n  - {" + surface + ", thickness_mm: 2}\n  - {}\n";
  };
  const std::string green = "wavelengths_nm: [550]\n";
  std::vector<std::pair<std::string, bool>> cases;  // with what both say
  const auto surface = [&](const std::string& one, bool is_taken) { cases.emplace_back(system(green, one), is_taken); };
  const auto top = [&](const std::string& one, bool is_taken) { cases.emplace_back(system(one, "plane: {}"), is_taken); };
  const auto indices = [&](const std::string& before, const std::string& after, std::vector<std::string> taken, std::vector<std::string> refused) {
    for (const std::string& one : taken) surface(before + one + ": 1e-9" + after, true);
    for (const std::string& one : refused) surface(before + one + ": 1e-9" + after, false);
  };
  const auto zernike = [&](const std::string& indexing) { return "zernike: {normalization_radius_mm: 3, indexing: " + indexing + ", coefficients_um: {"; };
  indices(zernike("osa"), "}}", {"0", "1", "37", "5150"}, {"-1", "5151", "100000", "1.5", "a"});
  indices(zernike("noll"), "}}", {"1", "38", "5151"}, {"0", "5152"});
  indices(zernike("fringe"), "}}", {"1", "37"}, {"0", "38"});
  indices("asphere: {radius_mm: 9, coefficients: {", "}}", {"2", "3", "40"}, {"0", "1", "41"});
  indices("xy_polynomial: {coefficients: {", "}}", {"1", "230"}, {"0", "231"});
  indices("toroid: {radius_mm: 9, radius_rotation_mm: 8, coefficients: {", "}}", {"2", "40"}, {"1", "41"});
  indices("medium: {grin: {polynomial: {index: 1.4, z_coefficients: {", "}}}}", {"1", "2", "12"}, {"0", "13"});
  indices("medium: {grin: {polynomial: {index: 1.4, r_coefficients: {", "}}}}", {"2", "10", "12"}, {"0", "1", "3", "11", "13", "14"});
  const auto list_of = [](int count) {
    std::string text = "[0";
    for (int i = 1; i < count; ++i) text += ", 0";
    return text + "]";
  };
  for (const int count : {37, 38}) surface("zernike: {normalization_radius_mm: 3, indexing: fringe, coefficients_um: " + list_of(count) + "}", count == 37);
  for (const int count : {230, 231}) surface("xy_polynomial: {coefficients: " + list_of(count) + "}", count == 230);
  surface("asphere: {radius_mm: 9, coefficients: [0]}", false);
  for (const auto& [radius, is_taken] : std::vector<std::pair<std::string, bool>>{{"1e+100", true}, {"1e+101", false}, {"-1e+101", false}, {".inf", true}, {"-.inf", true}, {"1e-100", true}, {"1e-101", false}, {"-1e-101", false}, {"0", false}})
    surface("conic: {radius_mm: " + radius + "}", is_taken);
  surface("medium: N-BK7", true);
  surface("medium: ''", false);
  surface("medium: mirror", true);
  const auto disperses = [&](const std::string& as, bool is_taken) { surface("medium: {index: 1.5, reference_nm: 550, dispersion: " + as + "}", is_taken); };
  disperses("N-BK7", true);
  disperses("{index: 1.4}", true);
  disperses("mirror", false);
  disperses("''", false);
  disperses("{grin: {luneburg: {radius_mm: 1}}}", false);
  for (const auto& [medium, is_taken] : std::vector<std::pair<std::string, bool>>{{"N-BK7", true}, {"{nd: 1.5, vd: 50}", true}, {"mirror", false}, {"{grin: {maxwell: {index: 1.5, radius_mm: 10}}}", false}})
    top(green + "object: {distance_mm: 100, medium: " + medium + "}\n", is_taken);
  for (const auto& [name, is_taken] : std::vector<std::pair<std::string, bool>>{{"square", true}, {"sqrt", false}, {"max", false}, {"sin_deg", false}, {"sin", true}, {"_a", false}})
    cases.emplace_back(system(green + "parameters: {" + name + ": 1}\n", "conic: {radius_mm: = 3 * " + (is_taken ? name : "1") + "}"), is_taken);
  top("wavelengths_nm: [550, 600]\n", true);
  top("wavelengths_nm: [550, 550.0]\n", false);
  top("wavelengths_nm: ['= 550', '= 550']\n", false);

  const test::TemporaryFolder folder, files;
  std::map<std::string, std::string> written;
  std::map<std::string, bool> expected;
  for (const auto& [text, is_taken] : cases) {
    const std::string name = fmt::format("{}.yaml", expected.size());
    const auto read = read_prescription(files.write(name, text));
    EXPECT_EQ(!read.findings.has_errors(), is_taken) << text << test::text_of(read.findings);
    written[name] = text;
    expected[name] = is_taken;
  }
  const auto found = verdicts(folder, files.path());
  EXPECT_EQ(found.size(), cases.size());
  EXPECT_GT(cases.size(), 70u);
  for (const auto& [name, is_valid] : found) EXPECT_EQ(is_valid, expected[name]) << written[name];
}

}  // namespace
}  // namespace sagitta::prescription
