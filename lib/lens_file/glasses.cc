// SPDX-License-Identifier: Apache-2.0
#include "lib/lens_file/glasses.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "lib/prescription/check.h"
#include "lib/prescription/material_search.h"

namespace sagitta::lens_file {
namespace {

using prescription::Findings;

// Without capital letters and separators.
std::string bare(std::string_view name) {
  std::string result;
  for (const char c : name)
    if (c != '-' && c != '_' && c != ' ') result += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return result;
}

constexpr std::array other_names{std::pair{"silica", "fused-silica"}, std::pair{"fsilica", "fused-silica"}, std::pair{"polycarb", "polycarbonate"},
                                 std::pair{"acrylic", "pmma"}, std::pair{"sapphire", "sapphire-o"}};

bool is_of_a_maker(std::string_view name) { return std::any_of(name.begin(), name.end(), [](char c) { return c >= 'A' && c <= 'Z'; }); }

class Finder {
 public:
  Finder(const std::string& output, std::span<const prescription::AgfCatalog> catalogs, Report& report)
      : output_(output), catalogs_(catalogs), report_(report),
        known_(prescription::known_materials(std::filesystem::path(output).parent_path().string(), catalogs)) {}

  void find(Medium& medium, const std::vector<double>& wavelengths_nm) {
    if (medium.kind != Medium::Kind::glass) return;
    const std::optional<std::string> name = name_of(medium.name);
    if (!name) {
      const std::string near = prescription::nearest_name(medium.name, known_);
      report_.broken(medium.place, fmt::format("unknown glass '{}'", prescription::excerpt(medium.name)),
                     (near.empty() ? "" : fmt::format("'{}' is known; ", prescription::excerpt(near))) + "--catalog FILE.agf looks in a maker's catalogue");
      return;
    }
    const bool is_first = told_.insert(medium.name).second;
    if (is_first && bare(*name) != medium.name && !is_of_a_maker(*name))
      report_.warning(medium.place, fmt::format("'{}' is taken as {}, whose formula may be of another source", prescription::excerpt(medium.name), *name));
    Findings findings;
    const auto material = prescription::find_material(*name, {output_, 0, 0}, findings, catalogs_);
    if (material) prescription::check_medium({*material, medium.place}, wavelengths_nm, findings);
    for (prescription::Finding finding : findings.all()) {
      if (finding.place.file == output_) finding.place = medium.place;
      if (finding.severity == prescription::Severity::error) report_.broken(finding.place, finding.what, finding.hint);
      else if (is_first) report_.findings().add(std::move(finding));
    }
    medium.name = *name;
  }

 private:
  std::optional<std::string> name_of(const std::string& given) const {
    if (std::binary_search(known_.begin(), known_.end(), given)) return given;
    for (const std::string& one : {bare(given), bare(std::string_view(given).substr(0, given.rfind('_')))}) {
      const auto same = std::find_if(known_.begin(), known_.end(), [&](const std::string& candidate) { return bare(candidate) == one; });
      if (same != known_.end()) return *same;
      for (const auto& [other, name] : other_names)
        if (one == other && std::binary_search(known_.begin(), known_.end(), name)) return name;
    }
    return std::nullopt;
  }

  const std::string& output_;
  std::span<const prescription::AgfCatalog> catalogs_;
  Report& report_;
  std::vector<std::string> known_;  // sorted
  std::set<std::string> told_;
};

}  // namespace

void find_glasses(Lens& lens, const std::string& output, std::span<const prescription::AgfCatalog> catalogs, Report& report) {
  Finder finder(output, catalogs, report);
  finder.find(lens.object_medium, lens.wavelengths_nm);
  for (Surface& surface : lens.surfaces) finder.find(surface.medium, lens.wavelengths_nm);
}

double index_of(const Medium& medium, double wavelength_nm, const std::string& output, std::span<const prescription::AgfCatalog> catalogs) {
  switch (medium.kind) {
    case Medium::Kind::air: return 1;
    case Medium::Kind::index: return medium.index;
    case Medium::Kind::nd_vd: return medium::from_nd_vd(medium.index, medium.vd).index(wavelength_nm / 1000);
    case Medium::Kind::glass: {
      Findings told_before;
      const auto material = prescription::find_material(medium.name, {output, 0, 0}, told_before, catalogs);
      return material ? material->index(wavelength_nm / 1000) : std::numeric_limits<double>::quiet_NaN();
    }
    default: return std::numeric_limits<double>::quiet_NaN();
  }
}

}  // namespace sagitta::lens_file
