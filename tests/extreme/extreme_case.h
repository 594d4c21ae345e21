// SPDX-License-Identifier: Apache-2.0
// A case of tests/extreme/: a system as a user writes it, whose head comment, without its "# ", is YAML that says what the case is:
//
//   extreme     what is extreme about it
//   rays        [[x, y, z, l, m, n], ...], global, where they start; (l, m, n) is taken as exact once it has unit length, or
//   pupil       [[px, py], ...] of the field number `field` (0)
//   surface     where they are looked at, in its frame; the image unless said otherwise
//   status      [how each ray ends]; ok unless said otherwise
//   exact       {quantity: value or one a ray}: closed form, quantities x_mm y_mm z_mm l m n opl_mm opd_waves
//   source      of `exact`; of rays without a closed form: "100 digits"
//   tolerance   {quantity: ...}, or position_mm, direction for those of x, y, z, l, m, n without their own; what has none is not compared
//   because     why that tolerance
//   naive       fails | holds | none, and what it gives (holds, none: and why the case is here all the same)
//   found       when, and what the tracer gave until then; where there was something to mend
#pragma once

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "lib/surface/status.h"
#include "lib/trace/pattern.h"
#include "tests/support/prescriptions.h"

namespace sagitta::test {

// Twice the digits that the tracer's own templates are run with: what even an object at 1e15 mm takes of them leaves enough.
using Exact = boost::multiprecision::number<boost::multiprecision::cpp_bin_float_100::backend_type, boost::multiprecision::et_off>;

struct ExtremeCase {
  std::filesystem::path file;
  std::string extreme, source, because, naive;
  std::vector<GlobalRay> rays;
  std::vector<trace::PupilPoint> pupil;
  std::size_t field = 0;
  int surface = 0;  // 0: the image
  std::vector<surface::Status> status;
  std::map<std::string, std::vector<Exact>> exact;
  std::map<std::string, double> tolerance;

  std::string name() const { return file.stem().string(); }
  std::size_t ray_count() const { return rays.empty() ? pupil.size() : rays.size(); }
  // NaN: not compared.
  double tolerance_of(const std::string& quantity, const std::string& group) const {
    const auto own = tolerance.find(quantity), of_group = tolerance.find(group);
    return own != tolerance.end() ? own->second : of_group != tolerance.end() ? of_group->second : NAN;
  }
  bool naive_fails() const { return naive.starts_with("fails"); }
  bool has_naive() const { return !naive.starts_with("none"); }
};

inline std::vector<std::filesystem::path> extreme_files() {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(SAGITTA_SOURCE_DIR "/tests/extreme"))
    if (entry.path().extension() == ".yaml") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

inline surface::Status status_called(const std::string& name) {
  const auto found = std::find(surface::status_names.begin(), surface::status_names.end(), name);
  EXPECT_NE(found, surface::status_names.end()) << name;
  return static_cast<surface::Status>(found - surface::status_names.begin());
}

// As `sagitta rays --from` takes directions (tools/given_rays.cc): those of unit length as they stand.
inline Vec3<double> unit_direction(const Vec3<double>& given) {
  const double length = norm(given);
  return std::abs(length - 1) > 4 * std::numeric_limits<double>::epsilon() ? (1 / length) * given : given;
}

inline ExtremeCase read_case(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::string head, line;
  std::getline(stream, line);  // the licence
  while (std::getline(stream, line) && line.starts_with("# ")) head += line.substr(2) + "\n";
  const YAML::Node given = YAML::Load(head);
  const auto text = [&](const char* key) {
    EXPECT_TRUE(given[key]) << file << ": no " << key;
    return given[key] ? given[key].as<std::string>() : std::string();
  };
  ExtremeCase result;
  result.file = file;
  result.extreme = text("extreme"), result.source = text("source"), result.because = text("because"), result.naive = text("naive");
  for (const auto& ray : given["rays"]) {
    const auto v = ray.as<std::vector<double>>();
    result.rays.push_back({{v.at(0), v.at(1), v.at(2)}, unit_direction({v.at(3), v.at(4), v.at(5)})});
  }
  for (const auto& point : given["pupil"]) result.pupil.push_back({point[0].as<double>(), point[1].as<double>()});
  if (given["field"]) result.field = given["field"].as<std::size_t>();
  if (given["surface"]) result.surface = given["surface"].as<int>();
  result.status.assign(result.ray_count(), surface::Status::ok);
  if (given["status"])
    for (std::size_t i = 0; i < result.ray_count(); ++i) result.status[i] = status_called(given["status"][i].as<std::string>());
  for (const auto& entry : given["exact"]) {
    auto& values = result.exact[entry.first.as<std::string>()];
    for (std::size_t i = 0; i < result.ray_count(); ++i)
      values.emplace_back((entry.second.IsSequence() ? entry.second[i] : entry.second).as<std::string>());
  }
  for (const auto& entry : given["tolerance"]) result.tolerance[entry.first.as<std::string>()] = entry.second.as<double>();
  EXPECT_NE(result.rays.empty(), result.pupil.empty()) << file << ": rays or pupil, one of them";
  return result;
}

}  // namespace sagitta::test
