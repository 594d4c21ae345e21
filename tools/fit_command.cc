// SPDX-License-Identifier: Apache-2.0
// sagitta fit POINTS: measured points to a Zernike surface that a prescription can take.
#include <fmt/core.h>

#include <filesystem>

#include "lib/output/fit_report.h"
#include "lib/prescription/cloud_reader.h"
#include "tools/commands.h"
#include "tools/load.h"
#include "tools/version.h"
#include "tools/write.h"

namespace sagitta::tools {

int fit_command(const FitOptions& options) {
  const scene::ZernikeSurfaceRequest request{options.terms, options.radius_mm, numerics::zernike_indexing(options.indexing)};
  if (const int most = scene::most_zernike_terms(request.indexing); options.terms > most) {
    fmt::print(stderr, "sagitta fit: --terms {}: {} has at most {}\n", options.terms, options.indexing, most);
    return 2;
  }
  if (options.axes == "osa" && !prescription::has_given_axes(options.format)) {
    fmt::print(stderr, "sagitta fit: --axes osa: the format {} itself tells its axes\n", options.format);
    return 2;
  }
  const std::filesystem::path fragment(options.fragment);
  if (!fragment.empty() && fragment.extension() != ".yaml" && fragment.extension() != ".yml") {
    fmt::print(stderr, "sagitta fit: -o {}: expected FILE.yaml; the residual map is written beside it\n", options.fragment);
    return 2;
  }
  auto base = fragment;
  base.replace_extension();
  if (overwrites("fit", "-o " + options.fragment, options.points, {fragment, base.string() + ".exr", base.string() + ".png"})) return 2;

  prescription::Findings findings;
  const auto cloud = prescription::read_cloud({options.points, options.format, options.axes == "osa"}, findings);
  if (!report(findings) || !cloud) return 1;
  auto fit = scene::fit_zernike_surface(*cloud, request);
  if (!fit.surface) {
    prescription::Findings refusal;
    refusal.error({options.points}, fit.reason, fit.hint);
    report(refusal);
    return 1;
  }
  auto map = scene::residual_map(*fit.surface);
  if (!report(map.findings)) return 1;

  const output::FitReport result{options.points, version(), *std::move(fit.surface), std::move(map.map)};
  fmt::print("{}", options.json ? fit_json(result) : fit_text(result));
  if (fragment.empty()) {
    if (!options.json) fmt::print("\n{}", fit_shape(result));
    return 0;
  }
  if (!make_folder("fit", fragment.parent_path())) return 1;
  // The fragment last: where it is there, all of it is.
  const bool map_written = !result.map || write_image("fit", base, {residual_part(result)}, residual_figure(result), 0);
  return map_written && written("fit", output::write_file(fragment.string(), fit_fragment(result))) ? 0 : 1;
}

}  // namespace sagitta::tools
