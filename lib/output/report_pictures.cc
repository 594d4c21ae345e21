// SPDX-License-Identifier: Apache-2.0
// The results as EXR parts and as figures.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "lib/output/report_internal.h"

namespace sagitta::output {
namespace {

std::string field_label(const Report& report, std::size_t field) {
  if (!report.given_fields.empty()) {  // "real image height (0, 2) mm"
    const auto& [x, y] = report.given_fields[field];
    const bool are_angles = report.given_field.ends_with("_deg");
    std::string name = report.given_field.substr(0, report.given_field.rfind('_'));
    std::replace(name.begin(), name.end(), '_', ' ');
    return are_angles ? fmt::format("{} ({:g}°, {:g}°)", name, x, y) : fmt::format("{} ({:g}, {:g}) mm", name, x, y);
  }
  const auto& [x, y] = report.fields[field];
  return report.fields_are_heights ? fmt::format("object ({:g}, {:g}) mm", x, y) : fmt::format("field ({:g}°, {:g}°)", x, y);
}

std::string footer(const Report& report) { return pictures_footer(report.eye.empty() ? "" : report.eye + " eye", report.version); }

}  // namespace

std::string part_name(const Report& report, const analysis::JobResult& result, const char* quantity) {
  return fmt::format("{}.field{}.{}nm", quantity, result.field, report.wavelengths_nm[result.wavelength]);
}

std::string panel_title(const Report& report, const analysis::JobResult& result) {
  return fmt::format("{}, {:g} nm", field_label(report, result.field), report.wavelengths_nm[result.wavelength]);
}

std::vector<ExrAttribute> common_attributes(const Report& report, const analysis::JobResult& result,
                                            const trace::StatusCounts& rays) {
  const auto& [x, y] = report.fields[result.field];
  std::vector<ExrAttribute> attributes{{"system", report.system},
                                       {"software", "sagitta " + report.version},
                                       {"field", static_cast<int>(result.field)},
                                       {report.fields_are_heights ? "object_height_mm" : "angle_deg", std::array{static_cast<float>(x), static_cast<float>(y)}},
                                       {"wavelength_nm", report.wavelengths_nm[result.wavelength]},
                                       {"rays_launched", static_cast<double>(rays.total())},
                                       {"rays_ok", static_cast<double>(rays[surface::Status::ok])}};
  if (!report.eye.empty()) attributes.push_back({"eye", fmt::format("{}, {}", report.eye, tracers_frame)});
  return attributes;
}

std::vector<ExrAttribute> pupil_map_attributes(const Report& report, int size) {
  const double semi_diameter = report.first_order.entrance_pupil.semi_diameter;
  const auto pixel = static_cast<float>(semi_diameter / (size / 2 - 1));
  std::vector<ExrAttribute> attributes{{"units.Y", "waves"},
                                       {"grid", fmt::format("column i and row N-1-j stand at (i - N/2, j - N/2)/(N/2 - 1) of the unit pupil, N = {}; x right, y up", size)}};
  if (report.pupil_is_of_stop) attributes.push_back({"pupil", "the stop: the unit pupil is its disc; sizes in mm are those of the paraxial entrance pupil"});
  if (std::isfinite(semi_diameter)) {  // a telecentric beam has no pupil of finite size
    attributes.push_back({"pixel_size_mm", std::array{pixel, pixel}});
    attributes.push_back({"centre_mm", std::array{-pixel / 2, -pixel / 2}});  // the chief ray's sample is column N/2
    attributes.push_back({"pupil_semi_diameter_mm", semi_diameter});
  }
  if (const std::string note = facets_note(report); !note.empty()) attributes.push_back({"note", note});
  return attributes;
}

std::vector<ExrPart> spot_parts(const Report& report) {
  std::vector<ExrPart> parts;
  for (const auto& result : report.results) {
    const analysis::SpotImage& image = *result.spot_image;
    const auto pixel = static_cast<float>(image.pixel_mm);
    ExrPart part{part_name(report, result, "spot"), image.size, image.size, {{"Y", floats(image.counts)}}, common_attributes(report, result, result.rays)};
    part.attributes.push_back({"quantity", "ray count per pixel"});
    part.attributes.push_back({"units.Y", "rays"});
    part.attributes.push_back({"pixel_size_mm", std::array{pixel, pixel}});
    part.attributes.push_back({"centre_mm", std::array{static_cast<float>(image.centre_x), static_cast<float>(image.centre_y)}});
    part.attributes.push_back({"frame", "local x (right) and y (up) of the image surface; row 0 is the largest y"});
    parts.push_back(std::move(part));
  }
  return parts;
}

std::vector<ExrPart> wavefront_parts(const Report& report) {
  std::vector<ExrPart> parts;
  for (const auto& result : report.results) {
    if (!result.wavefront->wavefront) continue;
    const analysis::Wavefront& wavefront = *result.wavefront->wavefront;
    ExrPart part{part_name(report, result, "wavefront"), wavefront.size, wavefront.size,
                 {{"Y", floats(wavefront.opd_waves)}, {"wavefront.mask", wavefront.mask}}, common_attributes(report, result, result.wavefront->rays)};
    part.attributes.push_back({"quantity", report.pupil_is_of_stop ? "optical path difference over the stop" : "optical path difference over the entrance pupil"});
    part.attributes.push_back({"sign", "OPD = OPL(chief ray) - OPL(ray), both to the reference sphere"});
    part.attributes.push_back({"mask", "0 ok, 1 missed, 2 clipped, 3 total_reflection, 4 outside_data, 5 not_converged, 255 outside the pupil"});
    for (ExrAttribute& attribute : pupil_map_attributes(report, wavefront.size)) part.attributes.push_back(std::move(attribute));
    part.attributes.push_back({"reference_sphere_radius_mm", wavefront.reference_radius});
    part.attributes.push_back({"rms_waves", wavefront.rms_waves});
    part.attributes.push_back({"peak_to_valley_waves", wavefront.peak_to_valley_waves});
    parts.push_back(std::move(part));
  }
  return parts;
}

Panel spot_panel(const Report& report, const analysis::JobResult& result) {
  const analysis::SpotImage& image = *result.spot_image;
  const analysis::Spot& spot = *result.spot;
  Panel panel;
  panel.title = panel_title(report, result);
  panel.subtitle = {fmt::format("RMS {:.4g} µm, geometric {:.4g} µm", 1e3 * spot.rms_radius, 1e3 * spot.geometric_radius),
                    fmt::format("{}{} of {} rays", result.angular_spot ? fmt::format("RMS {:.4g} arcmin from N', ", 60 * 180 / std::numbers::pi * result.angular_spot->rms_radius) : "", result.rays[surface::Status::ok], result.rays.total())};
  panel.map = {image.size, image.size, floats(image.counts)};
  panel.axes = {image.pixel_mm, image.pixel_mm, image.centre_x, image.centre_y};
  panel.zero_is_background = true;
  panel.log_scale = true;
  panel.quantity = "rays per pixel";
  panel.empty_note = "no ray arrived";
  if (spot.rms_radius > 0) panel.circles = {{spot.centroid_x, spot.centroid_y, spot.rms_radius, ""}};
  return panel;
}

Panel pupil_panel(const Report& report, int size, const std::vector<double>& opd_waves, const std::string& empty_note) {
  const bool has_size = std::isfinite(report.first_order.entrance_pupil.semi_diameter) && !report.pupil_is_of_stop;
  const double pupil = has_size ? report.first_order.entrance_pupil.semi_diameter : 1;  // telecentric, or points of the stop: the unit disc
  Panel panel;
  panel.axes.unit_mm = has_size;
  panel.color_map = ColorMap::diverging;
  panel.quantity = "OPD";
  panel.unit = "waves";
  panel.axes.x_label = report.pupil_is_of_stop ? "stop x" : "pupil x";
  panel.axes.y_label = report.pupil_is_of_stop ? "stop y" : "pupil y";
  panel.empty_note = empty_note;
  if (opd_waves.empty()) {
    panel.map = {2, 2, std::vector<float>(4, std::numeric_limits<float>::quiet_NaN())};
    panel.axes.pixel_width = panel.axes.pixel_height = pupil;
    return panel;
  }
  panel.map = {size, size, floats(opd_waves)};
  // the chief ray's sample is column N/2, so the middle of the map lies half a pixel before it (above it in y)
  const double pixel = pupil / (size / 2 - 1);
  panel.axes.pixel_width = panel.axes.pixel_height = pixel;
  panel.axes.center_x = panel.axes.center_y = -pixel / 2;
  return panel;
}

Panel wavefront_panel(const Report& report, const analysis::JobResult& result) {
  const auto& wavefront = result.wavefront->wavefront;
  Panel panel = wavefront ? pupil_panel(report, wavefront->size, wavefront->opd_waves, "no ray arrived")
                          : pupil_panel(report, 0, {}, result.wavefront->reason);
  panel.title = panel_title(report, result);
  if (wavefront) panel.subtitle = {fmt::format("RMS {:.4g}, P-V {:.4g} waves", wavefront->rms_waves, wavefront->peak_to_valley_waves)};
  if (wavefront && !report.surfaces_of_flat_facets.empty()) panel.subtitle.push_back("flat facets: not to be used");
  return panel;
}

Figure spot_figure(const Report& report) {
  Figure figure{"Spots: " + report.system, "circle: RMS radius about the centroid; " + footer(report), {}, static_cast<int>(std::min<std::size_t>(3, report.wavelengths_nm.size()))};
  if (report.wavelengths_nm.size() == 1) figure.columns = static_cast<int>(std::min<std::size_t>(3, report.fields.size()));
  for (const auto& result : report.results) figure.panels.push_back(spot_panel(report, result));
  return figure;
}

Figure wavefront_figure(const Report& report) {
  Figure figure{"Wavefronts, OPD = OPL(chief) − OPL(ray): " + report.system, footer(report), {}, 3};
  figure.columns = static_cast<int>(std::min<std::size_t>(3, report.wavelengths_nm.size() == 1 ? report.fields.size() : report.wavelengths_nm.size()));
  for (const auto& result : report.results) figure.panels.push_back(wavefront_panel(report, result));
  return figure;
}

std::string pictures_footer(const std::string& eyes, const std::string& version) {
  return (eyes.empty() ? "" : fmt::format("{}, {}; ", eyes, tracers_frame)) + "sagitta " + version;
}

std::string flat_facets(const Report& report) {
  if (report.surfaces_of_flat_facets.empty()) return {};
  std::vector<std::string> names;
  for (const int number : report.surfaces_of_flat_facets)
    names.push_back(fmt::format("surface {} {}", number, report.surface_names[static_cast<std::size_t>(number - 1)]));
  return fmt::format("{}: flat facets (interpolation: linear) are unusable for ", fmt::join(names, ", "));
}

std::string facets_note(const Report& report) {
  const std::string facets = flat_facets(report);
  if (facets.empty() || report.results.empty() || !report.results.front().wavefront) return {};
  return facets + "wavefronts, wrong by about a wave: take c1";
}

}  // namespace sagitta::output
