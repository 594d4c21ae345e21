// SPDX-License-Identifier: Apache-2.0
// A comparison as JSON and as tables.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lib/numerics/zernike_basis.h"
#include "lib/output/comparison.h"
#include "lib/output/report_internal.h"
#include "lib/output/summary_internal.h"
#include "lib/output/text.h"

namespace sagitta::output {
namespace {

using nlohmann::ordered_json;
using surface::Status;

constexpr std::size_t highest_shown = 15;  // Zernike terms of orders 0 to 4

// The report by whose frame coefficients are told: that of the first system that has an eye, if there is one.
const Report& framing(const Comparison& comparison) {
  const auto eye = std::find_if(comparison.systems.begin(), comparison.systems.end(), [](const ComparedSystem& one) { return !one.report.eye.empty(); });
  return (eye == comparison.systems.end() ? comparison.systems.front() : *eye).report;
}

ordered_json difference_json(const Report& framed, const Report& report, std::size_t i, const analysis::Difference& difference) {
  ordered_json json = place_json(report, report.results[i]);
  json["spot"] = {{"rms_radius_difference_um", 1e3 * difference.spot.rms_radius},
                  {"rms_radius_difference_percent", difference.spot.rms_radius_percent},
                  {"centroid_shift_mm", difference.spot.centroid_shift}};
  json["wavefront"] = nullptr;
  if (const auto& wavefront = difference.wavefront) {
    json["wavefront"] = {{"mean_waves", wavefront->mean_waves},
                         {"rms_waves", wavefront->rms_waves},
                         {"rms_without_tilt_waves", wavefront->rms_without_tilt_waves},
                         {"peak_to_valley_waves", wavefront->peak_to_valley_waves},
                         {"samples", wavefront->in_both},
                         {"samples_only_in_first", wavefront->only_in_first},
                         {"samples_only_in_this", wavefront->only_in_other},
                         {"zernike", nullptr}};
    if (!wavefront->zernike_um.empty()) {
      json["wavefront"]["zernike"] = {{"indexing", "osa"}, {"coefficients_um", in_frame_of(framed, wavefront->zernike_um)}};
      if (!framed.eye.empty()) json["wavefront"]["zernike"]["frame"] = osa_axes(framed);
    }
  } else {
    json["reason"] = "one of the two has no wavefront";
  }
  return json;
}

Table main_table(const Comparison& comparison) {
  const Report& first = comparison.systems.front().report;
  const auto any = [&](auto&& has) { return std::any_of(comparison.systems.begin(), comparison.systems.end(), has); };
  const bool covers = any([](const ComparedSystem& one) { return !one.report.results.front().coverage.empty(); });
  const bool fits = any([](const ComparedSystem& one) { return one.fit.has_value(); });
  const std::string field_unit = first.fields_are_heights ? "mm" : "deg";
  Table table{{{"field", ""}, {"x", field_unit}, {"y", field_unit}, {"wavelength", "nm"}, {"system", "", true}, {"ok", ""}, {"lost", ""}}, {}};
  if (covers) table.columns.push_back({"coverage", "%"});
  for (const Column& column : std::initializer_list<Column>{{"RMS radius", "um"}, {"change", "um"}, {"change", "%"}, {"OPD RMS", "waves"},
                                                            {"OPD P-V", "waves"}, {"change RMS", "waves"},
                                                            {"without tilt", "waves"}, {"change P-V", "waves"}})
    table.columns.push_back(column);
  if (fits) table.columns.push_back({"fit RMS", "um"});
  for (std::size_t i = 0; i < first.results.size(); ++i)
    for (const ComparedSystem& system : comparison.systems) {
      const analysis::JobResult& result = system.report.results[i];
      const auto& field = first.fields[result.field];
      const auto& wavefront = result.wavefront->wavefront;
      const analysis::Difference& difference = system.differences[i];
      const std::int64_t ok = result.rays[Status::ok];
      std::vector<std::string> row{std::to_string(result.field), fmt::format("{:g}", field[0]), fmt::format("{:g}", field[1]),
                                   fmt::format("{:g}", first.wavelengths_nm[result.wavelength]), system.report.system,
                                   std::to_string(ok), std::to_string(result.rays.total() - ok)};
      if (covers) row.push_back(result.coverage.empty() ? "" : percent(result.coverage.front().share));
      row.push_back(significant(1e3 * result.spot->rms_radius));
      const bool is_first = &system == &comparison.systems.front();
      row.push_back(is_first ? "" : significant(1e3 * difference.spot.rms_radius));
      row.push_back(is_first ? "" : significant(difference.spot.rms_radius_percent));
      row.push_back(wavefront ? significant(wavefront->rms_waves) : "-");
      row.push_back(wavefront ? significant(wavefront->peak_to_valley_waves) : "-");
      row.push_back(is_first ? "" : difference.wavefront ? significant(difference.wavefront->rms_waves) : "-");
      row.push_back(is_first ? "" : difference.wavefront ? significant(difference.wavefront->rms_without_tilt_waves) : "-");
      row.push_back(is_first ? "" : difference.wavefront ? significant(difference.wavefront->peak_to_valley_waves) : "-");
      if (system.fit) row.push_back(significant(system.fit->residual_rms_um));
      table.rows.push_back(std::move(row));
    }
  return table;
}

// Coefficients side by side: those up to the 4th order, and the root of the sum of squares of the others.
Table zernike_table(const Comparison& comparison, std::size_t i) {
  Table table{{{"j", ""}, {"n", ""}, {"m", ""}}, {}};
  std::size_t term_count = 0;
  std::vector<std::vector<double>> columns;
  for (const ComparedSystem& system : comparison.systems) {
    const auto& wavefront = system.report.results[i].wavefront->wavefront;
    if (!wavefront || !wavefront->zernike) continue;
    table.columns.push_back({system.report.system, "um"});
    columns.push_back(in_frame_of(framing(comparison), wavefront->zernike->coefficients));
    term_count = std::max(term_count, columns.back().size());
  }
  if (columns.empty()) return {};
  const auto in_um = [](double value) { return fmt::format("{:.4f}", std::round(value * 1e4) / 1e4 + 0.0); };  // -0 is 0
  for (std::size_t j = 0; j < std::min(term_count, highest_shown); ++j) {
    const auto term = numerics::zernike_term(numerics::ZernikeIndexing::osa, static_cast<int>(j));
    std::vector<std::string> row{std::to_string(j), std::to_string(term.n), std::to_string(term.m)};
    for (const auto& column : columns) row.push_back(in_um(column[j]));
    table.rows.push_back(std::move(row));
  }
  std::vector<std::string> higher{"higher", "", ""};
  for (const auto& column : columns) {
    double squares = 0;
    for (std::size_t j = highest_shown; j < column.size(); ++j) squares += column[j] * column[j];
    higher.push_back(in_um(std::sqrt(squares)));
  }
  table.rows.push_back(std::move(higher));
  return table;
}

// Where the numbers of a system are to be read with care beside those of the first.
std::vector<std::string> cautions(const Comparison& comparison, const ComparedSystem& system, std::size_t i) {
  std::vector<std::string> lines;
  const ComparedSystem& first = comparison.systems.front();
  const analysis::JobResult &result = system.report.results[i], &of_first = first.report.results[i];
  const std::string at = fmt::format("field {} at {:g} nm", result.field, system.report.wavelengths_nm[result.wavelength]);
  for (const analysis::Coverage& coverage : result.coverage)
    if (system.fit && coverage.surface_number == system.fit->surface_number && coverage.share < 1)
      lines.push_back(fmt::format("{}: {:.3g} % of the rays meet the surface beyond the circle of its fit, where it is extrapolated", at, 100 * (1 - coverage.share)));
  if (result.rays.endings != of_first.rays.endings)
    lines.push_back(fmt::format("{}: its spot is of {} rays, that of {} of {}: not of the same rays", at, result.rays[Status::ok],
                                printable(first.report.system, 80), of_first.rays[Status::ok]));
  return lines;
}

}  // namespace

std::string eyes_of(const Comparison& comparison) {
  const std::string eye = framing(comparison).eye;
  if (eye.empty()) return {};
  if (std::all_of(comparison.systems.begin(), comparison.systems.end(), [&](const ComparedSystem& one) { return one.report.eye == eye; })) return eye + " eye";
  std::vector<std::string> all;
  for (const ComparedSystem& one : comparison.systems) all.push_back(printable(one.report.system, 80) + (one.report.eye.empty() ? ": eye not said" : fmt::format(": {} eye", one.report.eye)));
  return fmt::format("{}", fmt::join(all, ", "));
}

std::string summary_json(const Comparison& comparison) {
  const ComparedSystem& first = comparison.systems.front();
  ordered_json json{{"comparison", comparison.title},
                    {"version", first.report.version},
                    {"rays_of", first.report.system},
                    {"systems", ordered_json::array()},
                    {"differences", ordered_json::array()}};
  for (const ComparedSystem& system : comparison.systems) {
    ordered_json one = report_json(system.report);
    one["slug"] = system.slug;
    if (system.fit)
      one["fit"] = {{"terms", system.fit->terms}, {"surface", system.fit->surface_number}, {"radius_mm", system.fit->radius_mm}, {"residual_rms_um", system.fit->residual_rms_um}};
    json["systems"].push_back(std::move(one));
    if (&system == &first) continue;
    ordered_json of{{"system", system.report.system}, {"from", first.report.system}, {"results", ordered_json::array()}};
    for (std::size_t i = 0; i < system.differences.size(); ++i)
      of["results"].push_back(difference_json(framing(comparison), system.report, i, system.differences[i]));
    json["differences"].push_back(std::move(of));
  }
  return text_of(json);
}

std::string summary_text(const Comparison& comparison) {
  const Report& first = comparison.systems.front().report;
  const scene::Pupil& pupil = first.first_order.entrance_pupil;
  std::string text = fmt::format("{}\nthe rays of {}: entrance pupil {} mm wide at z = {} mm; changes are from it\n\n{}",
                                 printable(comparison.title, 200), printable(first.system, 80), significant(2 * pupil.semi_diameter),
                                 significant(pupil.z), to_text(main_table(comparison)));
  for (std::size_t field = 0; field < first.fields.size(); ++field) {
    const std::size_t i = field * first.wavelengths_nm.size() + comparison.primary;
    const Table table = zernike_table(comparison, i);
    if (!table.rows.empty())
      text += fmt::format("\nZernike coefficients (osa) of the wavefronts, {}{}\n\n{}", panel_title(first, first.results[i]), framing(comparison).eye.empty() ? "" : fmt::format("; {}, {}", eyes_of(comparison), osa_axes(framing(comparison))), to_text(table));
  }
  std::string below;
  for (const ComparedSystem& system : comparison.systems) {
    const std::string name = printable(system.report.system, 80);
    if (system.fit)
      below += fmt::format("{}: {} terms over the points within {} mm, which it misses by {} um rms\n", name, system.fit->terms,
                           significant(system.fit->radius_mm), significant(system.fit->residual_rms_um));
    if (const std::string note = facets_note(system.report); !note.empty()) below += fmt::format("{}: {}\n", name, note);
    for (const auto& result : system.report.results)
      for (const std::string& line : remarks(system.report, result)) below += fmt::format("{}: {}\n", name, line);
    for (std::size_t i = 0; i < system.report.results.size(); ++i)
      for (const std::string& line : cautions(comparison, system, i)) below += fmt::format("{}: {}\n", name, line);
  }
  return text + (below.empty() ? "" : "\n") + below;
}

std::string slug_of(const std::string& name) {
  std::string slug;
  for (const char c : name) {
    const bool is_upper = c >= 'A' && c <= 'Z', is_plain = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9');
    if (is_upper || is_plain)
      slug += is_upper ? static_cast<char>(c - 'A' + 'a') : c;
    else if (!slug.empty() && slug.back() != '-')
      slug += '-';
  }
  while (slug.ends_with('-')) slug.pop_back();
  return slug.empty() ? "system" : slug.substr(0, 60);
}

}  // namespace sagitta::output
