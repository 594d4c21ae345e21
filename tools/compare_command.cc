// SPDX-License-Identifier: Apache-2.0
// sagitta compare A.yaml B.yaml -o DIR: several systems by the rays of the first.
#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <utility>

#include "lib/output/atomic_file.h"
#include "lib/output/comparison.h"
#include "tools/cloud_variants.h"
#include "tools/commands.h"
#include "tools/job_report.h"
#include "tools/load.h"
#include "tools/pictures.h"
#include "tools/write.h"

namespace sagitta::tools {
namespace {

namespace fs = std::filesystem;
using prescription::Model;

// Several of one name get the name of their file as well, and what is still the same a number.
void make_names_unique(std::vector<ComparedModel>& models) {
  std::map<std::string, int> bearers;
  for (const ComparedModel& one : models) ++bearers[one.name];
  std::set<std::string> taken;
  for (ComparedModel& one : models) {
    if (bearers[one.name] > 1) one.name += fmt::format(" ({})", fs::path(one.model.file).stem().string());
    const std::string base = one.name;
    for (int number = 2; !taken.insert(one.name).second; ++number) one.name = fmt::format("{} {}", base, number);
  }
}

std::vector<std::string> unique_slugs(const std::vector<ComparedModel>& models) {
  std::vector<std::string> slugs;
  std::set<std::string> taken;
  for (const ComparedModel& one : models) {
    const std::string base = output::slug_of(one.name);
    std::string slug = base;
    for (int number = 2; !taken.insert(slug).second; ++number) slug = fmt::format("{}-{}", base, number);
    slugs.push_back(std::move(slug));
  }
  return slugs;
}

struct LoadedModels {
  std::vector<ComparedModel> models;
  int status = 0;  // where one is missing, as of load_model
};
LoadedModels load_models(const CompareOptions& options) {
  LoadedModels loaded;
  for (const std::string& file : options.systems) {
    auto model = load_model(file, options.settings);
    loaded.status = std::max(loaded.status, model.status);
    if (model) loaded.models.push_back({model->name.empty() ? fs::path(file).stem().string() : model->name, *std::move(model), std::nullopt});
  }
  return loaded;
}

// Wavelengths, fields, object and beam of the first; false, with a message, where a medium does not reach so far.
bool take_rays_of(const Model& first, const scene::LaunchPupil& pupil, Model& model) {
  model.object = first.object;
  std::vector<double> needed = first.wavelengths_nm;
  needed.push_back(first.primary_wavelength_nm());
  if (!set_wavelengths(model, needed, fmt::format("compare: {}, by the rays of {}", model.file, first.file))) return false;
  model.wavelengths_nm = first.wavelengths_nm;
  model.primary_nm = first.primary_nm;
  model.fields = first.fields;
  model.aperture.kind = first.aperture.kind;
  model.aperture.value = first.aperture.value;
  model.aperture.is_of_stop = first.aperture.is_of_stop;
  if (!pupil.telecentric) {
    model.aperture.kind = prescription::ApertureKind::entrance_pupil_diameter_mm;
    model.aperture.value = 2 * pupil.semi_diameter;
  }
  return true;
}

struct CompiledSystems {
  std::vector<output::Report> reports;
  std::vector<scene::Scene> scenes;  // as many, or fewer where one could not be compiled
};

// With what the rays need of point clouds, or with all of them.
CompiledSystems compile_all(std::vector<ComparedModel>& models, bool whole) {
  CompiledSystems result;
  for (ComparedModel& one : models) {
    const bool is_first = &one == &models.front();
    if (!is_first && !take_rays_of(models.front().model, result.scenes.front().pupil, one.model)) continue;
    std::optional<scene::LaunchPupil> pupil;
    if (!is_first) pupil = result.scenes.front().pupil;
    auto compiled = load_scene(one.model, whole ? scene::Beam{} : analysis::beam_of_job(pupil));
    if (!compiled && is_first) break;
    if (!compiled) continue;
    result.reports.push_back(make_report(one.model, *compiled));
    result.reports.back().system = one.name;
    result.scenes.push_back(*std::move(compiled->scene));
    result.scenes.back().pupil = result.scenes.front().pupil;
  }
  return result;
}

constexpr std::int64_t most_rays_of_a_share = 10000;  // a share of the beam to some 0.01 %

// What share of the beam lies where the points told the fit what to do. Beyond the circle the surface is extrapolated.
void add_coverage(const scene::Scene& scene, const output::FitQuality& fit, const analysis::JobRequest& request, std::vector<analysis::JobResult>& results) {
  const auto pupil = trace::pupil_points(request.pattern, std::min(request.ray_count, most_rays_of_a_share));
  for (analysis::JobResult& result : results) {
    const double share = share_within(scene, scene.fields[result.field], scene.wavelengths[result.wavelength], pupil, fit.surface_number, fit.radius_mm);
    const auto before = std::find_if(result.coverage.begin(), result.coverage.end(), [&](const auto& one) { return one.surface_number > fit.surface_number; });
    result.coverage.insert(before, {fit.surface_number, share});
  }
}

output::Comparison compare(const std::vector<ComparedModel>& models, CompiledSystems compiled) {
  output::Comparison comparison;
  std::vector<output::Report>& reports = compiled.reports;
  const std::vector<std::string> slugs = unique_slugs(models);
  for (std::size_t i = 0; i < models.size(); ++i) {
    const output::Report& reference = i == 0 ? reports[i] : comparison.systems.front().report;
    std::vector<analysis::Difference> differences = analysis::differences(reports[i].results, reference.results);
    comparison.systems.push_back({std::move(reports[i]), slugs[i], models[i].fit, std::move(differences)});
  }
  const Model& first = models.front().model;
  const auto primary = std::find(first.wavelengths_nm.begin(), first.wavelengths_nm.end(), first.primary_wavelength_nm());
  if (primary != first.wavelengths_nm.end()) comparison.primary = static_cast<std::size_t>(primary - first.wavelengths_nm.begin());
  return comparison;
}

bool write_all(const fs::path& folder, const output::Comparison& comparison, const std::string& summary, int thread_count) {
  const std::vector<output::Figure> figures = sheets(comparison);
  const auto sheet_of = [&](std::size_t field) { return folder / fmt::format("comparison.field{}.png", field); };
  std::error_code none_there;
  for (std::size_t field = figures.size(); fs::remove(sheet_of(field), none_there); ++field) {}  // of an earlier run
  bool all_written = write_image("compare", folder / "comparison", parts(comparison), figures.front(), thread_count);
  for (std::size_t field = 1; field < figures.size(); ++field)
    all_written &= write_picture("compare", sheet_of(field), figures[field]);
  return written("compare", output::write_file((folder / "summary.json").string(), summary)) && all_written;
}

constexpr std::size_t most_systems = 16;  // rows of a sheet

bool is_well_used(const CompareOptions& options, std::vector<VariantKind>& kinds) {
  const auto refuse = [](const std::string& what) {
    fmt::print(stderr, "sagitta compare: {}\n", what);
    return false;
  };
  if (std::max(options.systems.size(), options.as.size()) > most_systems)
    return refuse(fmt::format("at most {} systems are compared", most_systems));
  if (options.surface.empty())
    return options.systems.size() >= 2 || refuse("two systems or more are compared; with --surface, --with and --as, variants of one");
  if (options.systems.size() > 1) return refuse("--surface takes one system");
  if (options.as.size() < 2) return refuse("--as: give two ways or more, such as delaunay,zernike:36");
  for (const std::string& text : options.as) {
    ParsedVariant parsed = parse_variant(text);
    if (!parsed.kind) return refuse(fmt::format("--as {}: {}", text, parsed.fault));
    kinds.push_back(*std::move(parsed.kind));
  }
  return true;
}

}  // namespace

int compare_command(const CompareOptions& options) {
  auto request = make_request("compare", options);
  if (!request) return 2;
  std::vector<VariantKind> kinds;
  if (!is_well_used(options, kinds)) return 2;

  LoadedModels loaded = load_models(options);
  if (loaded.status != 0) return loaded.status;
  std::vector<ComparedModel> models = std::move(loaded.models);
  std::string title;
  if (!kinds.empty()) {
    title = fmt::format("{}, {} from {}", models.front().name, options.surface, fs::path(options.points).filename().string());
    models = make_variants(models.front().model, {options.surface, options.points, options.format, options.axes, kinds, options.radius_mm, options.smoothing_um, options.max_edge_mm});
    if (models.empty()) return 1;
  }
  pictures("compare");
  make_names_unique(models);
  if (title.empty()) title = fmt::format("{} systems by the rays of {}", models.size(), models.front().name);

  request->spot_image_size = 512;  // sheets show the middle of it
  const fs::path folder(options.folder);
  CompiledSystems compiled;
  for (const bool whole : {false, true}) {
    compiled = compile_all(models, whole);
    if (compiled.scenes.size() < models.size()) return 1;
    if (!make_folder("compare", folder)) return 1;
    auto results = run_with_progress(compiled.scenes, *request);
    for (std::size_t i = 0; i < models.size(); ++i) compiled.reports[i].results = std::move(results[i]);
    if (std::none_of(compiled.reports.begin(), compiled.reports.end(), [](const output::Report& one) { return leaves_a_part(one); })) break;
  }
  for (std::size_t i = 0; i < models.size(); ++i)
    if (models[i].fit) add_coverage(compiled.scenes[i], *models[i].fit, *request, compiled.reports[i].results);
  output::Comparison comparison = compare(models, std::move(compiled));
  comparison.title = title;

  const std::string summary = summary_json(comparison);
  const bool all_written = write_all(folder, comparison, summary, options.thread_count);
  fmt::print("{}", options.json ? summary : summary_text(comparison));
  bool all_arrived = true;
  for (const output::ComparedSystem& system : comparison.systems) {
    const auto& results = system.report.results;
    if (std::any_of(results.begin(), results.end(), [](const auto& one) { return one.rays[surface::Status::ok] > 0; })) continue;
    fmt::print(stderr, "sagitta compare: not one ray arrived at the image surface of {}\n", system.report.system);
    all_arrived = false;
  }
  return all_written && all_arrived ? 0 : 1;
}

}  // namespace sagitta::tools
