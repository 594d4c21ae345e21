// SPDX-License-Identifier: Apache-2.0
// The plots and the page of a study of one system.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <thread>

#include "tools/markdown.h"
#include "tools/study_system.h"
#include "tools/study_table.h"
#include "tools/version.h"

namespace sagitta::tools {
namespace {

using output::significant;
using study::CloudChange;
using study::Curve;
using study::Quantity;
using study::Step;

const char* file_of(Quantity quantity) { return quantity == Quantity::spot_rms ? "spot" : quantity == Quantity::wavefront_rms ? "wavefront" : "zernike"; }

std::string error_name(Quantity quantity) {
  return quantity == Quantity::zernike ? "error of the worst Zernike coefficient" : fmt::format("error of the {}", study::name_of(quantity));
}

const char* unit_of(const study::Worst& worst, Quantity quantity) { return std::isnan(worst.percent) ? study::unit_of(quantity) : "%"; }

// A law is worth drawing where the errors follow one, and fall.
bool has_order(const Curve& curve) { return curve.order.pairs > 3 && curve.order.standard_error < .25 && curve.order.slope < -.3; }

std::string series_name(const Curve& curve) {
  return curve.pattern.empty() ? "square grid" : curve.pattern;
}

output::ChartSeries series_of(const Curve& curve, bool is_over_time) {
  output::ChartSeries series{series_name(curve), {}, true, {}};
  double low = INFINITY, high = 0;
  for (const Step& step : curve.steps) {
    const double error = step.error.main();
    if (error == 0) continue;  // the truth itself
    series.points.push_back({is_over_time ? step.run->processor_s.median : step.count, error});
    low = std::min(low, step.count);
    high = std::max(high, step.count);
  }
  if (!is_over_time && has_order(curve)) series.fit = output::PowerLaw{curve.order.factor, curve.order.slope, low, high, fmt::format("order {:.2f}", -curve.order.slope)};
  return series;
}

std::string title_of(const SystemStudy& system, const std::string& what) { return fmt::format("{}: {}", output::printable(system.model.name, 100), what); }

std::string machine_note() { return fmt::format("{}; sagitta {}", processor_name(), version()); }

// One quantity's curves, over rays or over time.
SystemPlot plot_of(const SystemStudy& system, Quantity quantity, bool is_over_time) {
  SystemPlot plot;
  const char* count = quantity == Quantity::spot_rms ? "rays" : "samples";
  plot.file = fmt::format("{}-{}", file_of(quantity), is_over_time ? "time" : count);
  plot.chart.title = title_of(system, fmt::format("{} against {}", error_name(quantity), is_over_time ? "time" : count));
  plot.chart.x_label = is_over_time ? "processor time, all fields and wavelengths (s)" : fmt::format("{} per field and wavelength", count);
  bool has_fit = false;
  for (const Curve& curve : system.curves) {
    if (curve.quantity != quantity) continue;
    if (plot.chart.series.empty()) {
      const study::Worst& off = curve.uncertainty;
      plot.chart.y_label = fmt::format("{}, worst field and wavelength ({})", error_name(quantity), unit_of(off, quantity));
      if (off.main() > 0 && std::isfinite(off.main())) plot.chart.references.push_back({false, off.main(), "the truth itself may be off by this"});
    }
    plot.chart.series.push_back(series_of(curve, is_over_time));
    has_fit = has_fit || plot.chart.series.back().fit;
  }
  const auto finest = std::find_if(system.curves.begin(), system.curves.end(), [&](const Curve& curve) { return curve.quantity == quantity; })->steps.back().run;
  plot.chart.footer = fmt::format("truth: {}{}, by the same code; {}{}", study::text_of(*finest), finest->pattern.empty() ? " samples" : " rays, " + finest->pattern,
                                  has_fit ? fmt::format("dashed: fitted orders in 1/{}; ", count) : "", machine_note());
  return plot;
}

std::string cloud_name(const study::CloudRun& run) { return run.surface.empty() ? fmt::format("surface {}", run.surface_number) : run.surface; }

std::string interpolation_name(const study::CloudRun& run) { return run.interpolation + (run.is_given ? ", as given" : ""); }

SystemPlot plot_of_clouds(const SystemStudy& system, Quantity quantity) {
  SystemPlot plot;
  plot.file = fmt::format("{}-interpolation", file_of(quantity));
  const std::string what = quantity == Quantity::zernike ? "change of the worst Zernike coefficient" : fmt::format("change of the {}", study::name_of(quantity));
  plot.chart.title = title_of(system, fmt::format("{} by interpolation", what));
  plot.chart.x_label = "processor time of a ray through the system (ns)";
  std::set<int> clouds;
  for (const CloudChange& change : system.changes) clouds.insert(change.run->surface_number);
  for (const CloudChange& change : system.changes) {
    const study::Worst& worst = change.change[static_cast<std::size_t>(quantity)];
    if (!(worst.main() > 0)) continue;
    plot.chart.y_label = fmt::format("{} from {}, worst field and wavelength ({})", what, change.finest->interpolation, unit_of(worst, quantity));
    plot.chart.series.push_back({clouds.size() > 1 ? fmt::format("{} at {}", interpolation_name(*change.run), cloud_name(*change.run)) : interpolation_name(*change.run),
                                 {{change.run->ns_per_ray(), worst.main()}}, false, {}});
  }
  if (clouds.size() == 1) plot.chart.references.push_back({true, system.changes.front().run->ns_per_ray(), system.changes.front().run->interpolation + ", the reference"});
  plot.chart.footer = fmt::format("all by the most rays; {}", machine_note());
  return plot;
}

// The tightest tolerance is the truth: no point.
SystemPlot plot_of_tolerances(const SystemStudy& system, Quantity quantity) {
  SystemPlot plot;
  plot.file = fmt::format("{}-steps", file_of(quantity));
  plot.chart.title = title_of(system, fmt::format("{} against the steps in gradients", error_name(quantity)));
  plot.chart.x_label = "steps of a ray through all the gradients, mean";
  output::ChartSeries series{"by tolerance", {}, true, {}};
  for (const study::ToleranceChange& change : system.tolerances) {
    const study::Worst& worst = change.change[static_cast<std::size_t>(quantity)];
    if (!(worst.main() > 0)) continue;
    plot.chart.y_label = fmt::format("{}, worst field and wavelength ({})", error_name(quantity), unit_of(worst, quantity));
    series.points.push_back({change.run->steps, worst.main()});
    if (change.run->is_given) plot.chart.references.push_back({true, change.run->steps, fmt::format("tolerance_mm {:g}, as given", change.run->tolerance_mm)});
  }
  if (series.points.size() > 1) plot.chart.series.push_back(std::move(series));
  if (!system.tolerances.empty()) plot.chart.footer = fmt::format("truth: tolerance_mm {:g}, by the same code; {}", system.tolerances.front().run->tolerance_mm, machine_note());
  return plot;
}

std::string count_name(Quantity quantity) { return quantity == Quantity::spot_rms ? "rays" : "samples"; }

std::string cell_of(double error) { return error == 0 ? "truth" : std::isfinite(error) ? significant(error, 2) : "-"; }

// A table of one quantity: columns of percents and of the unit only where there are any.
std::string section_of(const SystemStudy& system, Quantity quantity) {
  std::string text, orders;
  bool has_percent = false, has_absolute = false;
  for (const Curve& curve : system.curves) {
    if (curve.quantity != quantity) continue;
    const bool is_first = text.empty();
    if (is_first) {
      has_percent = !std::isnan(curve.uncertainty.percent);
      has_absolute = !std::isnan(curve.uncertainty.absolute);
      const std::string unit = study::unit_of(quantity);
      std::vector<std::string> names{quantity == Quantity::spot_rms ? "pattern" : "grid", count_name(quantity)};
      if (has_percent) names.insert(names.end(), {"error %", "claim %"});
      if (has_absolute) names.insert(names.end(), {"error " + unit, "claim " + unit});
      names.insert(names.end(), {"processor time", "clock"});
      const std::string title = study::name_of(quantity);
      text = fmt::format("\n## {}\n\n{}", static_cast<char>(std::toupper(title[0])) + title.substr(1), head_of(names));
    }
    for (const Step& step : curve.steps) {
      std::vector<std::string> cells{curve.pattern.empty() ? study::text_of(*step.run) : curve.pattern, fmt::format("{:.0f}", step.count)};
      if (has_percent) cells.insert(cells.end(), {cell_of(step.error.percent), cell_of(step.bound.percent)});
      if (has_absolute) cells.insert(cells.end(), {cell_of(step.error.absolute), cell_of(step.bound.absolute)});
      cells.insert(cells.end(), {study::text_of_seconds(step.run->processor_s.median), study::text_of_seconds(step.run->wall_s.median)});
      text += line_of(cells);
    }
    if (has_order(curve)) orders += fmt::format("{}{} {:.2f} ± {:.2f}", orders.empty() ? "" : ", ", series_name(curve), -curve.order.slope, curve.order.standard_error);
  }
  if (!orders.empty()) text += fmt::format("\nFitted order in 1/{}: {}.\n", count_name(quantity), orders);
  return text;
}

std::string clouds_section(const SystemStudy& system) {
  if (system.changes.empty()) return {};
  std::vector<std::string> names{"surface", "interpolation"};
  for (const Quantity quantity : study::quantities) names.push_back(fmt::format("change of {}", quantity == Quantity::zernike ? "the worst coefficient" : study::name_of(quantity)));
  names.insert(names.end(), {"preparation", "ns a ray"});
  std::string text = fmt::format("\n## Interpolation of the points\n\nEach surface of points in every interpolation, the others as given, by the most rays. Changes are from {}, the worst of fields and "
                                 "wavelengths. Where two smooth interpolations differ, the points do not tell which is right.\n\n{}", system.changes.front().run->interpolation, head_of(names));
  for (const CloudChange& change : system.changes) {
    const study::CloudRun& run = *change.run;
    std::vector<std::string> cells{plain(cloud_name(run)), interpolation_name(run)};
    if (!run.reason.empty()) {
      cells.push_back(plain(run.reason));
    } else {
      for (const Quantity quantity : study::quantities) {
        const study::Worst& worst = change.change[static_cast<std::size_t>(quantity)];
        cells.push_back(std::isnan(worst.main()) ? "-" : study::text_of(worst, quantity));
      }
      cells.insert(cells.end(), {study::text_of_seconds(run.prepare_s), significant(run.ns_per_ray(), 3)});
    }
    cells.resize(names.size());
    text += line_of(cells);
  }
  return text;
}

std::string tolerances_section(const SystemStudy& system) {
  if (system.tolerances.empty()) return {};
  std::vector<std::string> names{"tolerance_mm", "steps of a ray"};
  for (const Quantity quantity : study::quantities) names.push_back(fmt::format("change of {}", quantity == Quantity::zernike ? "the worst coefficient" : study::name_of(quantity)));
  names.push_back("ns a ray");
  const study::ToleranceRun& truth = *system.tolerances.front().run;
  std::string text = fmt::format("\n## Steps in gradients\n\nThe same {} rays and {} samples by every tolerance; changes are from tolerance_mm {:g}, the worst of fields and wavelengths.\n\n{}", study::text_of(truth.spots),
                                 study::text_of(truth.wavefronts), truth.tolerance_mm, head_of(names));
  for (const study::ToleranceChange& change : system.tolerances) {
    std::vector<std::string> cells{fmt::format("{:g}{}", change.run->tolerance_mm, change.run->is_given ? ", as given" : ""), significant(change.run->steps, 3)};
    for (const Quantity quantity : study::quantities) {
      const study::Worst& worst = change.change[static_cast<std::size_t>(quantity)];
      cells.push_back(std::isnan(worst.main()) ? "-" : study::text_of(worst, quantity));
    }
    cells.push_back(significant(study::ns_per_ray(change.run->spots), 3));
    text += line_of(cells);
  }
  return text;
}

std::string answers_section(const SystemStudy& system) {
  std::string text = "\n## The answers\n\nOf the finest, with what they may be off by.\n\n" + head_of({"field", "wavelength nm", "spot RMS µm", "±", "wavefront RMS waves", "±"});
  const auto first_of = [&](Quantity quantity) { return std::find_if(system.curves.begin(), system.curves.end(), [&](const Curve& curve) { return curve.quantity == quantity; }); };
  const auto spot = first_of(Quantity::spot_rms), wavefront = first_of(Quantity::wavefront_rms);
  const std::vector<study::Answers>& all = system.sampling.spots.front().back().answers;
  for (std::size_t k = 0; k < all.size(); ++k) {
    const auto& field = system.model.fields.points[all[k].field];
    std::vector<std::string> cells{fmt::format("{}: {:g}, {:g} {}", all[k].field, field.x, field.y, system.model.fields.kind == prescription::FieldKind::angles_deg ? "deg" : "mm"),
                                   fmt::format("{:g}", system.sampling.wavelengths_um[all[k].wavelength] * 1e3)};
    for (const auto& curve : {spot, wavefront}) {
      const bool is_there = curve != system.curves.end() && !curve->truths[k].value.empty();
      cells.push_back(is_there ? significant(curve->truths[k].value.front(), 5) : "-");
      cells.push_back(is_there ? significant(curve->truths[k].uncertainty, 2) : "-");
    }
    text += line_of(cells);
  }
  return text;
}

}  // namespace

std::string fields_of(const prescription::Model& model) {
  const std::size_t fields = model.fields.points.size(), wavelengths = model.wavelengths_nm.size();
  return fmt::format("{} field{}, {} wavelength{}", fields, fields == 1 ? "" : "s", wavelengths, wavelengths == 1 ? "" : "s");
}

std::vector<SystemPlot> system_plots(const SystemStudy& system) {
  std::vector<SystemPlot> plots;
  for (const Quantity quantity : study::quantities) {
    if (std::none_of(system.curves.begin(), system.curves.end(), [&](const Curve& curve) { return curve.quantity == quantity; })) continue;
    for (const bool is_over_time : {false, true}) plots.push_back(plot_of(system, quantity, is_over_time));
    for (SystemPlot& plot : std::vector{plot_of_clouds(system, quantity), plot_of_tolerances(system, quantity)})
      if (!plot.chart.series.empty()) plots.push_back(std::move(plot));
  }
  return plots;
}

std::string system_page(const SystemStudy& system, const std::vector<SystemPlot>& plots) {
  std::string text = fmt::format("# {}: error against run time\n\nSystem: {}, {}, {} surfaces.\nMachine: {}, {} threads; sagitta {}, {}.\n\n## Advice\n\n", plain(system.model.name),
                                 plain(system.model.file), fields_of(system.model), system.model.surfaces.size(), plain(processor_name()),
                                 std::thread::hardware_concurrency(), version(), build());
  for (const std::string& line : system.advice) text += fmt::format("- {}\n", plain(line));
  if (!system.truth_note.empty())
    text += fmt::format("\n{}\n\nErrors are those of the worst field and wavelength, in percent of its answer, or in the answer's unit where it is next to nothing: a spot below a hundredth of the wavelength, a "
                        "wavefront below a thousandth of a wave. Of a Zernike coefficient the error is in µm. A claim is the largest error of the counts measured from there on, with those between this and the next "
                        "row and, of random rays, other seeds; the largest rise of the error from one of them to the next, for what lies between; and what the truth may be off by. It is no bound: of counts "
                        "that were not measured a few break it. Times are processor "
                        "time, all fields, wavelengths and threads together, medians where runs are short: launching, tracing, collecting, of wavefronts the Zernike fit too. Starting, reading, drawing and "
                        "writing files come on top, whatever the number of rays. `study.csv` has every field and wavelength, with the spread of the times.\n", plain(system.truth_note));
  if (!system.curves.empty()) text += answers_section(system);
  for (const Quantity quantity : study::quantities) text += section_of(system, quantity);
  text += clouds_section(system);
  text += tolerances_section(system);
  if (!plots.empty()) text += "\n## Plots\n";
  for (const SystemPlot& plot : plots) text += fmt::format("\n![{}]({}.svg)\n", plain(plot.chart.title), plot.file);
  return text;
}

}  // namespace sagitta::tools
