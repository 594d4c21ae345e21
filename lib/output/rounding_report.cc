// SPDX-License-Identifier: Apache-2.0
#include "lib/output/rounding_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "lib/output/summary_internal.h"
#include "lib/output/table.h"
#include "lib/output/text.h"

namespace sagitta::output {
namespace {

using nlohmann::ordered_json;
using study::Disagreement;
using study::FieldRounding;
using study::Spoiled;
using study::SurfaceRounding;

constexpr const char* basis = "the numbers of the compiled scene (indices, curvatures, frames, points) are taken as exact: this proves rounding, not formulas";

std::string name_of(const RoundingReport& report, std::size_t surface) {
  return surface == 0 ? "launch" : report.system.surface_names[surface - 1];
}
std::string size(const Spoiled& spoiled) { return spoiled.count() > 0 ? fmt::format("{:.1e}", spoiled.worst()) : "-"; }
std::string mean_size(const Spoiled& spoiled) { return spoiled.count() > 0 ? fmt::format("{:.1e}", spoiled.rms()) : "-"; }

struct Worst {
  double position_mm = 0, opd_waves = 0;
  std::int64_t off_rim = 0;
};
Worst worst_of(const study::Rounding& rounding) {
  Worst worst;
  for (const FieldRounding& field : rounding.fields) {
    worst.position_mm = std::max(worst.position_mm, field.position_mm.worst());
    worst.opd_waves = std::max(worst.opd_waves, field.opd_waves.worst());
  }
  worst.off_rim = std::count_if(rounding.disagreements.begin(), rounding.disagreements.end(), [](const Disagreement& one) { return !one.is_on_rim; });
  return worst;
}

std::string ending(surface::Status status, int surface) {
  const auto name = surface::status_names[static_cast<std::size_t>(status)];
  return surface > 0 ? fmt::format("{} at surface {}", name, surface) : std::string(name);
}

std::string verdict(const RoundingReport& report) {
  const Worst worst = worst_of(report.rounding);
  const auto differently = report.rounding.disagreements.size();
  std::string text = fmt::format("{}: places in the image to {:.1e} mm (asked {:g}), OPD to {:.1e} waves (asked {:g}); {} of {} rays end{} differently", is_good(report) ? "good" : "not good",
                                 worst.position_mm, report.position_tolerance_mm, worst.opd_waves, report.opd_tolerance_waves, differently, report.rounding.rays, differently == 1 ? "s" : "");
  if (!is_good(report)) {
    const auto number = static_cast<std::size_t>(surface_to_blame(report));
    const std::string name = printable(name_of(report, number), 60);
    text += number == 0 ? "\nlargest share: the launch" : fmt::format("\nlargest share: surface {}{}", number, name.empty() ? "" : " (" + name + ")");
  }
  return text + "\n";
}

// The surface whose own errors are the largest part of their bounds.
std::size_t nearest_to_bound(const study::Rounding& rounding) {
  const auto& surfaces = rounding.surfaces;
  return static_cast<std::size_t>(std::max_element(surfaces.begin(), surfaces.end(), [](const auto& a, const auto& b) { return a.of_bound < b.of_bound; }) - surfaces.begin());
}

std::string what_bounds_say(const study::Rounding& rounding) {
  std::int64_t known = 0, unknown = 0;
  for (const SurfaceRounding& one : rounding.surfaces) known += one.bound_position_mm.count(), unknown += one.without_bound;
  const std::size_t number = nearest_to_bound(rounding);
  const double part = rounding.surfaces[number].of_bound;
  std::string text;
  if (known > 0)
    text = part == 0   ? "no surface loses anything\n"
           : part <= 1 ? fmt::format("every loss is explained by the geometry: at most {:.2g} of what it can do to a ray, at surface {}\n", part, number)
                       : fmt::format("surface {} loses {:.2g} times what the geometry can explain: please report this system\n", number, part);
  if (unknown > 0) text += fmt::format("of {} hit{} no bound is known: rounding moves them by as much as the surface turns within\n", unknown, unknown == 1 ? "" : "s");
  return text;
}

ordered_json json_of(const Spoiled& spoiled) {
  if (spoiled.count() == 0) return nullptr;
  return {{"worst", spoiled.worst()}, {"rms", spoiled.rms()}};
}

}  // namespace

bool is_good(const RoundingReport& report) {
  const Worst worst = worst_of(report.rounding);
  return worst.position_mm <= report.position_tolerance_mm && worst.opd_waves <= report.opd_tolerance_waves && worst.off_rim == 0;
}

int surface_to_blame(const RoundingReport& report) {
  for (const Disagreement& one : report.rounding.disagreements)
    if (!one.is_on_rim) return one.surface == 0 || (one.exact_surface > 0 && one.exact_surface < one.surface) ? one.exact_surface : one.surface;
  const Worst worst = worst_of(report.rounding);
  const bool is_opd = !(worst.opd_waves <= report.opd_tolerance_waves);
  const auto& surfaces = report.rounding.surfaces;
  const auto share = [&](const SurfaceRounding& one) { return is_opd ? one.share_waves.worst() : one.share_mm.worst(); };
  return static_cast<int>(std::max_element(surfaces.begin(), surfaces.end(), [&](const auto& a, const auto& b) { return share(a) < share(b); }) - surfaces.begin());
}

std::string rounding_text(const RoundingReport& report) {
  const study::Rounding& rounding = report.rounding;
  Table surfaces{{{"surface", ""}, {"name", "", true}, {"position", "worst mm"}, {"", "rms mm"}, {"", "ulp"}, {"direction", "rad"}, {"OPL", "mm"}, {"own", "mm"}, {"", "of bound"}, {"digits", "lost"},
                  {"where", "they are lost", true}, {"in the image", "mm"}, {"", "waves"}}, {}};
  for (std::size_t k = 0; k < rounding.surfaces.size(); ++k) {
    const SurfaceRounding& one = rounding.surfaces[k];
    surfaces.rows.push_back({std::to_string(k), name_of(report, k), size(one.position_mm), mean_size(one.position_mm),
                             one.position_mm.count() > 0 ? fmt::format("{:.1f}", one.position_mm.worst() / (0x1p-52 * rounding.scale_mm)) : "-", size(one.direction_rad), size(one.opl_mm),
                             size(one.own_position_mm), one.bound_position_mm.count() > 0 ? fmt::format("{:.2f}", one.of_bound) : "-", fmt::format("{:.1f}", one.digits_lost), one.cause, size(one.share_mm), size(one.share_waves)});
  }
  Table fields{{{"field", ""}, {"wavelength", "nm"}, {"rays", ""}, {"arrive", ""}, {"position", "worst mm"}, {"OPD", "worst waves"}, {"remark", "", true}}, {}};
  for (const FieldRounding& one : rounding.fields)
    fields.rows.push_back({std::to_string(one.field), fmt::format("{:g}", report.system.wavelengths_nm[one.wavelength]), std::to_string(one.rays), std::to_string(one.arrived),
                           size(one.position_mm), size(one.opd_waves), one.no_wavefront.empty() ? "" : "no OPD: " + one.no_wavefront});
  std::string text = fmt::format("{}: {} rays in double and in 50 digits\n{}\n\nbehind each surface: how far off, what it has lost itself, and what that is worth in the image; an ulp is {:.3g} mm, of the scale {:.6g} mm\n{}\n{}\n",
                                 printable(report.system.system, 200), rounding.rays, basis, 0x1p-52 * rounding.scale_mm, rounding.scale_mm, to_text(surfaces), to_text(fields));
  constexpr std::size_t most_listed = 10;
  for (std::size_t i = 0; i < std::min(most_listed, rounding.disagreements.size()); ++i) {
    const Disagreement& one = rounding.disagreements[i];
    text += fmt::format("field {}, {:g} nm, pupil ({:g}, {:g}): {}, exactly {}{}\n", one.field, report.system.wavelengths_nm[one.wavelength], one.pupil_x, one.pupil_y,
                        ending(one.status, one.surface), ending(one.exact_status, one.exact_surface), one.is_on_rim ? "; on the rim, within the tolerance" : "");
  }
  if (rounding.disagreements.size() > most_listed) text += fmt::format("and {} more\n", rounding.disagreements.size() - most_listed);
  return text + what_bounds_say(rounding) + verdict(report);
}

namespace {

ordered_json json_of(const RoundingReport& report) {
  const study::Rounding& rounding = report.rounding;
  const Worst worst = worst_of(rounding);
  ordered_json json{{"system", report.system.system}, {"version", report.system.version}, {"basis", basis}, {"digits", 50}, {"rays", rounding.rays}, {"scale_mm", rounding.scale_mm},
                    {"good", is_good(report)}, {"position_tolerance_mm", report.position_tolerance_mm}, {"opd_tolerance_waves", report.opd_tolerance_waves},
                    {"worst_position_mm", worst.position_mm}, {"worst_opd_waves", worst.opd_waves}, {"surface_to_blame", is_good(report) ? ordered_json() : ordered_json(surface_to_blame(report))},
                    {"surfaces", ordered_json::array()}, {"opd_formula_waves", json_of(rounding.opd_formula_waves)}, {"fields", ordered_json::array()}, {"rays_that_end_differently", ordered_json::array()}};
  for (std::size_t k = 0; k < rounding.surfaces.size(); ++k) {
    const SurfaceRounding& one = rounding.surfaces[k];
    json["surfaces"].push_back({{"surface", k}, {"name", name_of(report, k)}, {"position_mm", json_of(one.position_mm)}, {"direction_rad", json_of(one.direction_rad)}, {"opl_mm", json_of(one.opl_mm)},
                                {"own_position_mm", json_of(one.own_position_mm)}, {"own_direction_rad", json_of(one.own_direction_rad)}, {"own_opl_mm", json_of(one.own_opl_mm)},
                                {"bound_position_mm", json_of(one.bound_position_mm)}, {"bound_direction_rad", json_of(one.bound_direction_rad)}, {"bound_opl_mm", json_of(one.bound_opl_mm)},
                                {"of_bound", one.bound_position_mm.count() > 0 ? ordered_json(one.of_bound) : ordered_json()}, {"without_bound", one.without_bound}, {"digits_lost", one.digits_lost}, {"cause", one.cause}, {"share_mm", json_of(one.share_mm)}, {"share_waves", json_of(one.share_waves)}});
  }
  for (const FieldRounding& one : rounding.fields)
    json["fields"].push_back({{"field", one.field}, {"wavelength_nm", report.system.wavelengths_nm[one.wavelength]}, {"rays", one.rays}, {"arrived", one.arrived},
                              {"position_mm", json_of(one.position_mm)}, {"opd_waves", json_of(one.opd_waves)}, {"no_wavefront", one.no_wavefront}});
  for (const Disagreement& one : rounding.disagreements)
    json["rays_that_end_differently"].push_back({{"field", one.field}, {"wavelength_nm", report.system.wavelengths_nm[one.wavelength]}, {"pupil", {one.pupil_x, one.pupil_y}},
                                                 {"status", surface::status_names[static_cast<std::size_t>(one.status)]}, {"surface", one.surface},
                                                 {"exact_status", surface::status_names[static_cast<std::size_t>(one.exact_status)]}, {"exact_surface", one.exact_surface}, {"is_on_rim", one.is_on_rim}});
  return json;
}

}  // namespace

std::string rounding_json(std::span<const RoundingReport> reports) {
  if (reports.size() == 1) return text_of(json_of(reports.front()));
  ordered_json all = ordered_json::array();
  for (const RoundingReport& report : reports) all.push_back(json_of(report));
  return text_of(all);
}

std::string rounding_summary(std::span<const RoundingReport> reports) {
  Table table{{{"system", "", true}, {"rays", ""}, {"end differently", ""}, {"digits lost", ""}, {"at", "", true}, {"place in the image", "worst mm"}, {"OPD", "worst waves"}, {"verdict", "", true}}, {}};
  for (const RoundingReport& report : reports) {
    const auto& surfaces = report.rounding.surfaces;
    const auto worst_surface = std::max_element(surfaces.begin(), surfaces.end(), [](const auto& a, const auto& b) { return a.digits_lost < b.digits_lost; });
    const auto number = static_cast<std::size_t>(worst_surface - surfaces.begin());
    const std::string where = number == 0 ? "launch" : fmt::format("surface {}", number);
    const Worst worst = worst_of(report.rounding);
    const bool has_wavefront = std::any_of(report.rounding.fields.begin(), report.rounding.fields.end(), [](const auto& one) { return one.opd_waves.count() > 0; });
    table.rows.push_back({report.system.system, std::to_string(report.rounding.rays), std::to_string(report.rounding.disagreements.size()), fmt::format("{:.1f}", worst_surface->digits_lost),
                          worst_surface->digits_lost > 0 ? where : "", fmt::format("{:.1e}", worst.position_mm), has_wavefront ? fmt::format("{:.1e}", worst.opd_waves) : "-",
                          is_good(report) ? "good" : "not good"});
  }
  return fmt::format("double against 50 digits; {}\n\n{}", basis, to_text(table));
}

}  // namespace sagitta::output
