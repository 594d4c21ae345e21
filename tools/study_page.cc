// SPDX-License-Identifier: Apache-2.0
#include "tools/study_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>
#include <thread>

#include "lib/prescription/study_keys.h"
#include "tools/markdown.h"
#include "tools/version.h"

namespace sagitta::tools {
namespace {

using output::significant;

// Somebody's text of several lines: each is a paragraph.
std::string paragraphs(const std::string& text) {
  std::string result;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    if (!line.empty()) result += plain(line) + "\n\n";
  return result;
}

struct PageColumn {
  const char* column;
  const char* name;
  bool is_whole = false;
};
constexpr PageColumn page_columns[] = {{"points", "points", true}, {"rays", "rays", true}, {"distance_mean_um", "distance, mean µm"}, {"distance_rms_um", "rms µm"},
                                       {"angle_mean_arcmin", "angle, mean arcmin"}, {"angle_rms_arcmin", "rms arcmin"}, {"spot_rms_um", "spot RMS µm"},
                                       {"spot_rms_error_percent", "its error %"}, {"wavefront_rms_error_waves", "wavefront RMS error, waves"}, {"wavefront_without_tilt_waves", "without tilt"}, {"only_one_finds", "only one finds", true},
                                       {"looks_per_ray", "looks a ray"}, {"looks_most", "at most", true}, {"prepare_s", "preparation s"}, {"ns_per_ray", "ns a ray"}, {"peak_mib", "peak MiB"}, {"own_mib", "its own MiB"}};

// 0.02581 ± 0.00003: the deviation with two digits, the mean to its last one or with four digits, whichever is less.
std::string with_deviation(const study::Mean& of) {
  if (!(of.deviation > 0)) return significant(of.mean, 4);
  const double decades = std::floor(std::log10(std::abs(of.mean))) - std::floor(std::log10(of.deviation));
  return fmt::format("{} ± {}", significant(of.mean, static_cast<int>(std::clamp(decades + 2, 1.0, 4.0))), significant(of.deviation, 2));
}

std::string rows_table(const std::vector<StudyRow>& rows) {
  const std::vector<Ensemble> ensembles = ensembles_of(rows);
  const bool has_seeds = std::any_of(ensembles.begin(), ensembles.end(), [](const Ensemble& one) { return one.rows.size() > 1; });
  std::vector<PageColumn> shown;  // those that have a value
  for (const PageColumn& column : page_columns)
    if (std::any_of(rows.begin(), rows.end(), [&](const StudyRow& row) { return std::isfinite(row.number(column.column)); })) shown.push_back(column);
  std::vector<std::string> names{"variant"};
  if (has_seeds) names.emplace_back("seeds");
  for (const PageColumn& column : shown) names.emplace_back(column.name);
  std::string text = head_of(names), failures;
  for (const Ensemble& one : ensembles) {
    std::vector<std::string> cells{plain(one.name())};
    if (has_seeds) cells.push_back(fmt::format("{}", one.rows.size()));
    for (const PageColumn& column : shown) {
      const study::Mean mean = one.mean(column.column);
      cells.push_back(column.is_whole && !(mean.deviation > 0) ? one.first().text(column.column) : with_deviation(mean));
    }
    text += line_of(cells);
  }
  for (const StudyRow& row : rows)
    if (row.has_failed()) failures += fmt::format("- {}: {}\n", plain(row.name), plain(row.text("failed")));
  if (!failures.empty()) text += "\nNot measured:\n\n" + failures;
  return text;
}

std::string orders_table(const std::vector<StudyPlot>& plots) {
  std::string text;
  for (const StudyPlot& plot : plots)
    for (const FittedOrder& one : plot.orders)
      text += line_of({plain(one.series), one.quantity, fmt::format("{:.3f}", one.order.slope), std::isnan(one.order.standard_error) ? "-" : fmt::format("{:.3f}", one.order.standard_error),
                       fmt::format("{}", one.order.pairs)});
  if (text.empty()) return text;
  return "\n## Orders\n\nThe error is fitted by a h^order, h = density^(-1/2) the spacing of the points; least squares of the logarithms, with the standard error.\n\n" +
         head_of({"series", "error of", "order", "standard error", "densities"}) + text;
}

std::string settings_of(const prescription::Parameters& where) {
  std::vector<std::string> words;
  const auto add = [&](prescription::KeyTable keys) {
    for (const numerics::Key& key : keys) {
      if (const auto text = where.texts.find(key.name); text != where.texts.end()) words.push_back(text->second);
      if (const auto number = where.numbers.find(key.name); number != where.numbers.end()) words.push_back(fmt::format("{} {:.9g}", key.name, number->second));
    }
  };
  add(prescription::variant_keys);
  add(prescription::roughness_keys);
  return fmt::format("{}", fmt::join(words, ", "));
}

// Ours is the mean over the rows that a figure is of.
std::string paper_table(const prescription::StudyFile& study, const std::vector<StudyRow>& rows) {
  std::string text;
  for (const prescription::PublishedFigure& figure : study.paper)
    for (const auto& [column, printed] : figure.values) {
      std::vector<double> values;
      for (const StudyRow& row : rows)
        if (!row.has_failed() && prescription::has_settings(*row.settings, figure.where)) values.push_back(row.number(column));
      const study::Mean ours = study::mean_of(values);
      const double difference = 100 * (ours.mean / printed - 1);
      text += line_of({plain(settings_of(figure.where)), column, fmt::format("{}", printed), with_deviation(ours), std::isfinite(difference) ? fmt::format("{:+.1f}", difference) : "-",
                       fmt::format("{}", ours.count), plain(figure.note)});
    }
  if (text.empty()) return text;
  return "\n## Reference figures beside ours\n\n" + head_of({"settings", "quantity", "reference", "here", "difference %", "rows", "note"}) + text;
}

// "surface 1 (front), field 0", "surfaces 1 (front), 2 (back), fields 0, 1".
std::string subjects_of(const prescription::StudyFile& study) {
  std::set<int> surfaces;
  std::set<std::size_t> fields;
  for (const prescription::Parameters& variant : study.variants) {
    surfaces.insert(prescription::surface_number_of(study, variant));
    fields.insert(prescription::field_of(variant));
  }
  std::vector<std::string> names;
  for (const int number : surfaces) names.push_back(fmt::format("{} ({})", number, study.system.surfaces[static_cast<std::size_t>(number - 1)].name));
  return fmt::format("surface{} {}, field{} {}", surfaces.size() == 1 ? "" : "s", fmt::join(names, ", "), fields.size() == 1 ? "" : "s", fmt::join(fields, ", "));
}

}  // namespace

std::string study_page(const prescription::StudyFile& study, const std::vector<StudyRow>& rows, const std::vector<StudyPlot>& plots) {
  const auto measured = std::count_if(rows.begin(), rows.end(), [](const StudyRow& row) { return row.is_measured() && !row.has_failed(); });
  std::string text = fmt::format("# {}\n\n", plain(study.title));
  if (!study.about.empty()) text += paragraphs(study.about);
  if (!study.source.empty()) text += "Source: " + plain(study.source) + "\n\n";
  text += fmt::format("System: {}, {}, {:g} nm.\n", plain(study.system.name), plain(subjects_of(study)), study.system.primary_wavelength_nm());
  text += fmt::format("Machine: {}, {} threads; sagitta {}, {}.\n\n", plain(processor_name()), std::thread::hardware_concurrency(), version(), build());
  text += fmt::format("{} of {} variants. Distances and angles are of each ray from the exact one at the surface, spots at the image, over the rays that both find; times are medians of repeated "
                      "runs of processor time, preparation and tracing apart; the peak is that of the variant's own process, of which its own is what it did not begin with: the program and the exact "
                      "rays. Variants that differ in the seed alone stand in one line, each number as the mean ± the standard deviation over the seeds. `study.csv` has all of it in full.\n\n"
                      "Exact rays are traced in 50 digits, those of rough surfaces in 19. Wavefronts have no such truth: both surfaces are traced in double, each to the sphere of its own chief ray; "
                      "of flat facets most of the difference is then the tilt of the one facet that the chief ray meets.\n\n## Rows\n\n",
                      measured, rows.size());
  text += rows_table(rows) + orders_table(plots) + paper_table(study, rows);
  if (!plots.empty()) text += "\n## Plots\n";
  for (const StudyPlot& plot : plots) text += fmt::format("\n![{}]({}.svg)\n", plain(plot.chart.title), plot.file);
  if (!study.notes.empty()) text += "\n## Notes\n\n" + paragraphs(study.notes);
  return text;
}

}  // namespace sagitta::tools
