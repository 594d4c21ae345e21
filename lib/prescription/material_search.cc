// SPDX-License-Identifier: Apache-2.0
#include "lib/prescription/material_search.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <set>
#include <string_view>
#include <utility>

#include "lib/prescription/search_path.h"

namespace sagitta::prescription {
namespace {

namespace fs = std::filesystem;

constexpr double told_difference = 1e-6;

bool is_plain_name(std::string_view name) {
  const auto is_harmful = [](char c) { return c == '/' || c == '\\' || static_cast<unsigned char>(c) < 0x20; };
  return !name.empty() && name.find("..") == std::string_view::npos && std::none_of(name.begin(), name.end(), is_harmful);
}

std::string nearest_medium(const std::string& name, const std::vector<std::string>& known) {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; };
  for (const std::string& candidate : known) {
    if (std::ranges::equal(candidate, name, {}, lower, lower)) return candidate;
  }
  return nearest_name(name, known);
}

using Candidate = std::function<std::optional<Material>(Findings&)>;

// The places that have the name, in the order in which they count.
std::vector<Candidate> candidates(const std::string& name, const std::string& beside, std::span<const AgfCatalog> catalogs) {
  std::vector<Candidate> found;
  const auto add_file = [&](const std::string& file) {
    found.push_back([file](Findings& findings) { return read_material(file, findings); });
  };
  const fs::path own = fs::path(beside) / (name + ".yml");
  std::error_code failure;
  if (fs::is_regular_file(own, failure)) add_file(own.string());
  for (const AgfCatalog& catalog : catalogs)
    if (const AgfGlass* glass = catalog.find(name)) found.push_back([&catalog, glass](Findings& findings) { return read_glass(catalog, *glass, findings); });
  if (!found.empty() && catalogs.empty()) return found;
  if (const auto file = find_file("materials/" + name + ".yml", beside)) add_file(*file);
  return found;
}

// By how much the indices differ at most, at nine wavelengths of the range of both; 0 where there is none.
double difference(const medium::Medium& a, const medium::Medium& b) {
  const double shortest = std::max(a.shortest_um, b.shortest_um), longest = std::min(a.longest_um, b.longest_um);
  double most = 0;
  for (int i = 0; i <= 8 && shortest <= longest; ++i) {
    const double um = shortest + (longest - shortest) * i / 8;
    most = std::fmax(most, std::abs(a.index(um) - b.index(um)));  // where one has no index, none
  }
  return most;
}

std::string shown(const Place& place) {
  const std::string file = excerpt(fs::path(place.file).filename().string());
  return place.line > 0 ? fmt::format("{}, line {}", file, place.line) : file;
}

void tell_of_differences(const Material& taken, std::span<const Candidate> others, const Place& named_at, Findings& findings) {
  for (const Candidate& other : others) {
    Findings none_told;
    const std::optional<Material> left = other(none_told);
    if (!left) continue;
    if (const double most = difference(taken, *left); most > told_difference)
      findings.note(named_at, fmt::format("{} is taken from {}; {} has another index, by up to {:.2g}", excerpt(taken.name), shown(taken.place), shown(left->place), most));
  }
}

}  // namespace

std::vector<std::string> known_materials(const std::string& beside, std::span<const AgfCatalog> catalogs) {
  std::set<std::string> names{"air"};
  for (const std::string& folder : search_folders(beside)) {
    std::error_code failure;
    for (fs::directory_iterator file(fs::path(folder) / "materials", failure), end; !failure && file != end; file.increment(failure)) {
      if (file->path().extension() == ".yml") names.insert(file->path().stem().string());
    }
  }
  for (const AgfCatalog& catalog : catalogs)
    for (const AgfGlass& glass : catalog.glasses) names.insert(glass.name);
  return {names.begin(), names.end()};
}

std::optional<Material> find_material(const std::string& name, const Place& named_at, Findings& findings, std::span<const AgfCatalog> catalogs) {
  if (name == "air") return Material{medium::air(), Place{}, "", "the reference of the indices of all media"};
  const std::string ways = "a medium is air, the name of a file materials/NAME.yml, {index: ...} or {nd: ..., vd: ...}";
  if (!is_plain_name(name)) {
    findings.error(named_at, fmt::format("'{}' is not the name of a medium", excerpt(name)), ways);
    return std::nullopt;
  }
  const std::string beside = fs::path(named_at.file).parent_path().string();
  const std::vector<Candidate> found = candidates(name, beside, catalogs);
  if (found.empty()) {
    const std::string near = nearest_medium(name, known_materials(beside, catalogs));
    findings.error(named_at, fmt::format("unknown medium '{}'", excerpt(name)), near.empty() ? ways : fmt::format("did you mean '{}'?", excerpt(near)));
    return std::nullopt;
  }
  const int errors_before = findings.error_count();
  std::optional<Material> material = found.front()(findings);
  if (findings.error_count() > errors_before) findings.note(named_at, "named here");
  if (material) tell_of_differences(*material, std::span(found).subspan(1), named_at, findings);
  return material;
}

}  // namespace sagitta::prescription
