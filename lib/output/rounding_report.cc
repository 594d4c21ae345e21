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

std::string in_ulp(const Spoiled& spoiled, double ulp) { return spoiled.count() > 0 ? fmt::format("{:.1f}", spoiled.worst() / ulp) : "-"; }

struct Worst {
  double position_mm = 0, opd_waves = 0;
  std::int64_t arrived = 0, with_opd = 0, off_rim = 0;
};
Worst worst_of(const study::Rounding& rounding) {
  Worst worst;
  for (const FieldRounding& field : rounding.fields) {
    worst.position_mm = std::max(worst.position_mm, field.position_mm.worst());
    worst.opd_waves = std::max(worst.opd_waves, field.opd_waves.worst());
    worst.arrived += field.position_mm.count(), worst.with_opd += field.opd_waves.count();
  }
  worst.off_rim = std::count_if(rounding.disagreements.begin(), rounding.disagreements.end(), [](const Disagreement& one) { return !one.is_on_rim; });
  return worst;
}

std::string ending(surface::Status status, int surface) {
  const auto name = surface::status_names[static_cast<std::size_t>(status)];
  return surface > 0 ? fmt::format("{} at surface {}", name, surface) : std::string(name);
}

// "surface 2 (posterior cornea)"
std::string blamed(const RoundingReport& report) {
  const auto number = static_cast<std::size_t>(surface_to_blame(report));
  const std::string name = printable(name_of(report, number), 60);
  return number == 0 ? "the launch" : fmt::format("surface {}{}", number, name.empty() ? "" : " (" + name + ")");
}

std::string verdict(const RoundingReport& report) {
  const Worst worst = worst_of(report.rounding);
  const auto differently = report.rounding.disagreements.size();
  const std::string ends = fmt::format("{} of {} rays end{} differently", differently, report.rounding.rays, differently == 1 ? "s" : "");
  if (worst.arrived == 0) return fmt::format("not good: not one ray arrives at the image surface in both ways; {}\nwhere the last ends: {}\n", ends, blamed(report));
  const std::string opd = worst.with_opd == 0 ? "no OPD to look at" : fmt::format("OPD to {:.1e} waves (asked {:g}, {} rays)", worst.opd_waves, report.opd_tolerance_waves, worst.with_opd);
  const std::string text = fmt::format("{}: places in the image to {:.1e} mm (asked {:g}), {}; {}", is_good(report) ? "good" : "not good", worst.position_mm, report.position_tolerance_mm, opd, ends);
  return text + (is_good(report) ? "" : "\nlargest share: " + blamed(report)) + "\n";
}

std::string remark(const FieldRounding& field) {
  if (field.arrived == 0) return "no ray arrives";
  if (!field.no_wavefront.empty()) return "no OPD: " + field.no_wavefront;
  return field.without_opd == 0 ? "" : fmt::format("no OPD of {} rays, which miss the reference sphere", field.without_opd);
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
    text = part == 0   ? fmt::format("no surface{} loses anything\n", unknown > 0 ? " of which a bound is known" : "")
           : part <= 1 ? fmt::format("every loss is explained by the geometry: at most {:.2g} of what it can do to a ray, at surface {}\n", part, number)
                       : fmt::format("surface {} loses {:.2g} times what the geometry can explain: please report this system\n", number, part);
  if (std::any_of(rounding.surfaces.begin(), rounding.surfaces.end(), [](const SurfaceRounding& one) { return one.is_estimate; }))
    text += "where a gradient-index medium begins or ends the bound is an estimate: what the tolerance leaves of a step, and its rounding, enlarged as rays part from there\n";
  if (unknown > 0) text += fmt::format("of {} hit{} no bound is known: rounding moves them by as much as the surface turns within\n", unknown, unknown == 1 ? "" : "s");
  return text;
}

// null where there is none: JSON has no infinity.
ordered_json number(double value) { return std::isfinite(value) ? ordered_json(value) : ordered_json(); }

ordered_json json_of(const Spoiled& spoiled) {
  if (spoiled.count() == 0) return nullptr;
  return {{"worst", number(spoiled.worst())}, {"rms", number(spoiled.rms())}, {"count", spoiled.count()}};
}
ordered_json json_of(const Spoiled& spoiled, double ulp) {
  ordered_json json = json_of(spoiled);
  if (!json.is_null()) json.update({{"worst_ulp", number(spoiled.worst() / ulp)}, {"rms_ulp", number(spoiled.rms() / ulp)}});
  return json;
}

}  // namespace

