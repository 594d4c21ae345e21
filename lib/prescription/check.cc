// SPDX-License-Identifier: Apache-2.0
#include "lib/prescription/check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

namespace sagitta::prescription {
namespace {

std::vector<double> used_wavelengths_nm(const Model& model) {
  std::vector<double> wavelengths = model.wavelengths_nm;
  if (model.primary_nm) wavelengths.push_back(*model.primary_nm);
  return wavelengths;
}

// The first of them, and how many more there are.
std::string shown(const std::vector<double>& wavelengths_nm) {
  constexpr std::size_t most = 8;
  const std::size_t shown_count = std::min(most, wavelengths_nm.size());
  std::string text = fmt::format("{}", fmt::join(wavelengths_nm.begin(), wavelengths_nm.begin() + shown_count, ", "));
  if (wavelengths_nm.size() > most) text += fmt::format(" and {} more", wavelengths_nm.size() - most);
  return text + " nm";
}

void check_aperture(const Model& model, Findings& findings) {
  const Aperture& aperture = model.aperture;
  const double distance_mm = model.object.distance_mm;
  if (aperture.kind == ApertureKind::image_f_number && std::isfinite(distance_mm))
    findings.error(aperture.place, fmt::format("image_f_number needs an object at infinity, not at {} mm", distance_mm),
                   "a finite object goes with object_na, entrance_pupil_diameter_mm or stop_diameter_mm");
  if (aperture.kind != ApertureKind::object_na) return;
  if (std::isinf(distance_mm))
    findings.error(aperture.place, "object_na needs a finite object", "give object: {distance_mm: ...}");
  if (model.wavelengths_nm.empty()) return;
  const double wavelength_um = model.primary_wavelength_nm() / 1000;
  if (!model.object.medium.covers(wavelength_um)) return;
  const double index = model.object.medium.index(wavelength_um);
  if (!(aperture.value < index))
    findings.error(aperture.place,
                   fmt::format("object_na must be less than the object's index, {}, not '{}'", index, aperture.value));
}

}  // namespace

void check_medium(const MediumUse& use, const std::vector<double>& wavelengths_nm, Findings& findings) {
  std::vector<double> outside, without_index;
  for (const double wavelength_nm : wavelengths_nm) {
    const double wavelength_um = wavelength_nm / 1000;
    if (!use.medium.covers(wavelength_um))
      outside.push_back(wavelength_nm);
    else if (!(use.medium.index(wavelength_um) > 0))
      without_index.push_back(wavelength_nm);
  }
  // Ranges are shown with 9 digits: 0.31 um times 1000 need not be 310.
  if (!outside.empty())
    findings.error(use.place, fmt::format("{} is valid from {:.9g} to {:.9g} nm, not at {}", use.medium.name,
                                          use.medium.shortest_um * 1000, use.medium.longest_um * 1000, shown(outside)));
  if (!without_index.empty())
    findings.error(use.place,
                   fmt::format("{} has no index from {} to {} at {}", use.medium.name, medium::least_index, medium::largest_index, shown(without_index)));
}

std::string told_extrapolation(const medium::Medium& medium, const std::vector<double>& wavelengths_nm) {
  std::vector<double> beyond;
  for (const double wavelength_nm : wavelengths_nm)
    if (medium.is_extrapolated(wavelength_nm / 1000)) beyond.push_back(wavelength_nm);
  if (beyond.empty()) return {};
  return fmt::format("{} is meant for visible light, {:g} to {:g} nm, and extrapolated at {}", medium.name, medium::shortest_visible_um * 1000, medium::longest_visible_um * 1000, shown(beyond));
}

void check_model(const Model& model, const std::vector<MediumUse>& media, Findings& findings) {
  const std::vector<double> wavelengths_nm = used_wavelengths_nm(model);
  std::set<std::string> extrapolated;
  for (const MediumUse& use : media) {
    check_medium(use, wavelengths_nm, findings);
    if (const std::string told = told_extrapolation(use.medium, wavelengths_nm); !told.empty() && extrapolated.insert(use.medium.name).second)
      findings.warning(use.place, told, "a file of materials/ or a glass of a catalogue has a range");
  }
  check_aperture(model, findings);
  if (model.fields.kind == FieldKind::object_heights_mm && std::isinf(model.object.distance_mm))
    findings.error(model.fields.place, "object_heights_mm needs a finite object",
                   "give object: {distance_mm: ...}, or angles_deg");
}

}  // namespace sagitta::prescription
