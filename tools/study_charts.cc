// SPDX-License-Identifier: Apache-2.0
#include "tools/study_charts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "tools/version.h"

namespace sagitta::tools {
namespace {

struct Axis {
  const char* column;
  const char* label;
};
constexpr Axis density{"points_per_mm2", "points per mm²"}, rays{"rays", "rays"}, time{"ns_per_ray", "processor time per ray at the surface (ns)"};
constexpr Axis clock_time{"wall_ns_per_ray", "time per ray at the surface, by the clock (ns)"}, points{"points", "points"}, tolerance{"tolerance", "tolerance (mm)"}, own_memory{"own_mib", "memory, without the program and the exact rays (MiB)"};

struct PlotKind {
  const char* file;
  const char* title;  // after the study's
  Axis x, y;
  const char* fitted = nullptr;  // the quantity, where orders in the spacing are fitted
  const char* where_varies = nullptr;  // drawn only where this column has several values
};
constexpr PlotKind kinds[] = {
    {"error-time-angle", "error of the angle against time", time, {"angle_rms_arcmin", "angle, rms (arcmin)"}},
    {"error-time-distance", "error of the place against time", time, {"distance_rms_um", "distance, rms (µm)"}},
    {"error-density-angle", "error of the angle against density", density, {"angle_rms_arcmin", "angle, rms (arcmin)"}, "angle"},
    {"error-density-distance", "error of the place against density", density, {"distance_rms_um", "distance, rms (µm)"}, "distance"},
    {"spot-density", "error of the spot against density", density, {"spot_rms_error_percent", "error of the spot's RMS radius, absolute (%)"}},
    {"time-density", "time per ray against density", density, time},
    {"prepare-density", "preparation against density", density, {"prepare_s", "preparation (s, all threads)"}},
    {"time-rays", "time per ray against the number of rays", rays, time},
    {"clock-density", "time per ray by the clock against density", density, clock_time, nullptr, "threads"},
    {"clock-rays", "time per ray by the clock against the number of rays", rays, clock_time, nullptr, "threads"},
    {"memory-points", "memory against the number of points", points, own_memory},
    {"memory-rays", "memory against the number of rays", rays, own_memory},
    {"error-tolerance-angle", "largest error of the angle against tolerance", tolerance, {"angle_max_arcmin", "angle, of the worst ray (arcmin)"}},
    {"error-tolerance-distance", "largest error of the place against tolerance", tolerance, {"distance_max_um", "distance, of the worst ray (µm)"}},
    {"looks-tolerance", "looks at the surface against tolerance", tolerance, {"looks_per_ray", "looks per ray, mean"}},
    {"looks-most-tolerance", "looks of the slowest ray against tolerance", tolerance, {"looks_most", "looks of the ray that takes most"}}};

constexpr double largest_order_error = 0.05;  // beyond it the points follow no power law

struct Series {
  std::string name;
  std::vector<double> x, y;
};

// The number of rays that most variants have, of equally many the larger: plots of densities and of errors are of these.
double usual_rays(const std::vector<StudyRow>& rows) {
  std::map<double, int> count;
  for (const StudyRow& row : rows) ++count[row.settings->number("rays")];
  return std::max_element(count.begin(), count.end(), [](const auto& a, const auto& b) { return a.second < b.second || (a.second == b.second && a.first < b.first); })->first;
}

// Of absolute values: errors of both signs would cancel.
double mean_size(const Ensemble& one, const char* column) {
  std::vector<double> sizes = one.numbers(column);
  for (double& size : sizes) size = std::abs(size);
  return study::mean_of(sizes).mean;
}

// In the order in which the series first come, points by rising x where a line joins densities or rays, as they stand where it joins times.
std::vector<Series> series_of(const std::vector<Ensemble>& ensembles, const PlotKind& kind, double usual) {
  std::vector<Series> all;
  const bool is_over_rays = kind.x.column == rays.column;
  for (const Ensemble& one : ensembles) {
    if (!is_over_rays && one.first().settings->number("rays") != usual) continue;
    const std::string& name = is_over_rays ? one.first().of_any_rays : one.first().series;
    const double x = one.mean(kind.x.column).mean, y = mean_size(one, kind.y.column);
    if (!(x > 0 && y > 0)) continue;  // nor has a logarithmic axis a place for it
    auto found = std::find_if(all.begin(), all.end(), [&](const Series& series) { return series.name == name; });
    if (found == all.end()) found = all.insert(all.end(), {name, {}, {}});
    found->x.push_back(x);
    found->y.push_back(y);
  }
  return all;
}

bool has_several(const std::vector<double>& values, std::size_t at_least) { return std::set<double>(values.begin(), values.end()).size() >= at_least; }

bool varies(const std::vector<StudyRow>& rows, const char* column) {
  std::set<std::string> values;
  for (const StudyRow& row : rows)
    if (row.is_measured() && !row.has_failed()) values.insert(row.text(column));
  return values.size() > 1;
}

output::ChartSeries chart_series(const Series& series, bool is_over_time) {
  output::ChartSeries result{series.name, {}, true, {}};
  for (std::size_t i = 0; i < series.x.size(); ++i) result.points.push_back({series.x[i], series.y[i]});
  if (!is_over_time) std::stable_sort(result.points.begin(), result.points.end(), [](const auto& a, const auto& b) { return a.x < b.x; });
  const std::set<double> places(series.x.begin(), series.x.end());
  result.is_joined = is_over_time || places.size() == series.x.size();  // of several at one density: clouds of markers
  return result;
}

}  // namespace

std::vector<StudyPlot> plots_of(const prescription::StudyFile& study, const std::vector<StudyRow>& rows) {
  std::vector<StudyPlot> plots;
  const std::vector<Ensemble> ensembles = ensembles_of(rows);
  const double usual = usual_rays(rows);
  std::size_t most_seeds = 1;
  for (const Ensemble& one : ensembles) most_seeds = std::max(most_seeds, one.rows.size());
  for (const PlotKind& kind : kinds) {
    if (kind.where_varies && !varies(rows, kind.where_varies)) continue;
    const bool is_over_time = kind.x.column == time.column;
    std::vector<Series> all = series_of(ensembles, kind, usual);
    if (!is_over_time) std::erase_if(all, [](const Series& one) { return !has_several(one.x, 2); });
    if (all.empty()) continue;
    StudyPlot plot{kind.file, {}, {}};
    plot.chart.title = fmt::format("{}: {}", study.title, kind.title);
    plot.chart.footer = fmt::format("{}{}; sagitta {}", kind.fitted ? "dashed: fitted orders in the spacing of the points, 1/√density; " : "", processor_name(), version());
    if (kind.x.column != rays.column) plot.chart.footer = fmt::format("{} rays; {}", count_in_words(usual), plot.chart.footer);
    if (most_seeds > 1) plot.chart.footer = fmt::format("means over up to {} seeds; {}", most_seeds, plot.chart.footer);
    plot.chart.x_label = kind.x.label;
    plot.chart.y_label = kind.y.label;
    for (const Series& one : all) {
      plot.chart.series.push_back(chart_series(one, is_over_time));
      if (!kind.fitted || !has_several(one.x, 3)) continue;
      std::vector<double> spacings;
      for (const double x : one.x) spacings.push_back(1 / std::sqrt(x));
      const study::Order order = study::order_of(spacings, one.y);
      if (!(order.standard_error <= largest_order_error)) continue;
      plot.orders.push_back({one.name, kind.fitted, order});
      const auto [low, high] = std::minmax_element(one.x.begin(), one.x.end());
      plot.chart.series.back().fit = output::PowerLaw{order.factor, -order.slope / 2, *low, *high, fmt::format("order {:.2f}", std::abs(order.slope) < .005 ? 0.0 : order.slope)};
    }
    plots.push_back(std::move(plot));
  }
  return plots;
}

}  // namespace sagitta::tools