bool is_good(const RoundingReport& report) {
  const Worst worst = worst_of(report.rounding);
  return worst.arrived > 0 && worst.position_mm <= report.position_tolerance_mm && worst.opd_waves <= report.opd_tolerance_waves && worst.off_rim == 0;
}

int surface_to_blame(const RoundingReport& report) {
  for (const Disagreement& one : report.rounding.disagreements)
    if (!one.is_on_rim) return one.surface == 0 || (one.exact_surface > 0 && one.exact_surface < one.surface) ? one.exact_surface : one.surface;
  const Worst worst = worst_of(report.rounding);
  const auto& surfaces = report.rounding.surfaces;
  if (worst.arrived == 0) {  // that ends the last of the rays
    const auto beyond = std::find_if(surfaces.begin() + 1, surfaces.end(), [](const SurfaceRounding& one) { return one.position_mm.count() == 0; });
    return static_cast<int>(beyond - surfaces.begin() - (beyond == surfaces.end() ? 1 : 0));
  }
  const bool is_opd = !(worst.opd_waves <= report.opd_tolerance_waves);
  const auto share = [&](const SurfaceRounding& one) { return is_opd ? one.share_waves.worst() : one.share_mm.worst(); };
  return static_cast<int>(std::max_element(surfaces.begin(), surfaces.end(), [&](const auto& a, const auto& b) { return share(a) < share(b); }) - surfaces.begin());
}

