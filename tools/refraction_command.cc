// SPDX-License-Identifier: Apache-2.0
// sagitta refraction SYSTEM.yaml: the lens that an eye wants, for every field and wavelength.
#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

#include "lib/numerics/parallel.h"
#include "lib/output/refraction_report.h"
#include "tools/commands.h"
#include "tools/job_report.h"
#include "tools/load.h"
#include "tools/write.h"

namespace sagitta::tools {
namespace {

constexpr std::size_t most_of_spectrum = 1000;

// "400:700:10": from the first to the last, both included, in equal steps of at most that.
std::optional<std::vector<double>> parse_spectrum(const std::string& text) {
  double values[3];
  const char *at = text.data(), *const end = at + text.size();
  for (double& value : values) {
    if (&value != values) {
      if (at == end || *at != ':') return std::nullopt;
      ++at;
    }
    const auto [next, fault] = std::from_chars(at, end, value);
    if (fault != std::errc{}) return std::nullopt;
    at = next;
  }
  const auto [from, to, step] = values;
  if (at != end || !(from > 0) || !(to > from) || !(step > 0) || !((to - from) / step < most_of_spectrum)) return std::nullopt;
  const int steps = static_cast<int>(std::ceil((to - from) / step * (1 - 1e-12)));
  std::vector<double> result;
  for (int i = 0; i <= steps; ++i) result.push_back(i == steps ? to : from + (to - from) * i / steps);
  return result;
}

// The vitreous of every eye has an index above 1.3; that of a lens' image is air, as of its object.
bool is_eye(const prescription::Model& model, const scene::Scene& scene) {
  constexpr double least_index = 1.1;
  return !model.eye.empty() || !(scene.primary.index[scene.surfaces.size() - 1] < least_index);  // a gradient has NaN
}

}  // namespace

int refraction_command(const RefractionOptions& options) {
  std::optional<std::vector<double>> spectrum;
  if (!options.spectrum.empty() && !(spectrum = parse_spectrum(options.spectrum))) {
    fmt::print(stderr, "sagitta refraction: --spectrum {}: expected FROM:TO:STEP in nm, such as 400:700:10, of at most {} wavelengths\n", options.spectrum, most_of_spectrum);
    return 2;
  }
  if (!names_chart("refraction", options.picture)) return 2;
  auto model = load_model(options.system, options.settings);
  if (!model) return model.status;
  if (spectrum && !set_wavelengths(*model, *spectrum, "refraction")) return 1;
  const auto compiled = load_scene(*model);
  if (!compiled) return 1;
  const scene::Scene& scene = *compiled->scene;
  output::RefractionReport report{make_report(*model, *compiled), options.vertex_distance_mm, is_eye(*model, scene), {}};
  report.results.resize(scene.fields.size() * scene.wavelengths.size());
  numerics::share_blocks(report.results.size(), options.thread_count, [&] {
    return [&](std::size_t i) {
      report.results[i] = analysis::refraction(scene, scene.wavelengths[i % scene.wavelengths.size()], scene.fields[i / scene.wavelengths.size()], {.vertex_distance = options.vertex_distance_mm, .wavefront = {}});
    };
  });
  if (!options.picture.empty() && !write_chart_file("refraction", options.picture, refraction_chart(report))) return 1;
  fmt::print("{}", options.json ? refraction_json(report) : refraction_text(report));
  const bool any = std::any_of(report.results.begin(), report.results.end(), [](const auto& result) { return result.refraction.has_value(); });
  if (!any) fmt::print(stderr, "sagitta refraction: no field has a refraction\n");
  return any ? 0 : 1;
}

}  // namespace sagitta::tools
