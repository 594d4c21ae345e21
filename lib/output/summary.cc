// SPDX-License-Identifier: Apache-2.0
// The results as JSON and as a table.
#include <fmt/format.h>

#include <numbers>

#include "lib/output/report_internal.h"
#include "lib/output/summary_internal.h"
#include "lib/output/text.h"

namespace sagitta::output {
namespace {

using nlohmann::ordered_json;
using surface::Status;

ordered_json pupil_json(const scene::Pupil& pupil) {
  return {{"z_mm", pupil.z}, {"semi_diameter_mm", pupil.semi_diameter}};
}

ordered_json first_order_json(const Report& report) {
  const scene::FirstOrder& paraxial = report.first_order;
  ordered_json json{{"effective_focal_length_mm", paraxial.effective_focal_length},
                    {"rear_focal_length_mm", paraxial.rear_focal_length},
                    {"back_focal_length_mm", paraxial.back_focal_length},
                    {"entrance_pupil", pupil_json(paraxial.entrance_pupil)},
                    {"exit_pupil", pupil_json(paraxial.exit_pupil)},
                    {"front_focal_length_mm", paraxial.front_focal_length},
                    {"focal_points_z_mm", {paraxial.front_focal_point, paraxial.rear_focal_point}},
                    {"principal_points_z_mm", {paraxial.front_principal_point, paraxial.rear_principal_point}},
                    {"nodal_points_z_mm", {paraxial.front_nodal_point, paraxial.rear_nodal_point}}};
  if (report.first_order_x) {
    json["entrance_pupil_x"] = pupil_json(report.first_order_x->entrance_pupil);
    json["exit_pupil_x"] = pupil_json(report.first_order_x->exit_pupil);
  }
  return json;
}

// What smoothing did to the points of each surface that asks for it.
ordered_json smoothing_json(const Report& report) {
  ordered_json result = ordered_json::array();
  for (const auto& [number, smoothing] : report.smoothing)
    result.push_back({{"surface", number},
                      {"name", report.surface_names[static_cast<std::size_t>(number - 1)]},
                      {"requested_um", 1e3 * smoothing.requested},
                      {"residual_rms_um", 1e3 * smoothing.residual_rms},
                      {"residual_max_um", 1e3 * smoothing.residual_max},
                      {"lambda_mm2", smoothing.lambda}});
  return result;
}

ordered_json rays_json(const trace::StatusCounts& rays) {
  ordered_json result{{"launched", rays.total()}};
  for (std::size_t i = 0; i < surface::status_names.size(); ++i) result[std::string(surface::status_names[i])] = rays.of[i];
  return result;
}

// Where rays were lost: surface, status, count.
ordered_json losses_json(const Report& report, const trace::StatusCounts& rays) {
  ordered_json result = ordered_json::array();
  for (const auto& [ended, count] : rays.endings)
    result.push_back({{"surface", ended / 8},
                      {"name", report.surface_names[static_cast<std::size_t>(ended / 8 - 1)]},
                      {"status", surface::status_names[static_cast<std::size_t>(ended % 8)]},
                      {"count", count}});
  return result;
}

ordered_json wavefront_json(const Report& report, const analysis::WavefrontResult& measured) {
  const analysis::Wavefront& wavefront = *measured.wavefront;
  ordered_json result{{"rms_waves", wavefront.rms_waves},
                      {"peak_to_valley_waves", wavefront.peak_to_valley_waves},
                      {"zernike", nullptr},
                      {"samples", measured.rays[Status::ok]},
                      {"reference_sphere_radius_mm", wavefront.reference_radius}};
  if (wavefront.zernike) {
    result["zernike"] = {{"indexing", "osa"},
                         {"pupil_semi_diameter_mm", report.first_order.entrance_pupil.semi_diameter},
                         {"coefficients_um", in_frame_of(report, wavefront.zernike->coefficients)},
                         {"residual_rms_um", wavefront.zernike->residual_rms}};
    if (!report.eye.empty()) result["zernike"]["frame"] = report.eye + " eye, " + osa_axes(report);
  }
  return result;
}

double degrees(double angle) { return angle * 180 / std::numbers::pi; }

ordered_json result_json(const Report& report, const analysis::JobResult& result) {
  ordered_json json = place_json(report, result);
  json["rays"] = rays_json(result.rays);
  json["lost"] = losses_json(report, result.rays);
  if (!result.coverage.empty()) {
    json["coverage"] = ordered_json::array();
    for (const auto& coverage : result.coverage)
      json["coverage"].push_back({{"surface", coverage.surface_number}, {"share", coverage.share}});
  }
  if (result.spot)
    json["spot"] = {{"centroid_mm", {result.spot->centroid_x, result.spot->centroid_y}},
                    {"rms_radius_mm", result.spot->rms_radius},
                    {"geometric_radius_mm", result.spot->geometric_radius}};
  if (const auto& angular = result.angular_spot)
    json["spot"]["from_nodal_point"] = {{"centroid_deg", {degrees(angular->centroid_x), degrees(angular->centroid_y)}},
                                        {"rms_radius_arcmin", 60 * degrees(angular->rms_radius)},
                                        {"geometric_radius_arcmin", 60 * degrees(angular->geometric_radius)}};
  if (result.wavefront) {
    if (result.wavefront->wavefront) {
      json["wavefront"] = wavefront_json(report, *result.wavefront);
    } else {
      json["wavefront"] = nullptr;
      json["reason"] = result.wavefront->reason;
    }
  }
  return json;
}

// In mm; -0 is 0.
std::string to_a_nanometre(double value) {
  return std::isfinite(value) ? fmt::format("{:.6f}", std::round(value * 1e6) / 1e6 + 0.0) : "-";
}

}  // namespace

std::string significant(double value) { return std::isfinite(value) ? fmt::format("{:.5g}", value) : "-"; }
std::string percent(double share) { return std::isfinite(share) ? fmt::format("{:.2f}", 100 * share) : "-"; }

ordered_json place_json(const Report& report, const analysis::JobResult& result) {
  ordered_json json{{"field", result.field}, {report.fields_are_heights ? "object_height_mm" : "angle_deg", report.fields[result.field]}};
  if (!report.given_fields.empty()) json[report.given_field] = report.given_fields[result.field];
  json["wavelength_nm"] = report.wavelengths_nm[result.wavelength];
  return json;
}

std::string osa_axes(const Report& report) {
  return report.pupil_is_of_stop ? "OSA axes over the stop: x against the stop's own x (to the examiner's right unless the stop is turned), y along its y" : "OSA axes: x to the examiner's right, y up";
}

std::vector<double> in_frame_of(const Report& report, std::vector<double> osa) {
  for (std::size_t j = 0; j < osa.size() && !report.eye.empty(); ++j) {
    const numerics::ZernikeTerm term = numerics::zernike_term(numerics::ZernikeIndexing::osa, static_cast<int>(j));
    if (term.m < 0 ? term.m % 2 == 0 : term.m % 2 != 0) osa[j] = -osa[j];
  }
  return osa;
}

ordered_json report_json(const Report& report) {
  ordered_json json{{"system", report.system},
                    {"version", report.version},
                    {"first_order", first_order_json(report)},
                    {"results", ordered_json::array()}};
  if (!report.eye.empty()) {
    json["eye"] = report.eye;
    json["frame"] = tracers_frame;
  }
  for (const auto& [name, value] : report.parameters) json["parameters"][name] = value;
  if (!report.smoothing.empty()) json["smoothing"] = smoothing_json(report);
  for (const auto& part : report.parts) json["triangulated"].push_back({{"surface", part.surface}, {"points", part.points}, {"used", part.used}});
  for (const auto& result : report.results) json["results"].push_back(result_json(report, result));
  if (const std::string note = facets_note(report); !note.empty()) json["note"] = note;
  if (report.plan) json["plan"] = plan_json(report);
  return json;
}

std::string text_of(const ordered_json& json) { return json.dump(1, ' ', false, ordered_json::error_handler_t::replace) + "\n"; }

std::string summary_json(const Report& report) { return text_of(report_json(report)); }

std::vector<std::string> remarks(const Report& report, const analysis::JobResult& result) {
  std::vector<std::string> lines;
  const std::string at = fmt::format("field {} at {:g} nm", result.field, report.wavelengths_nm[result.wavelength]);
  if (result.wavefront && !result.wavefront->wavefront)
    lines.push_back(fmt::format("no wavefront of {}: {}", at, result.wavefront->reason));
  for (const auto& [ended, count] : result.rays.endings)
    lines.push_back(fmt::format("{}: {} rays {} at surface {} {}", at, count, surface::status_names[static_cast<std::size_t>(ended % 8)],
                                ended / 8, report.surface_names[static_cast<std::size_t>(ended / 8 - 1)]));
  return lines;
}

std::string summary_text(const Report& report) {
  const bool spots = !report.results.empty() && report.results.front().spot;
  const bool wavefronts = !report.results.empty() && report.results.front().wavefront;
  const bool angles = !report.results.empty() && report.results.front().angular_spot;
  const bool covers = !report.results.empty() && !report.results.front().coverage.empty();
  Table table;
  const auto column = [&](std::string name, std::string unit = {}) { table.columns.push_back({std::move(name), std::move(unit)}); };
  const std::string field_unit = report.fields_are_heights ? "mm" : "deg";
  column("field");
  column("x", field_unit);
  column("y", field_unit);
  column("wavelength", "nm");
  column("launched");
  column("ok");
  column("lost");
  if (covers) column("coverage", "%");
  if (spots) {
    column("centroid x", "mm");
    column("centroid y", "mm");
    column("RMS radius", "um");
    column("geometric", "um");
  }
  if (angles) column("RMS radius", "arcmin");
  if (wavefronts) {
    column("OPD RMS", "waves");
    column("OPD P-V", "waves");
  }
  std::string below;
  for (const auto& [number, smoothing] : report.smoothing)
    below += fmt::format("surface {} {} is smoothed: its heights leave the points by {} um rms, {} um at most\n", number,
                           report.surface_names[static_cast<std::size_t>(number - 1)], significant(1e3 * smoothing.residual_rms),
                           significant(1e3 * smoothing.residual_max));
  for (const auto& result : report.results) {
    const auto& field = report.fields[result.field];
    const std::int64_t launched = result.rays.total(), ok = result.rays[Status::ok];
    std::vector<std::string> row{std::to_string(result.field), fmt::format("{:g}", field[0]), fmt::format("{:g}", field[1]),
                                 fmt::format("{:g}", report.wavelengths_nm[result.wavelength]), std::to_string(launched),
                                 std::to_string(ok), std::to_string(launched - ok)};
    if (covers) row.push_back(percent(result.coverage.front().share));
    if (result.spot)
      for (const double value : {result.spot->centroid_x, result.spot->centroid_y}) row.push_back(to_a_nanometre(value));
    if (result.spot)
      for (const double value : {1e3 * result.spot->rms_radius, 1e3 * result.spot->geometric_radius})
        row.push_back(significant(value));
    if (result.angular_spot) row.push_back(significant(60 * degrees(result.angular_spot->rms_radius)));
    if (result.wavefront) {
      const auto& wavefront = result.wavefront->wavefront;
      row.push_back(wavefront ? significant(wavefront->rms_waves) : "-");
      row.push_back(wavefront ? significant(wavefront->peak_to_valley_waves) : "-");
    }
    table.rows.push_back(std::move(row));
    for (const std::string& line : remarks(report, result)) below += line + "\n";
  }
  if (const std::string note = facets_note(report); !note.empty()) below += note + "\n";
  const scene::FirstOrder& paraxial = report.first_order;
  const auto of_pupil = [](const scene::Pupil& pupil) { return fmt::format("{} mm wide at z = {} mm", significant(2 * pupil.semi_diameter), significant(pupil.z)); };
  return fmt::format("{}{}\neffective focal length {} mm, back focal length {} mm, entrance pupil {}{}\n\n{}{}{}",
                     printable(report.system, 200), report.eye.empty() ? "" : fmt::format("; {} eye, {}", report.eye, tracers_frame), significant(paraxial.effective_focal_length), significant(paraxial.back_focal_length),
                     of_pupil(paraxial.entrance_pupil), report.first_order_x ? ", of the x section " + of_pupil(report.first_order_x->entrance_pupil) : "",
                     to_text(table), below.empty() ? "" : "\n", below);
}

}  // namespace sagitta::output
