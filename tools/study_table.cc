// SPDX-License-Identifier: Apache-2.0
#include "tools/study_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <set>

#include "lib/numerics/parallel.h"
#include "lib/output/text.h"
#include "lib/prescription/yaml_tree.h"
#include "lib/trace/pattern.h"
#include "tools/version.h"

namespace sagitta::tools {
namespace {

using prescription::Parameters;
using prescription::StudyFile;

std::string file_text(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

// FNV-1a, 64 bits.
std::string hash_of(std::string_view text) {
  std::uint64_t hash = 0xCBF29CE484222325u;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001B3u;
  return fmt::format("{:016x}", hash);
}

// All that rows of a study depend on but their settings: the system with the files that it names, the program, the processor.
std::string basis_of(const StudyFile& study) {
  const prescription::Model& system = study.system;
  std::string basis = fmt::format("{}\n{}\nsurface {} field {}\n", about_this_build(), processor_name(), study.surface_number, study.field);
  for (const auto& document : system.documents) basis += file_text(document.file);
  for (const auto& surface : system.surfaces) {
    if (surface.medium) basis += fmt::format("{} ", surface.medium->index(system.primary_wavelength_nm() / 1000));
    if (surface.shape.cloud) basis += file_text(surface.shape.cloud->file);
    if (surface.shape.grid) basis += file_text(surface.shape.grid->file);
  }
  return hash_of(basis);
}

// `threads` 0 is so many.
std::string settings_text(const Parameters& settings, int thread_count, std::string_view without = {}) {
  std::string text;
  for (const auto& [key, value] : settings.numbers)
    if (key != without) text += fmt::format("{}: {}\n", key, key == "threads" && value == 0 ? thread_count : value);
  for (const auto& [key, value] : settings.texts) text += fmt::format("{}: {}\n", key, value);
  return text;
}

// A setting in a name, where it is one of several in the study.
struct Word {
  const char* key;
  const char* format;  // of its value
  bool is_in_series;
};
constexpr Word words[] = {{"surface", "{}", true}, {"field", "{}", true}, {"points_per_mm2", "{} per mm²", false}, {"rings", "{} rings", true}, {"meridians", "{} meridians", true}, {"tolerance_mm", "to {} mm", false},
                          {"margin_spacings", "margin {}", true}, {"cloud_radius_mm", "radius {} mm", true}, {"shape_spacings", "shape {}", true}, {"search", "{}", true}, {"pattern", "{}", true},
                          {"rays", "{} rays", false}, {"compared_rays", "{} compared", false}, {"prepare_repeats", "prepared {} times", false}, {"threads", "{}", true}, {"rms_um", "roughness {} µm", true},
                          {"correlation_length_um", "correlated over {} µm", true}, {"truth", "against the {} surface", true}, {"seed", "seed {}", false}};

// A field as people name it: "40°", "(10°, 20°)", "5 mm".
std::string field_name(const prescription::Fields& fields, std::size_t field) {
  const auto& point = fields.points[field];
  const char* unit = fields.kind == prescription::FieldKind::angles_deg ? "°" : " mm";
  return point.x == 0 ? fmt::format("{:g}{}", point.y, unit) : fmt::format("({:g}{}, {:g}{})", point.x, unit, point.y, unit);
}

std::string value_of(const StudyFile& study, const Parameters& settings, std::string_view key) {
  if (key == "field") return field_name(study.system.fields, prescription::field_of(settings));
  if (key == "threads") {
    const double threads = settings.number(key);
    return threads == 0 ? "all threads" : fmt::format("{:g} thread{}", threads, threads == 1 ? "" : "s");
  }
  if (key == "rays") return count_in_words(settings.number(key));
  const auto number = settings.numbers.find(key);
  return number != settings.numbers.end() ? fmt::format("{:.9g}", number->second) : settings.text(key);
}

// Whether a setting says something of a variant.
bool is_of_use(std::string_view key, const Parameters& settings) {
  constexpr std::array of_points{"points_per_mm2", "rings", "meridians", "margin_spacings", "cloud_radius_mm", "shape_spacings", "search"};
  const std::string& interpolation = settings.text("interpolation");
  const bool is_sampled = interpolation != study::Variant::as_prescribed;
  if (std::find(of_points.begin(), of_points.end(), key) != of_points.end() && !is_sampled) return false;
  if (key == "tolerance_mm") return !is_sampled;
  if (key == "margin_spacings") return !(settings.number("cloud_radius_mm") > 0);
  if (key == "compared_rays") return settings.number("compared_rays") < settings.number("rays");
  if (key == "shape_spacings") return interpolation == "multiquadric";
  if (key == "correlation_length_um" || key == "truth") return settings.number("rms_um") != 0;
  return true;
}

void name_rows(const StudyFile& study, std::vector<StudyRow>& rows) {
  std::map<std::string, std::set<std::string>> values;
  for (const StudyRow& row : rows)
    for (const Word& word : words)
      if (is_of_use(word.key, *row.settings) || std::string_view(word.key) == "compared_rays") values[word.key].insert(value_of(study, *row.settings, word.key));
  const auto is_as_prescribed = [](const StudyRow& row) { return row.settings->text("interpolation") == study::Variant::as_prescribed; };
  const bool all_as_prescribed = std::all_of(rows.begin(), rows.end(), is_as_prescribed);
  for (StudyRow& row : rows) {
    row.series = all_as_prescribed ? "" : row.settings->text("interpolation") + (is_as_prescribed(row) ? "" : " " + row.settings->text("arrangement"));
    row.name = row.of_any_rays = row.of_any_seed = row.series;
    const auto add = [&row](const std::string& text, std::string_view key, bool to_series) {
      row.name += text;
      if (key != "seed") row.of_any_seed += text;
      if (key != "seed" && key != "rays") row.of_any_rays += text;
      if (to_series) row.series += text;
    };
    for (const Word& word : words) {
      const std::string key = word.key, value = value_of(study, *row.settings, word.key);
      const bool is_nothing = value == "0" || value == "walk";
      if (values[key].size() < 2 || !is_of_use(key, *row.settings)) continue;
      if (key == "tolerance_mm") add(is_nothing ? ", as traced" : ", Newton", "", true);
      if (!is_nothing) add(" " + fmt::format(fmt::runtime(word.format), value), key, word.is_in_series);
    }
    for (std::string* name : {&row.name, &row.of_any_rays, &row.of_any_seed, &row.series}) {
      name->erase(0, std::min(name->find_first_not_of(" ,"), name->size()));
      if (name->empty()) *name = row.settings->text("interpolation");
    }
  }
}

std::string cell(double value) { return std::isfinite(value) ? fmt::format("{}", value) : ""; }
std::string cell(std::int64_t value) { return fmt::format("{}", value); }
std::string cell(int value) { return fmt::format("{}", value); }

using Cells = std::map<std::string, std::string, std::less<>>;

Cells settings_cells(const StudyRow& row, const StudyFile& study) {
  const Parameters& settings = *row.settings;
  Cells cells{{"study", study.name}, {"variant", row.name}, {"key", row.key}, {"tolerance", cell(settings.number("tolerance_mm"))}};
  for (const auto& [key, value] : settings.numbers) cells[key] = cell(value);
  for (const auto& [key, value] : settings.texts) cells[key] = value;
  if (settings.text("interpolation") == study::Variant::as_prescribed)
    for (const char* key : {"arrangement", "points_per_mm2", "margin_spacings", "shape_spacings", "search"}) cells[key].clear();
  cells["roughness_rms_um"] = cells["rms_um"];
  return cells;
}

void add(Cells& cells, const study::Row& row) {
  if (row.points > 0 && cells["points_per_mm2"] == "0") cells["points_per_mm2"] = cell(row.points_per_mm2);
  const auto& distance = row.surface.distance_um;
  const auto& angle = row.surface.angle_arcmin;
  const auto& found = row.surface.found;
  cells.merge(Cells{{"points", cell(row.points)}, {"triangles", cell(row.triangles)}, {"distance_mean_um", cell(distance.mean)}, {"distance_rms_um", cell(distance.rms)},
                    {"distance_max_um", cell(distance.max)}, {"angle_mean_arcmin", cell(angle.mean)}, {"angle_rms_arcmin", cell(angle.rms)}, {"angle_max_arcmin", cell(angle.max)},
                    {"spot_rms_um", cell(row.spot.rms_radius_um)}, {"true_spot_rms_um", cell(row.spot.true_rms_radius_um)}, {"spot_rms_error_percent", cell(row.spot.rms_radius_percent)},
                    {"wavefront_rms_error_waves", cell(row.wavefront_rms_waves)}, {"wavefront_without_tilt_waves", cell(row.wavefront_rms_without_tilt_waves)},
                    {"only_one_finds", cell(found.by_one_only())}, {"only_truth_finds", cell(found.by_truth_only)}, {"only_variant_finds", cell(found.by_variant_only)},
                    {"both_find", cell(found.by_both)}, {"looks_per_ray", cell(row.looks_per_ray)}, {"looks_most", cell(row.looks_most)},
                    {"prepare_s", cell(row.prepare_s.median)}, {"prepare_least_s", cell(row.prepare_s.least)}, {"prepare_most_s", cell(row.prepare_s.most)},
                    {"prepare_wall_s", cell(row.prepare_wall_s.median)}, {"prepare_runs", cell(row.prepare_s.runs)}, {"ns_per_ray", cell(row.ns_per_ray.median)},
                    {"ns_per_ray_least", cell(row.ns_per_ray.least)}, {"ns_per_ray_most", cell(row.ns_per_ray.most)}, {"wall_ns_per_ray", cell(row.wall_ns_per_ray.median)},
                    {"trace_runs", cell(row.ns_per_ray.runs)}});
  cells["cloud_radius_mm"] = cell(row.cloud_radius_mm);
  cells["rays"] = cell(row.rays);
  cells["threads"] = cell(row.threads);
  cells["compared_rays"] = cell(row.compared);
}

std::vector<std::string> in_order(const Cells& cells) {
  std::vector<std::string> ordered;
  for (const output::RecordColumn& column : study_columns()) {
    const auto found = cells.find(column.name);
    ordered.push_back(found == cells.end() ? "" : found->second);
  }
  return ordered;
}

std::size_t column_at(std::string_view name) {
  const auto& columns = study_columns();
  return static_cast<std::size_t>(std::find_if(columns.begin(), columns.end(), [&](const auto& one) { return one.name == name; }) - columns.begin());
}

}  // namespace

study::Variant variant_of(const Parameters& settings) {
  const auto whole = [&](const char* key) { return static_cast<std::int64_t>(settings.number(key)); };
  study::Variant variant;
  variant.interpolation = settings.text("interpolation");
  variant.arrangement = {study::arrangement_named(settings.text("arrangement")).value_or(study::ArrangementKind::regular), settings.number("points_per_mm2"),
                         static_cast<int>(whole("rings")), static_cast<int>(whole("meridians"))};
  variant.search = settings.text("search") == "nearest_vertex" ? study::Search::nearest_vertex : study::Search::walk;
  variant.margin_spacings = settings.number("margin_spacings");
  variant.cloud_radius_mm = settings.number("cloud_radius_mm");
  variant.shape_spacings = settings.number("shape_spacings");
  variant.noise = {settings.number("rms_um"), settings.number("correlation_length_um")};
  variant.is_against_clean = settings.text("truth") == "clean";
  variant.seed = static_cast<std::uint64_t>(settings.number("seed"));
  variant.pattern = trace::parse_pattern(settings.text("pattern")).value_or(trace::Pattern{});
  variant.rays = whole("rays");
  variant.most_compared = whole("compared_rays");
  variant.threads = static_cast<int>(whole("threads"));
  variant.prepare_repeats = static_cast<int>(whole("prepare_repeats"));
  variant.tolerance_mm = settings.number("tolerance_mm");
  return variant;
}

const std::vector<output::RecordColumn>& study_columns() {
  static const std::vector<output::RecordColumn> columns{
      {"study", true}, {"variant", true}, {"interpolation", true}, {"arrangement", true}, {"points_per_mm2"}, {"points"}, {"triangles"}, {"rays"}, {"threads"}, {"tolerance"},
      {"distance_mean_um"}, {"distance_rms_um"}, {"angle_mean_arcmin"}, {"angle_rms_arcmin"}, {"spot_rms_um"}, {"spot_rms_error_percent"}, {"wavefront_rms_error_waves"},
      {"only_one_finds"}, {"prepare_s"}, {"ns_per_ray"}, {"peak_mib"},
      // further ones
      {"surface", true}, {"field"}, {"search", true}, {"pattern", true}, {"seed"}, {"roughness_rms_um"}, {"correlation_length_um"}, {"truth", true}, {"rings"}, {"meridians"}, {"margin_spacings"}, {"shape_spacings"},
      {"compared_rays"}, {"both_find"}, {"only_truth_finds"}, {"only_variant_finds"}, {"cloud_radius_mm"}, {"distance_max_um"}, {"angle_max_arcmin"}, {"true_spot_rms_um"},
      {"wavefront_without_tilt_waves"}, {"looks_per_ray"}, {"looks_most"}, {"prepare_least_s"}, {"prepare_most_s"}, {"prepare_wall_s"}, {"prepare_runs"}, {"ns_per_ray_least"}, {"ns_per_ray_most"},
      {"wall_ns_per_ray"}, {"trace_runs"}, {"own_mib"}, {"failed", true}, {"key", true}};
  return columns;
}

const std::string& StudyRow::text(std::string_view column) const { return cells[column_at(column)]; }

double StudyRow::number(std::string_view column) const {
  const auto parsed = is_measured() ? prescription::parse_number(text(column)) : prescription::ParsedNumber{};
  return parsed.ok ? parsed.value : std::numeric_limits<double>::quiet_NaN();
}

std::vector<StudyRow> rows_of(const StudyFile& study, int thread_count) {
  const std::string basis = basis_of(study);
  std::vector<StudyRow> rows;
  const int threads = numerics::thread_count_of(thread_count);
  for (const Parameters& settings : study.variants)
    rows.push_back({&settings, "", "", "", "", settings_text(settings, threads, "seed"), hash_of(basis + settings_text(settings, threads)), {}});
  name_rows(study, rows);
  return rows;
}

void fill(StudyRow& row, const StudyFile& study, const MeasuredRow& measured) {
  Cells cells = settings_cells(row, study);
  if (measured.measured.row) add(cells, *measured.measured.row);
  else cells["failed"] = output::printable(measured.measured.reason, 1000);
  if (measured.peak_mib > 0) cells["peak_mib"] = cell(measured.peak_mib);
  cells["own_mib"] = cell(measured.own_mib);
  row.cells = in_order(cells);
}

Finished take_finished(std::vector<StudyRow>& rows, const StudyFile& study, std::string_view csv) {
  const auto earlier = output::rows_of_csv(csv, study_columns());
  if (!earlier) return {0, 0, true};
  int count = 0;
  for (StudyRow& row : rows) {
    const auto found = std::find_if(earlier->begin(), earlier->end(), [&](const auto& cells) { return cells[column_at("key")] == row.key && cells[column_at("failed")].empty(); });
    if (found == earlier->end()) continue;
    row.cells = *found;
    row.cells[column_at("study")] = study.name;
    row.cells[column_at("variant")] = row.name;
    ++count;
  }
  return {count, static_cast<int>(earlier->size()) - count, false};
}

output::Records records_of(const std::vector<StudyRow>& rows) {
  output::Records records{study_columns(), {}};
  for (const StudyRow& row : rows)
    if (row.is_measured()) records.rows.push_back(row.cells);
  return records;
}

std::string count_in_words(double count) {
  const std::string text = fmt::format("{:.9g}", count);
  const std::size_t zeros = text.size() - 1 - text.find_last_not_of('0');
  return zeros < 6 ? text : fmt::format("{}e{}", text.substr(0, text.size() - zeros), zeros);
}

std::vector<double> Ensemble::numbers(std::string_view column) const {
  std::vector<double> numbers;
  for (const StudyRow* row : rows) numbers.push_back(row->number(column));
  return numbers;
}

std::vector<Ensemble> ensembles_of(const std::vector<StudyRow>& rows) {
  std::vector<Ensemble> all;
  std::map<std::string_view, std::size_t> places;
  for (const StudyRow& row : rows) {
    if (!row.is_measured() || row.has_failed()) continue;
    const auto [place, is_new] = places.emplace(row.settings_but_seed, all.size());
    if (is_new) all.emplace_back();
    all[place->second].rows.push_back(&row);
  }
  return all;
}

std::string processor_name() {
  std::ifstream stream("/proc/cpuinfo");
  for (std::string line; std::getline(stream, line);)
    if (line.starts_with("model name"))
      if (const auto at = line.find(": "); at != std::string::npos) return line.substr(at + 2);
  return {};
}

}  // namespace sagitta::tools