std::string rounding_text(const RoundingReport& report) {
  const study::Rounding& rounding = report.rounding;
  const double ulp_mm = 0x1p-52 * rounding.scale_mm;
  Table errors{{{"surface", ""}, {"name", "", true}, {"position", "worst mm"}, {"", "rms mm"}, {"", "ulp"}, {"direction", "worst rad"}, {"", "rms rad"}, {"", "ulp"}, {"OPL", "worst mm"}, {"", "rms mm"}, {"", "ulp"}}, {}};
  Table losses{{{"surface", ""}, {"name", "", true}, {"position", "mm"}, {"direction", "rad"}, {"OPL", "mm"}, {"", "of bound"}, {"digits", "lost"}, {"where", "they are lost", true}, {"in the image", "mm"}, {"", "waves"}}, {}};
  for (std::size_t k = 0; k < rounding.surfaces.size(); ++k) {
    const SurfaceRounding& one = rounding.surfaces[k];
    const std::string number = std::to_string(k), name = name_of(report, k);
    errors.rows.push_back({number, name, size(one.position_mm), mean_size(one.position_mm), in_ulp(one.position_mm, ulp_mm), size(one.direction_rad), mean_size(one.direction_rad),
                           in_ulp(one.direction_rad, 0x1p-52), size(one.opl_mm), mean_size(one.opl_mm), in_ulp(one.opl_mm, ulp_mm)});
    losses.rows.push_back({number, name, size(one.own_position_mm), size(one.own_direction_rad), size(one.own_opl_mm),
                           one.bound_position_mm.count() > 0 ? fmt::format("{:.2f}", one.of_bound) : "-", fmt::format("{:.1f}", one.digits_lost), one.cause, size(one.share_mm), size(one.share_waves)});
  }
  Table fields{{{"field", ""}, {"wavelength", "nm"}, {"rays", ""}, {"arrive", ""}, {"position", "worst mm"}, {"OPD", "worst waves"}, {"remark", "", true}}, {}};
  for (const FieldRounding& one : rounding.fields)
    fields.rows.push_back({std::to_string(one.field), fmt::format("{:g}", report.system.wavelengths_nm[one.wavelength]), std::to_string(one.rays), std::to_string(one.arrived),
                           size(one.position_mm), size(one.opd_waves), remark(one)});
  std::string text = fmt::format("{}: {} rays in double and in 50 digits\n{}\n\nhow far off the rays are behind each surface; an ulp is {:.3g} mm, of the scale {:.6g} mm, and 2.2e-16 rad\n{}\n"
                                 "what each surface has lost itself, at worst, and what that is worth in the image\n{}\n{}\n",
                                 printable(report.system.system, 200), rounding.rays, basis, ulp_mm, rounding.scale_mm, to_text(errors), to_text(losses), to_text(fields));
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
  const double ulp_mm = 0x1p-52 * rounding.scale_mm;
  const Worst worst = worst_of(rounding);
  ordered_json json{{"system", report.system.system}, {"version", report.system.version}, {"basis", basis}, {"digits", 50}, {"rays", rounding.rays}, {"scale_mm", rounding.scale_mm},
                    {"good", is_good(report)}, {"position_tolerance_mm", report.position_tolerance_mm}, {"opd_tolerance_waves", report.opd_tolerance_waves},
                    {"worst_position_mm", worst.arrived > 0 ? number(worst.position_mm) : ordered_json()}, {"worst_opd_waves", worst.with_opd > 0 ? number(worst.opd_waves) : ordered_json()}, {"surface_to_blame", is_good(report) ? ordered_json() : ordered_json(surface_to_blame(report))},
                    {"surfaces", ordered_json::array()}, {"opd_formula_waves", json_of(rounding.opd_formula_waves)}, {"fields", ordered_json::array()}, {"rays_that_end_differently", ordered_json::array()}};
  for (std::size_t k = 0; k < rounding.surfaces.size(); ++k) {
    const SurfaceRounding& one = rounding.surfaces[k];
    json["surfaces"].push_back({{"surface", k}, {"name", name_of(report, k)}, {"position_mm", json_of(one.position_mm, ulp_mm)}, {"direction_rad", json_of(one.direction_rad, 0x1p-52)}, {"opl_mm", json_of(one.opl_mm, ulp_mm)},
                                {"own_position_mm", json_of(one.own_position_mm)}, {"own_direction_rad", json_of(one.own_direction_rad)}, {"own_opl_mm", json_of(one.own_opl_mm)},
                                {"bound_position_mm", json_of(one.bound_position_mm)}, {"bound_direction_rad", json_of(one.bound_direction_rad)}, {"bound_opl_mm", json_of(one.bound_opl_mm)},
                                {"of_bound", one.bound_position_mm.count() > 0 ? ordered_json(one.of_bound) : ordered_json()}, {"without_bound", one.without_bound}, {"digits_lost", one.digits_lost}, {"cause", one.cause}, {"share_mm", json_of(one.share_mm)}, {"share_waves", json_of(one.share_waves)}});
  }
  for (const FieldRounding& one : rounding.fields)
    json["fields"].push_back({{"field", one.field}, {"wavelength_nm", report.system.wavelengths_nm[one.wavelength]}, {"rays", one.rays}, {"arrived", one.arrived},
                              {"position_mm", json_of(one.position_mm)}, {"opd_waves", json_of(one.opd_waves)}, {"without_opd", one.without_opd}, {"no_wavefront", one.no_wavefront}});
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
  Table table{{{"system", "", true}, {"rays", ""}, {"end differently", ""}, {"digits lost", ""}, {"at", "", true}, {"of bound", ""}, {"place in the image", "worst mm"}, {"OPD", "worst waves"}, {"verdict", "", true}}, {}};
  for (const RoundingReport& report : reports) {
    const auto& surfaces = report.rounding.surfaces;
    const auto worst_surface = std::max_element(surfaces.begin(), surfaces.end(), [](const auto& a, const auto& b) { return a.digits_lost < b.digits_lost; });
    const auto number = static_cast<std::size_t>(worst_surface - surfaces.begin());
    const std::string where = number == 0 ? "launch" : fmt::format("surface {}", number);
    const Worst worst = worst_of(report.rounding);
    table.rows.push_back({report.system.system, std::to_string(report.rounding.rays), std::to_string(report.rounding.disagreements.size()), fmt::format("{:.1f}", worst_surface->digits_lost),
                          worst_surface->digits_lost > 0 ? where : "", fmt::format("{:.2f}", surfaces[nearest_to_bound(report.rounding)].of_bound), worst.arrived > 0 ? fmt::format("{:.1e}", worst.position_mm) : "-",
                          worst.with_opd > 0 ? fmt::format("{:.1e}", worst.opd_waves) : "-", is_good(report) ? "good" : fmt::format("not good: {}", blamed(report))});
  }
  return fmt::format("double against 50 digits; {}\n\n{}", basis, to_text(table));
}

}  // namespace sagitta::output
