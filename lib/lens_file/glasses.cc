// SPDX-License-Identifier: Apache-2.0
#include "lib/lens_file/glasses.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "lib/lens_file/numbers.h"
#include "lib/medium/spectral_lines.h"
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

// Beginnings of the words by which lens files and catalogues name makers of glass.
constexpr std::array makers{"cdgm", "corning", "heraeus", "hikari", "hoya", "lzos", "nhg", "nikon", "ohara", "pilkington", "schott", "sumita"};

// In small letters and digits, words apart by blanks, with one before the first.
std::string words_of(std::string_view text) {
  std::string words = " ";
  for (const char c : text) words += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') ? c : ' ';
  return words;
}

// Whether what a medium says of its sources names one of these, or only others, or no maker.
enum class Maker { agrees, another, unnamed };
Maker maker_of(const prescription::Material& material, std::span<const std::string> names) {
  const std::string sources = words_of(material.references + " " + material.comments);
  const auto is_named = [&](std::string_view name) { return sources.find(" " + std::string(name)) != std::string::npos; };
  for (const std::string& name : names) {
    const std::string words = words_of(name);
    if (words.size() > 3 && is_named(std::string_view(words).substr(1))) return Maker::agrees;
  }
  return std::any_of(makers.begin(), makers.end(), is_named) ? Maker::another : Maker::unnamed;
}

// What a file rounds, and what catalogues change from one edition to the next.
constexpr double told_nd_difference = 5e-4, told_vd_difference = 0.5;

bool differs(const Stated& stated, double ours, double told) { return stated.value != 0 && std::abs(stated.value - ours) > std::max(told, stated.rounding * (1 + 1e-9)); }

bool is_of_a_maker(std::string_view name) { return std::any_of(name.begin(), name.end(), [](char c) { return c >= 'A' && c <= 'Z'; }); }

class Finder {
 public:
  Finder(const std::string& output, std::span<const prescription::AgfCatalog> catalogs, Report& report)
      : output_(output), catalogs_(catalogs), report_(report),
        known_(prescription::known_materials(std::filesystem::path(output).parent_path().string(), catalogs)) {}

  void find(Medium& medium, const Lens& lens) {
    if (medium.kind != Medium::Kind::glass) return;
    std::string maker;
    const std::optional<std::string> name = name_of(medium.name, maker);
    if (!name) {
      const std::string near = prescription::nearest_name(medium.name, known_);
      return tell_unknown(medium, near.empty() ? "" : fmt::format("'{}' is known; ", prescription::excerpt(near)));
    }
    Findings findings;
    const auto material = prescription::find_material(*name, {output_, 0, 0}, findings, catalogs_);
    const Maker of = !material || maker.empty() ? Maker::agrees : maker_of(*material, std::span(&maker, 1));
    if (of == Maker::another) return tell_unknown(medium, fmt::format("'{}' is another maker's here; ", prescription::excerpt(*name)));
    const bool is_first = told_.insert(medium.name + " " + number_text(medium.stated_nd.value) + " " + number_text(medium.stated_vd.value)).second;
    if (is_first && of == Maker::unnamed && is_of_a_maker(*name))
      report_.warning(medium.place, fmt::format("'{}' is taken as {}, whose source names no maker", prescription::excerpt(medium.name), prescription::excerpt(*name)));
    if (is_first && bare(*name) != medium.name && !is_of_a_maker(*name))
      report_.warning(medium.place, fmt::format("'{}' is taken as {}, whose formula may be of another source", prescription::excerpt(medium.name), *name));
    if (material && is_first) compare(medium, *material, lens);
    if (material) prescription::check_medium({*material, medium.place}, lens.wavelengths_nm, findings);
    for (prescription::Finding finding : findings.all()) {
      if (finding.place.file == output_) finding.place = medium.place;
      if (finding.severity == prescription::Severity::error) report_.broken(finding.place, finding.what, finding.hint);
      else if (is_first) report_.findings().add(std::move(finding));
    }
    medium.name = *name;
  }

 private:
  void tell_unknown(const Medium& medium, const std::string& hint) {
    report_.broken(medium.place, fmt::format("unknown glass '{}'", prescription::excerpt(medium.name)), hint + "--catalog FILE.agf looks in a maker's catalogue");
  }
  void compare(const Medium& medium, const prescription::Material& ours, const Lens& lens) {
    const double nd = ours.index(medium::lines::d_um), vd = (nd - 1) / (ours.index(medium::lines::F_um) - ours.index(medium::lines::C_um));
    if (differs(medium.stated_nd, nd, told_nd_difference) || differs(medium.stated_vd, vd, told_vd_difference))
      report_.warning(medium.place, fmt::format("'{}' has nd {:.6g} and Vd {:.4g} here, where the file has {} and {}", prescription::excerpt(medium.name), nd, vd, number_text(medium.stated_nd.value),
                                                number_text(medium.stated_vd.value)), "if it is another maker's, --catalog FILE.agf takes it from that catalogue");
    else if (medium.stated_nd.value == 0 && !lens.glass_catalogs.empty() && maker_of(ours, lens.glass_catalogs) == Maker::another)
      report_.warning(medium.place, fmt::format("'{}' is taken from another maker than the catalogues of the file, {}", prescription::excerpt(medium.name), prescription::excerpt(fmt::format("{}", fmt::join(lens.glass_catalogs, " ")))),
                      "--catalog FILE.agf takes it from a catalogue");
  }

  // The name of the medium here; `maker` is what it was found without.
  std::optional<std::string> name_of(const std::string& given, std::string& maker) const {
    if (std::binary_search(known_.begin(), known_.end(), given)) return given;
    const std::size_t end = std::min(given.rfind('_'), given.size());
    for (const std::string& one : {bare(given), bare(std::string_view(given).substr(0, end))}) {
      maker = one == bare(given) ? "" : given.substr(end + 1);
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
  finder.find(lens.object_medium, lens);
  for (Surface& surface : lens.surfaces) finder.find(surface.medium, lens);
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
