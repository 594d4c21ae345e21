// SPDX-License-Identifier: Apache-2.0
#include "tools/load.h"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <utility>

#include "lib/prescription/check.h"
#include "lib/prescription/reader.h"
#include "tools/solve_fields.h"

namespace sagitta::tools {

bool report(const prescription::Findings& findings) {
  static std::set<std::string> told;
  for (const auto& finding : findings.all())
    if (const std::string text = prescription::format(finding); told.insert(text).second) fmt::print(stderr, "{}\n", text);
  return !findings.has_errors();
}

LoadedModel load_model(const std::string& file, const prescription::Settings& settings) {
  prescription::ReadResult read = prescription::read_prescription(file, settings);
  if (report(read.findings)) {
    prescription::Model& model = *read.model;
    if (!report(prescription::in_order(solve_fields(model), model.documents))) return {std::nullopt, 1};
    if (model.name.empty() && !model.parameters.empty()) model.name = std::filesystem::path(file).stem().string();
    for (const auto& [name, value] : model.parameters) model.name += fmt::format(", {} = {}", name, value);
    return {std::move(read.model)};
  }
  const auto& all = read.findings.all();
  const bool is_usage = std::any_of(all.begin(), all.end(), [](const auto& finding) { return prescription::is_of_command_line(finding.place); });
  return {std::nullopt, is_usage ? 2 : 1};
}

std::optional<scene::CompileResult> load_scene(const prescription::Model& model, const scene::Beam& beam) {
  scene::CompileResult compiled = scene::compile(model, beam);
  if (!report(prescription::in_order(compiled.findings, model.documents))) return std::nullopt;
  return compiled;
}

bool set_wavelengths(prescription::Model& model, const std::vector<double>& wavelengths_nm, const std::string& who) {
  std::set<std::string> told, extrapolated;
  const std::set<double> known(model.wavelengths_nm.begin(), model.wavelengths_nm.end());  // of which the reader has spoken
  const auto check = [&](const medium::Medium& medium) {
    std::vector<double> beyond, added;
    for (const double nm : wavelengths_nm) {
      if (!medium.covers(nm / 1000)) beyond.push_back(nm);
      if (!known.contains(nm)) added.push_back(nm);
    }
    if (const std::string one = prescription::told_extrapolation(medium, added); !one.empty() && extrapolated.insert(medium.name).second)
      fmt::print(stderr, "sagitta {}: warning: {}\n", who, one);
    if (beyond.empty() || !told.insert(medium.name).second) return;
    fmt::print(stderr, "sagitta {}: {:g} nm{} outside the range of {}, {:g} to {:g} nm\n", who, beyond.front(), beyond.size() == 1 ? " lies" : fmt::format(" and {} more lie", beyond.size() - 1),
               medium.name, medium.shortest_um * 1e3, medium.longest_um * 1e3);
  };
  check(model.object.medium);
  for (const auto& surface : model.surfaces)
    if (surface.medium) check(*surface.medium);
  model.primary_nm = model.primary_wavelength_nm();
  model.wavelengths_nm = wavelengths_nm;
  return told.empty();
}

}  // namespace sagitta::tools
