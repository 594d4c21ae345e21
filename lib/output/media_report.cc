// SPDX-License-Identifier: Apache-2.0
#include "lib/output/media_report.h"

#include <fmt/format.h>

#include <cmath>

#include "lib/output/summary_internal.h"
#include "lib/output/table.h"
#include "lib/output/text.h"

namespace sagitta::output {
namespace {

using nlohmann::ordered_json;

constexpr int index_decimals = 7;  // in which makers of glass compare

std::string fixed(double value, int decimals) { return std::isnan(value) ? "-" : fmt::format("{:.{}f}", value, decimals); }

// 0.31 um times 1000 need not be 310.
std::string nanometres(double nm) { return fmt::format("{:.9g}", nm); }

// "Optical glass N-BK7" of "Optical glass N-BK7. Melted in Mainz."
std::string first_sentence(const std::string& text) {
  for (std::size_t i = 0; i + 1 < text.size(); ++i)
    if ((text[i] == '.' || text[i] == ';' || text[i] == ':') && text[i + 1] == ' ') return text.substr(0, i);
  return text;
}

std::string range_of(const MediumReport& medium) {
  return medium.has_range ? fmt::format("{} to {}", nanometres(medium.shortest_nm), nanometres(medium.longest_nm)) : "any";
}

ordered_json json_of(const MediumReport& medium) {
  return {{"name", medium.name}, {"from", medium.from}, {"file", medium.file}, {"kind", medium.kind}, {"comments", medium.comments}, {"references", medium.references},
          {"range_nm", medium.has_range ? ordered_json{medium.shortest_nm, medium.longest_nm} : ordered_json()},
          {"nd", medium.nd}, {"vd", medium.vd}, {"ne", medium.ne}, {"ve", medium.ve}};
}

std::string json_text(const std::vector<MediumReport>& media, const std::string& version, bool has_values) {
  ordered_json json{{"version", version}, {"materials", ordered_json::array()}};
  for (const MediumReport& medium : media) {
    json["materials"].push_back(json_of(medium));
    if (!has_values) continue;
    ordered_json& values = json["materials"].back()["values"] = ordered_json::array();
    for (const MediumValue& value : medium.values)
      values.push_back({{"line", value.line.empty() ? ordered_json() : ordered_json(value.line)}, {"wavelength_nm", value.wavelength_nm}, {"index", value.index},
                        {"slope_per_um", value.slope_per_um}, {"group_index", value.group_index}});
  }
  return text_of(json);
}

std::string text_of_one(const MediumReport& medium) {
  constexpr std::size_t most = 1000;
  std::string text = printable(medium.name, most) + (medium.comments.empty() ? "" : ": " + printable(medium.comments, most)) + "\n";
  if (!medium.references.empty()) text += "source  " + printable(medium.references, most) + "\n";
  if (!medium.file.empty()) text += "file    " + printable(medium.file, most) + "\n";
  text += fmt::format("kind    {}, {} nm\nnd {}, Vd {}; ne {}, Ve {}\n\n", printable(medium.kind, most), range_of(medium), fixed(medium.nd, index_decimals), fixed(medium.vd, 2),
                      fixed(medium.ne, index_decimals), fixed(medium.ve, 2));
  Table table{{{"line", "", true}, {"wavelength", "nm"}, {"index", ""}, {"dn/dL", "1/um"}, {"group index", ""}}, {}};
  for (const MediumValue& value : medium.values)
    table.rows.push_back({value.line, nanometres(value.wavelength_nm), fixed(value.index, index_decimals), fixed(value.slope_per_um, 6), fixed(value.group_index, 6)});
  return text + to_text(table);
}

}  // namespace

std::string media_list_text(const std::vector<MediumReport>& media) {
  constexpr std::size_t most = 60;
  Table table{{{"name", "", true}, {"nd", ""}, {"Vd", ""}, {"range", "nm"}, {"from", "", true}, {"kind", "", true}, {"what", "", true}}, {}};
  for (const MediumReport& medium : media)
    table.rows.push_back({printable(medium.name, most), fixed(medium.nd, 5), fixed(medium.vd, 2), range_of(medium), printable(medium.from, most), medium.kind, printable(first_sentence(medium.comments), most)});
  return to_text(table);
}

std::string media_list_json(const std::vector<MediumReport>& media, const std::string& version) { return json_text(media, version, false); }

std::string media_text(const std::vector<MediumReport>& media) {
  std::string text;
  for (const MediumReport& medium : media) text += (text.empty() ? "" : "\n") + text_of_one(medium);
  return text;
}

std::string media_json(const std::vector<MediumReport>& media, const std::string& version) { return json_text(media, version, true); }

Chart media_chart(const std::vector<MediumReport>& media, const std::vector<std::vector<ChartPoint>>& curves, const std::string& version) {
  Chart chart;
  chart.title = media.size() == 1 ? "Refractive index of " + media.front().name : fmt::format("Refractive indices of {} media", media.size());
  chart.x_label = "wavelength (nm)";
  chart.y_label = "refractive index";
  chart.x_scale = chart.y_scale = AxisScale::linear;
  bool any_is_asked_for = false, any_is_measured = false;
  for (std::size_t i = 0; i < media.size(); ++i) {
    ChartSeries series{media[i].name, {}, true, {}, curves[i]};
    for (const MediumValue& value : media[i].values)
      if (value.line.empty()) series.points.push_back({value.wavelength_nm, value.index});
    any_is_asked_for = any_is_asked_for || !series.points.empty();
    if (series.points.empty() && media[i].is_table) {
      series.points = curves[i];
      any_is_measured = true;
    }
    if (series.points.empty())  // a few along the curve, by which to tell it from others
      for (std::size_t k = 1; k < 12; k += 2) series.points.push_back(curves[i][k * (curves[i].size() - 1) / 12]);
    chart.series.push_back(std::move(series));
  }
  chart.footer = fmt::format("{}sagitta {}", any_is_asked_for ? "markers: the wavelengths asked for; " : any_is_measured ? "markers of tables: the measured wavelengths; " : "", version);
  return chart;
}

}  // namespace sagitta::output
