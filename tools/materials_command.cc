// SPDX-License-Identifier: Apache-2.0
// sagitta materials [NAME...]: the media that a prescription can name.
#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "lib/medium/figures.h"
#include "lib/medium/spectral_lines.h"
#include "lib/output/media_report.h"
#include "lib/prescription/check.h"
#include "lib/prescription/material_search.h"
#include "tools/commands.h"
#include "tools/load.h"
#include "tools/version.h"
#include "tools/write.h"

namespace sagitta::tools {
namespace {

namespace fs = std::filesystem;
using prescription::AgfCatalog;
using prescription::Findings;
using prescription::Material;

constexpr const char* who = "sagitta materials";

bool is_meant_for_any_wavelength(const medium::Medium& medium) {
  return medium.shortest_um == medium::least_wavelength_um && medium.longest_um == medium::largest_wavelength_um;
}

output::MediumReport report_of(const Material& material) {
  const prescription::Place& place = material.place;
  output::MediumReport report;
  report.name = material.name;
  report.kind = material.dispersion->kind();
  report.is_table = !material.dispersion->measured_um().empty();
  report.comments = material.comments;
  report.references = material.references;
  report.file = place.line > 0 ? fmt::format("{}:{}", place.file, place.line) : place.file;
  const fs::path file(place.file);
  report.from = place.file.empty() ? "built in" : (place.line > 0 ? file : fs::absolute(file).parent_path()).filename().string();
  report.has_range = !is_meant_for_any_wavelength(material);
  report.shortest_nm = material.shortest_um * 1000;
  report.longest_nm = material.longest_um * 1000;
  report.nd = material.index(medium::lines::d_um);
  report.vd = abbe_number_d(material);
  report.ne = material.index(medium::lines::e_um);
  report.ve = abbe_number_e(material);
  return report;
}

void add_value(output::MediumReport& report, const medium::Medium& medium, std::string_view line, double wavelength_nm) {
  const double um = wavelength_nm / 1000;
  report.values.push_back({std::string(line), wavelength_nm, medium.index(um), slope_per_um(medium, um), group_index(medium, um)});
}

// The catalogues of the command line; none where one of them cannot be read.
std::optional<std::vector<AgfCatalog>> read_catalogs(const std::vector<std::string>& files) {
  std::vector<AgfCatalog> catalogs;
  Findings findings;
  for (const std::string& file : files)
    if (auto catalog = read_agf(file, findings)) catalogs.push_back(*std::move(catalog));
  return report(findings) ? std::optional(std::move(catalogs)) : std::nullopt;
}

std::optional<Material> find(const std::string& name, const std::vector<AgfCatalog>& catalogs, Findings& findings) {
  if (fs::path(name).extension() == ".yml") return read_material(name, findings);
  return find_material(name, {who, -1, 0}, findings, catalogs);
}

// What cannot be read is told, and left out: one broken glass does not hide a catalogue.
int list(const std::vector<AgfCatalog>& catalogs, bool json) {
  std::vector<output::MediumReport> media;
  for (const std::string& name : prescription::known_materials("", catalogs)) {
    Findings findings, warnings;
    if (const auto material = find(name, catalogs, findings)) media.push_back(report_of(*material));
    for (prescription::Finding finding : findings.all()) {
      if (finding.place.file == who) continue;  // where it is named: nowhere
      if (finding.severity == prescription::Severity::error) finding.severity = prescription::Severity::warning;
      warnings.add(std::move(finding));
    }
    report(warnings);
  }
  fmt::print("{}", json ? media_list_json(media, version()) : media_list_text(media));
  return 0;
}

// Of a medium without a range: what the others span, or the lines of the spectrum.
std::pair<double, double> plotted_range_um(const std::vector<Material>& materials) {
  double shortest = medium::largest_wavelength_um, longest = 0;
  for (const Material& material : materials) {
    if (is_meant_for_any_wavelength(material)) continue;
    shortest = std::min(shortest, material.shortest_um);
    longest = std::max(longest, material.longest_um);
  }
  return shortest <= longest ? std::pair(shortest, longest) : std::pair(medium::spectral_lines.front().wavelength_um, medium::spectral_lines.back().wavelength_um);
}

std::vector<output::ChartPoint> curve_of(const medium::Medium& medium, double shortest_um, double longest_um) {
  constexpr int steps = 600;  // about the plot's width in pixels
  std::vector<output::ChartPoint> curve;
  for (const double um : medium.dispersion->measured_um()) curve.push_back({um * 1000, medium.index(um)});
  if (!curve.empty()) return curve;
  for (int i = 0; i <= steps; ++i) {
    const double um = shortest_um + (longest_um - shortest_um) * i / steps;
    curve.push_back({um * 1000, medium.index(um)});
  }
  return curve;
}

bool write_plot(const std::string& file, const std::vector<Material>& materials, const std::vector<output::MediumReport>& media) {
  const auto [shortest, longest] = plotted_range_um(materials);
  std::vector<std::vector<output::ChartPoint>> curves;
  for (const Material& material : materials) {
    const bool is_bounded = !is_meant_for_any_wavelength(material);
    curves.push_back(curve_of(material, is_bounded ? material.shortest_um : shortest, is_bounded ? material.longest_um : longest));
  }
  return write_chart_file("materials", file, media_chart(media, curves, version()));
}

bool is_well_used(const MaterialsOptions& options) {
  const auto refuse = [](const char* what) {
    fmt::print(stderr, "{}: {}\n", who, what);
    return false;
  };
  if (options.names.empty() && !options.wavelengths_nm.empty()) return refuse("--at evaluates media that are named: give a NAME");
  if (options.names.empty() && !options.picture.empty()) return refuse("-o plots media that are named: give a NAME");
  return names_chart("materials", options.picture);
}

}  // namespace

int materials_command(const MaterialsOptions& options) {
  if (!is_well_used(options)) return 2;
  const auto catalogs = read_catalogs(options.catalogs);
  if (!catalogs) return 1;
  if (options.names.empty()) return list(*catalogs, options.json);

  Findings findings;
  std::vector<Material> materials;
  for (const std::string& name : options.names)
    if (auto material = find(name, *catalogs, findings)) materials.push_back(*std::move(material));
  for (const Material& material : materials) check_medium({material, {"--at", -1, 0}}, options.wavelengths_nm, findings);
  if (!report(findings)) return 1;

  std::vector<output::MediumReport> media;
  for (const Material& material : materials) {
    media.push_back(report_of(material));
    for (const double nm : options.wavelengths_nm) add_value(media.back(), material, "", nm);
    if (!options.wavelengths_nm.empty()) continue;
    for (const medium::SpectralLine& line : medium::spectral_lines)
      if (material.covers(line.wavelength_um)) add_value(media.back(), material, line.name, line.wavelength_um * 1000);
  }
  if (!options.picture.empty() && !write_plot(options.picture, materials, media)) return 1;
  fmt::print("{}", options.json ? media_json(media, version()) : media_text(media));
  return 0;
}

}  // namespace sagitta::tools
