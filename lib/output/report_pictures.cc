// SPDX-License-Identifier: Apache-2.0
// The results as EXR parts and as figures.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "lib/output/report.h"

namespace sagitta::output {
namespace {

std::string part_name(const Report& report, const analysis::JobResult& result, const char* quantity) {
  return fmt::format("{}.field{}.{}nm", quantity, result.field, report.wavelengths_nm[result.wavelength]);
}

std::string field_label(const Report& report, std::size_t field) {
  const auto& [x, y] = report.fields[field];
  return report.fields_are_heights ? fmt::format("object ({:g}, {:g}) mm", x, y) : fmt::format("field ({:g}°, {:g}°)", x, y);
}

std::string panel_title(const Report& report, const analysis::JobResult& result) {
  return fmt::format("{}, {:g} nm", field_label(report, result.field), report.wavelengths_nm[result.wavelength]);
}

std::vector<ExrAttribute> common_attributes(const Report& report, const analysis::JobResult& result,
                                            const trace::StatusCounts& rays) {
  const auto& [x, y] = report.fields[result.field];
  return {{"system", report.system},
          {"software", "sagitta " + report.version},
          {"field", static_cast<int>(result.field)},
          {report.fields_are_heights ? "object_height_mm" : "angle_deg", std::array{static_cast<float>(x), static_cast<float>(y)}},
          {"wavelength_nm", report.wavelengths_nm[result.wavelength]},
          {"rays_launched", static_cast<double>(rays.total())},
          {"rays_ok", static_cast<double>(rays[surface::Status::ok])}};
}

template <class Value>
std::vector<float> floats(const std::vector<Value>& values) {
  return std::vector<float>(values.begin(), values.end());
}

}  // namespace

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
    const double semi_diameter = report.first_order.entrance_pupil.semi_diameter;
    const auto pixel = static_cast<float>(semi_diameter / (wavefront.size / 2 - 1));
    ExrPart part{part_name(report, result, "wavefront"), wavefront.size, wavefront.size,
                 {{"Y", floats(wavefront.opd_waves)}, {"wavefront.mask", wavefront.mask}}, common_attributes(report, result, result.wavefront->rays)};
    part.attributes.push_back({"quantity", "optical path difference over the entrance pupil"});
    part.attributes.push_back({"units.Y", "waves"});
    part.attributes.push_back({"sign", "OPD = OPL(chief ray) - OPL(ray), both to the reference sphere"});
    part.attributes.push_back({"mask", "0 ok, 1 missed, 2 clipped, 3 total_reflection, 4 outside_data, 5 not_converged, 255 outside the pupil"});
    if (std::isfinite(semi_diameter)) {  // a telecentric beam has no pupil of finite size
      part.attributes.push_back({"pixel_size_mm", std::array{pixel, pixel}});
      part.attributes.push_back({"centre_mm", std::array{-pixel / 2, -pixel / 2}});  // the chief ray's sample is column N/2
      part.attributes.push_back({"pupil_semi_diameter_mm", semi_diameter});
    }
    part.attributes.push_back({"grid", fmt::format("column i and row N-1-j stand at (i - N/2, j - N/2)/(N/2 - 1) of the unit pupil, N = {}; x right, y up", wavefront.size)});
    part.attributes.push_back({"reference_sphere_radius_mm", wavefront.reference_radius});
    part.attributes.push_back({"rms_waves", wavefront.rms_waves});
    part.attributes.push_back({"peak_to_valley_waves", wavefront.peak_to_valley_waves});
    parts.push_back(std::move(part));
  }
  return parts;
}

Figure spot_figure(const Report& report) {
  Figure figure{"Spots: " + report.system, "circle: RMS radius about the centroid; sagitta " + report.version, {}, static_cast<int>(std::min<std::size_t>(3, report.wavelengths_nm.size()))};
  if (report.wavelengths_nm.size() == 1) figure.columns = static_cast<int>(std::min<std::size_t>(3, report.fields.size()));
  for (const auto& result : report.results) {
    const analysis::SpotImage& image = *result.spot_image;
    const analysis::Spot& spot = *result.spot;
    Panel panel;
    panel.title = panel_title(report, result);
    panel.subtitle = {fmt::format("RMS {:.4g} µm, geometric {:.4g} µm", 1e3 * spot.rms_radius, 1e3 * spot.geometric_radius),
                      fmt::format("{} of {} rays", result.rays[surface::Status::ok], result.rays.total())};
    panel.map = {image.size, image.size, floats(image.counts)};
    panel.axes = {image.pixel_mm, image.pixel_mm, image.centre_x, image.centre_y};
    panel.zero_is_background = true;
    panel.log_scale = true;
    panel.quantity = "rays per pixel";
    panel.empty_note = "no ray arrived";
    if (spot.rms_radius > 0) panel.circles = {{spot.centroid_x, spot.centroid_y, spot.rms_radius, ""}};
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

Figure wavefront_figure(const Report& report) {
  Figure figure{"Wavefronts, OPD = OPL(chief) − OPL(ray): " + report.system, "sagitta " + report.version, {}, 3};
  figure.columns = static_cast<int>(std::min<std::size_t>(3, report.wavelengths_nm.size() == 1 ? report.fields.size() : report.wavelengths_nm.size()));
  const bool has_size = std::isfinite(report.first_order.entrance_pupil.semi_diameter);
  const double pupil = has_size ? report.first_order.entrance_pupil.semi_diameter : 1;  // telecentric: the unit disc
  for (const auto& result : report.results) {
    Panel panel;
    panel.axes.unit_mm = has_size;
    panel.title = panel_title(report, result);
    panel.color_map = ColorMap::diverging;
    panel.quantity = "OPD";
    panel.unit = "waves";
    panel.axes.x_label = "pupil x";
    panel.axes.y_label = "pupil y";
    if (result.wavefront->wavefront) {
      const analysis::Wavefront& wavefront = *result.wavefront->wavefront;
      panel.subtitle = {fmt::format("RMS {:.4g}, P-V {:.4g} waves", wavefront.rms_waves, wavefront.peak_to_valley_waves)};
      panel.map = {wavefront.size, wavefront.size, floats(wavefront.opd_waves)};
      const double pixel = pupil / (wavefront.size / 2 - 1);
      // the chief ray's sample is column N/2, so the middle of the map lies half a pixel before it (above it in y)
      panel.axes.pixel_width = panel.axes.pixel_height = pixel;
      panel.axes.center_x = -pixel / 2;
      panel.axes.center_y = -pixel / 2;
    } else {
      panel.map = {2, 2, std::vector<float>(4, std::numeric_limits<float>::quiet_NaN())};
      panel.axes.pixel_width = panel.axes.pixel_height = pupil;
      panel.empty_note = result.wavefront->reason;
    }
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

}  // namespace sagitta::output
