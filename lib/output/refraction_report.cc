// SPDX-License-Identifier: Apache-2.0
#include "lib/output/refraction_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>

#include "lib/output/report_internal.h"
#include "lib/output/summary_internal.h"
#include "lib/output/text.h"

namespace sagitta::output {
namespace {

using analysis::Power;
using nlohmann::ordered_json;

std::string plane_of(const RefractionReport& report) {
  if (report.vertex_distance_mm == 0) return report.is_eye ? "the cornea's vertex plane" : "the vertex plane of surface 1";
  if (report.vertex_distance_mm < 0) return fmt::format("the plane {:g} mm behind the vertex of {}", -report.vertex_distance_mm, report.is_eye ? "the cornea" : "surface 1");
  return fmt::format("the {}plane {:g} mm before {}", report.is_eye ? "spectacle " : "", report.vertex_distance_mm, report.is_eye ? "the cornea" : "surface 1");
}
std::string eye_of(const RefractionReport& report) {
  if (!report.is_eye) return "no eye, for its image is in air: the image surface is taken for the retina";
  return report.system.eye.empty() ? "which eye is not said (`eye: right` or `left` in the prescription)" : report.system.eye + " eye";
}
// "" where there is nothing to say.
std::string facets_note_of(const Report& system) {
  const std::string facets = flat_facets(system);
  return facets.empty() ? "" : facets + "refractions, whose rays near the chief ray meet single facets: take c1";
}
constexpr const char* frame = "OSA axes: x to the examiner's right, y up, the axis anticlockwise from x";

// A hundredth of the least step of a trial lens is .0025 D.
std::string dioptres(double value) { return std::isfinite(value) ? fmt::format("{:+.4f}", std::round(value * 1e4) / 1e4 + 0.0) : "-"; }

std::vector<std::string> cells(const Power& power) {
  const analysis::Spectacles lens = spectacles(power);
  const bool has_axis = lens.cylinder <= -.00005;  // as printed
  const double axis = std::round(10 * lens.axis_deg) / 10;
  return {dioptres(power.M()), dioptres(power.J0()), dioptres(power.J45()), dioptres(lens.sphere), dioptres(lens.cylinder), has_axis ? fmt::format("{:.1f}", axis == 0 ? 180 : axis) : "-"};
}
ordered_json power_json(const Power& power) {
  const analysis::Spectacles lens = spectacles(power);
  return {{"M_D", power.M()}, {"J0_D", power.J0()}, {"J45_D", power.J45()}, {"sphere_D", lens.sphere}, {"cylinder_D", lens.cylinder}, {"axis_deg", lens.axis_deg}};
}

// M of the paraxial refraction at the longest less that at the shortest of the wavelengths that have one; of one field.
struct ChromaticDifference {
  double shortest_nm = 0, longest_nm = 0, dioptres = 0;
};
std::vector<std::optional<ChromaticDifference>> chromatic_differences(const RefractionReport& report) {
  const std::vector<double>& nm = report.system.wavelengths_nm;
  std::vector<std::optional<ChromaticDifference>> result;
  for (std::size_t field = 0; field < report.system.fields.size(); ++field) {
    std::vector<std::pair<double, double>> by_wavelength;
    for (std::size_t w = 0; w < nm.size(); ++w)
      if (const auto& one = report.results[field * nm.size() + w].refraction) by_wavelength.push_back({nm[w], one->paraxial.M()});
    std::sort(by_wavelength.begin(), by_wavelength.end());
    if (by_wavelength.size() < 2) result.emplace_back();
    else result.push_back(ChromaticDifference{by_wavelength.front().first, by_wavelength.back().first, by_wavelength.back().second - by_wavelength.front().second});
  }
  return result;
}

}  // namespace

std::string refraction_text(const RefractionReport& report) {
  const Report& system = report.system;
  const std::string unit = system.fields_are_heights ? "mm" : "deg";
  Table table{{{"field", ""}, {"x", unit}, {"y", unit}, {"wavelength", "nm"}, {"by", "", true}, {"M", "D"}, {"J0", "D"}, {"J45", "D"}, {"sphere", "D"}, {"cylinder", "D"}, {"axis", "deg"}}, {}};
  std::string below;
  for (std::size_t i = 0; i < report.results.size(); ++i) {
    const std::size_t field = i / system.wavelengths_nm.size(), w = i % system.wavelengths_nm.size();
    const auto row = [&](const char* by, const Power& power) {
      std::vector<std::string> texts{std::to_string(field), fmt::format("{:g}", system.fields[field][0]), fmt::format("{:g}", system.fields[field][1]),
                                     fmt::format("{:g}", system.wavelengths_nm[w]), by};
      for (std::string& cell : cells(power)) texts.push_back(std::move(cell));
      table.rows.push_back(std::move(texts));
    };
    const analysis::RefractionResult& result = report.results[i];
    if (!result.refraction) {
      below += fmt::format("no refraction of field {} at {:g} nm: {}\n", field, system.wavelengths_nm[w], result.reason);
      continue;
    }
    if (result.refraction->least_squares) row("least squares", *result.refraction->least_squares);
    if (result.refraction->at_centre) row("at the centre", *result.refraction->at_centre);
    row("paraxial", result.refraction->paraxial);
    row("far point", result.refraction->far_point);
  }
  const auto chromatic = chromatic_differences(report);
  for (std::size_t field = 0; field < chromatic.size(); ++field)
    if (const auto& one = chromatic[field])
      below += fmt::format("longitudinal chromatic aberration of field {}: {} D from {:g} to {:g} nm (paraxial M)\n", field, dioptres(one->dioptres), one->shortest_nm, one->longest_nm);
  if (const std::string note = facets_note_of(system); !note.empty()) below += note + "\n";
  return fmt::format("{}: refraction at {}; {}\n{}; entrance pupil {} mm wide\n\n{}{}{}", printable(system.system, 200), plane_of(report), eye_of(report), frame,
                     significant(2 * system.first_order.entrance_pupil.semi_diameter), to_text(table), below.empty() ? "" : "\n", below);
}

Chart refraction_chart(const RefractionReport& report) {
  using analysis::Refraction;
  const Report& system = report.system;
  const std::vector<double>& nm = system.wavelengths_nm;
  Chart chart;
  chart.title = fmt::format("Refraction of {}", system.system);
  chart.x_label = "wavelength (nm)";
  chart.y_label = system.fields.size() == 1 ? "M (D)" : "paraxial M (D)";
  chart.x_scale = chart.y_scale = AxisScale::linear;
  chart.footer = fmt::format("at {}{}; sagitta {}", plane_of(report), system.eye.empty() ? "" : fmt::format(", {} eye", system.eye), system.version);
  chart.empty_note = "no field has a refraction";
  const auto add = [&](std::string name, std::size_t field, const std::function<std::optional<Power>(const Refraction&)>& power) {
    ChartSeries series{.name = std::move(name), .points = {}, .is_joined = true, .fit = {}};
    for (std::size_t w = 0; w < nm.size(); ++w)
      if (const auto& one = report.results[field * nm.size() + w].refraction)
        if (const auto found = power(*one)) series.points.push_back({nm[w], found->M()});
    std::sort(series.points.begin(), series.points.end(), [](const ChartPoint& a, const ChartPoint& b) { return a.x < b.x; });
    chart.series.push_back(std::move(series));
  };
  const auto paraxial = [](const Refraction& one) { return std::optional(one.paraxial); };
  for (std::size_t field = 0; field < system.fields.size() && system.fields.size() > 1; ++field)
    add(fmt::format("({:g}, {:g}) {}", system.fields[field][0], system.fields[field][1], system.fields_are_heights ? "mm" : "deg"), field, paraxial);
  if (system.fields.size() > 1) return chart;
  add("least squares", 0, [](const Refraction& one) { return one.least_squares; });
  add("paraxial", 0, paraxial);
  return chart;
}

std::string refraction_json(const RefractionReport& report) {
  const Report& system = report.system;
  ordered_json json{{"system", system.system},
                    {"version", system.version},
                    {"eye", system.eye.empty() ? ordered_json(nullptr) : ordered_json(system.eye)},
                    {"is_eye", report.is_eye},
                    {"frame", frame},
                    {"vertex_distance_mm", report.vertex_distance_mm},
                    {"entrance_pupil_semi_diameter_mm", system.first_order.entrance_pupil.semi_diameter},
                    {"results", ordered_json::array()},
                    {"longitudinal_chromatic_aberration", ordered_json::array()}};
  for (std::size_t i = 0; i < report.results.size(); ++i) {
    analysis::JobResult place;
    place.field = i / system.wavelengths_nm.size(), place.wavelength = i % system.wavelengths_nm.size();
    ordered_json one = place_json(system, place);
    const analysis::RefractionResult& result = report.results[i];
    one["refraction"] = nullptr;
    if (result.refraction)
      one["refraction"] = {{"least_squares", result.refraction->least_squares ? power_json(*result.refraction->least_squares) : ordered_json(nullptr)},
                           {"at_centre", result.refraction->at_centre ? power_json(*result.refraction->at_centre) : ordered_json(nullptr)},
                           {"paraxial", power_json(result.refraction->paraxial)},
                           {"far_point", power_json(result.refraction->far_point)}};
    else one["reason"] = result.reason;
    json["results"].push_back(std::move(one));
  }
  if (const std::string note = facets_note_of(system); !note.empty()) json["note"] = note;
  const auto chromatic = chromatic_differences(report);
  for (std::size_t field = 0; field < chromatic.size(); ++field)
    if (const auto& one = chromatic[field])
      json["longitudinal_chromatic_aberration"].push_back({{"field", field}, {"shortest_nm", one->shortest_nm}, {"longest_nm", one->longest_nm}, {"difference_D", one->dioptres}});
  return text_of(json);
}

}  // namespace sagitta::output
