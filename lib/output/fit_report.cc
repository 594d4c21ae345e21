// SPDX-License-Identifier: Apache-2.0
#include "lib/output/fit_report.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "lib/output/table.h"
#include "lib/output/text.h"

namespace sagitta::output {
namespace {

using nlohmann::ordered_json;
using scene::ZernikeSurface;

constexpr const char* frame = "the surface's local frame: x to the examiner's left, y up, z into the eye";

std::string_view indexing_name(numerics::ZernikeIndexing indexing) {
  switch (indexing) {
    case numerics::ZernikeIndexing::osa: return "osa";
    case numerics::ZernikeIndexing::noll: return "noll";
    case numerics::ZernikeIndexing::fringe: return "fringe";
  }
  return {};
}

// "36 osa terms"
std::string terms_of(const ZernikeSurface& surface) {
  const std::size_t terms = surface.coefficients_um.size();
  return fmt::format("{} {} {}", terms, indexing_name(surface.indexing), terms == 1 ? "term" : "terms");
}

// As the reader takes it back.
std::string yaml_number(double value) { return std::isinf(value) ? (value > 0 ? ".inf" : "-.inf") : fmt::format("{:.17g}", value); }

// -0 is 0.
std::string six_places(double value) { return fmt::format("{:.6f}", std::round(value * 1e6) / 1e6 + 0.0); }

std::string coverage_of(const FitReport& report, const char* before, const char* after) {
  return report.map ? fmt::format("{}{:.1f} % of the circle inside them{}", before, 100 * report.map->coverage, after) : "";
}

std::string name_of(const std::string& file) { return printable(file.substr(file.rfind('/') + 1), 60); }

}  // namespace

std::string fit_text(const FitReport& report) {
  const ZernikeSurface& fit = report.surface;
  const auto length = [](double mm) { return significant(mm, 7); };
  const auto micrometres = [](double um) { return significant(um, 4); };
  Table fits{{{"fit", "", true}, {"radius", "mm"}, {"conic constant", ""}, {"vertex z", "mm"}, {"RMS", "um"}}, {}};
  fits.rows = {{"sphere, vertex free along z", length(fit.sphere_radius_mm), "", six_places(fit.sphere_vertex_mm), micrometres(fit.sphere_rms_um)},
               {"conic, vertex free along z", length(fit.radius_mm), significant(fit.conic_constant, 5), six_places(fit.vertex_mm), micrometres(fit.conic_rms_um)},
               {"that conic with " + terms_of(fit), "", "", "", micrometres(fit.rms_um)}};
  Table terms{{{"index", ""}, {"n", ""}, {"m", ""}, {"coefficient", "um"}}, {}};
  int index = numerics::first_zernike_index(fit.indexing);
  for (const double um : fit.coefficients_um) {
    const numerics::ZernikeTerm term = numerics::zernike_term(fit.indexing, index);
    terms.rows.push_back({std::to_string(index++), std::to_string(term.n), std::to_string(term.m), six_places(um)});
  }
  return fmt::format("{}: {} points within {:g} mm{}\nin {}\n\n{}{}\n"
                     "peak to valley {} um, condition number {:.4g}, normalisation radius {:g} mm\n\n{}",
                     printable(report.file, 200), fit.point_count, fit.normalization_radius_mm, coverage_of(report, ", ", ""), frame, to_text(fits),
                     fit.conic_is_sphere ? "the points tell no conic constant from -100 to 100: the conic is the sphere\n" : "",
                     micrometres(fit.peak_to_valley_um), fit.condition_number, fit.normalization_radius_mm, to_text(terms));
}

std::string fit_json(const FitReport& report) {
  const ZernikeSurface& fit = report.surface;
  const ordered_json json{
      {"points", report.file},
      {"version", report.version},
      {"frame", frame},
      {"points_used", fit.point_count},
      {"coverage", report.map ? ordered_json(report.map->coverage) : ordered_json()},
      {"condition_number", fit.condition_number},
      {"sphere", {{"radius_mm", fit.sphere_radius_mm}, {"vertex_z_mm", fit.sphere_vertex_mm}, {"rms_um", fit.sphere_rms_um}}},
      {"conic", {{"radius_mm", fit.radius_mm}, {"conic_constant", fit.conic_constant}, {"is_sphere", fit.conic_is_sphere},
                 {"vertex_z_mm", fit.vertex_mm}, {"rms_um", fit.conic_rms_um}}},
      {"zernike", {{"radius_mm", fit.radius_mm}, {"conic_constant", fit.conic_constant}, {"normalization_radius_mm", fit.normalization_radius_mm},
                   {"indexing", indexing_name(fit.indexing)}, {"coefficients_um", fit.coefficients_um}, {"rms_um", fit.rms_um},
                   {"peak_to_valley_um", fit.peak_to_valley_um}}}};
  return json.dump(1, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

std::string fit_shape(const FitReport& report) {
  const ZernikeSurface& fit = report.surface;
  constexpr std::size_t longest_line = 110;
  // Deeper than any key that the shape may stand at.
  const std::string indent(10, ' ');
  std::string text = fmt::format("zernike: {{radius_mm: {}, conic_constant: {},\n{}normalization_radius_mm: {}, indexing: {},\n",
                                 yaml_number(fit.radius_mm), yaml_number(fit.conic_constant), indent,
                                 yaml_number(fit.normalization_radius_mm), indexing_name(fit.indexing));
  std::string line = indent + "coefficients_um: [";
  for (std::size_t i = 0; i < fit.coefficients_um.size(); ++i) {
    const std::string item = yaml_number(fit.coefficients_um[i]) + (i + 1 < fit.coefficients_um.size() ? ", " : "]}\n");
    if (line.size() + item.size() > longest_line) {
      line.pop_back();  // the blank behind a comma
      text += line + "\n";
      line = indent + "  ";
    }
    line += item;
  }
  return text + line;
}

std::string fit_fragment(const FitReport& report) {
  const ZernikeSurface& fit = report.surface;
  return fmt::format("# A surface's shape: the best-fit {} of {} with {}, by sagitta {} (sagitta fit).\n"
                     "# {} points within {:g} mm; they differ from it by {:.4g} um RMS, {:.4g} um peak to valley; condition number {:.4g};\n"
                     "# {}In {}.\n{}",
                     fit.conic_is_sphere ? "sphere" : "conic", printable(report.file, 200), terms_of(fit), report.version, fit.point_count, fit.normalization_radius_mm, fit.rms_um,
                     fit.peak_to_valley_um, fit.condition_number, coverage_of(report, "", ". "), frame, fit_shape(report));
}

ExrPart residual_part(const FitReport& report) {
  const ZernikeSurface& fit = report.surface;
  const auto pixel = static_cast<float>(report.map->pixel_mm);
  return {"residual", report.map->size, report.map->size, {{"Y", report.map->residual_um}},
          {{"points", printable(report.file, 1000)},
           {"software", "sagitta " + report.version},
           {"quantity", "residual of the Zernike surface"},
           {"units.Y", "um"},
           {"sign", "measured z - fitted z"},
           {"interpolation", "linear over the Delaunay triangulation of the points; NaN outside them"},
           {"pixel_size_mm", std::array{pixel, pixel}},
           {"centre_mm", std::array{0.0F, 0.0F}},
           {"frame", fmt::format("{}; x right, row 0 is the largest y", frame)},
           {"normalization_radius_mm", fit.normalization_radius_mm},
           {"terms", terms_of(fit)},
           {"points_used", static_cast<double>(fit.point_count)},
           {"coverage", report.map->coverage},
           {"rms_um", fit.rms_um},
           {"peak_to_valley_um", fit.peak_to_valley_um},
           {"condition_number", fit.condition_number}}};
}

Figure residual_figure(const FitReport& report) {
  const ZernikeSurface& fit = report.surface;
  Panel panel;
  panel.title = fmt::format("{}: RMS {} µm", terms_of(fit), significant(fit.rms_um, 4));
  panel.subtitle = {fmt::format("peak to valley {} µm, {} points within {:g} mm", significant(fit.peak_to_valley_um, 4), fit.point_count, fit.normalization_radius_mm)};
  panel.map = {report.map->size, report.map->size, report.map->residual_um};
  panel.axes.pixel_width = panel.axes.pixel_height = report.map->pixel_mm;
  panel.color_map = ColorMap::diverging;
  panel.quantity = "measured − fitted z";
  panel.unit = "µm";
  return {"Residual of the Zernike surface: " + name_of(report.file),
          "x to the examiner's left, z into the eye; linear between the points, grey where there are none; sagitta " + report.version, {panel}, 1};
}

}  // namespace sagitta::output
