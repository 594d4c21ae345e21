// SPDX-License-Identifier: Apache-2.0
#include "lib/scene/compile_cloud.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "lib/scene/fit_patches.h"
#include "lib/scene/fit_radial.h"
#include "lib/scene/triangulate_smoothed.h"

namespace sagitta::scene {
namespace {

using prescription::Findings;
using prescription::Parameters;
using prescription::PointCloud;
using Storage = std::shared_ptr<const MeshStorage>;

// The places between the facets over a footprint and the cut around the part: at first this many, then twice as many, and so on.
constexpr double least_layers = 14, most_layers = 112;

// Facets whose interpolant could be another one in the whole cloud are left out of a part.
template <class PatchArray>
void leave_out(const std::vector<char>& is_dropped, Storage& mesh, PatchArray& patches) {
  mesh = without_facets(*mesh, is_dropped);
  std::size_t kept = 0;
  for (std::size_t f = 0; f < patches.size(); ++f)
    if (!is_dropped[f]) patches[kept++] = patches[f];
  patches.resize(kept);
}

template <surface::RadialFunction function>
surface::Shape radial(Storage mesh, const Parameters& given, bool is_part, numerics::Arena& arena) {
  auto fit = fit_radial<function>(mesh->mesh, {static_cast<int>(given.number("rings")), given.number("shape_mm")});
  if (is_part) leave_out(fit.reaches_rim, mesh, fit.patches);
  return surface::RadialPatches<function>{surface::Facets{&arena.keep_shared(mesh).mesh}, arena.keep(std::move(fit.patches)),
                                          arena.keep(std::move(fit.nodes)), arena.keep(std::move(fit.weights)), fit.shape_squared};
}

surface::Shape smooth_patches(Storage mesh, bool is_part, numerics::Arena& arena) {
  auto fit = fit_patches(mesh->mesh);
  if (is_part) {
    std::vector<char> is_dropped(mesh->corners.size());
    std::transform(mesh->corners.begin(), mesh->corners.end(), is_dropped.begin(), [&](const surface::Corners& corners) {
      return std::any_of(corners.begin(), corners.end(), [&](std::uint32_t v) { return fit.reaches_rim[v]; });
    });
    leave_out(is_dropped, mesh, fit.patches);
  }
  return surface::Patches{surface::Facets{&arena.keep_shared(mesh).mesh}, arena.keep(std::move(fit.patches))};
}

surface::Shape interpolate(const Storage& mesh, const Parameters& given, bool is_part, numerics::Arena& arena) {
  using surface::RadialFunction;
  const std::string& interpolation = given.text("interpolation");
  if (interpolation == "linear") return surface::Facets{&arena.keep_shared(mesh).mesh};
  if (interpolation == "cubic") return radial<RadialFunction::cubic>(mesh, given, is_part, arena);
  if (interpolation == "thin_plate") return radial<RadialFunction::thin_plate>(mesh, given, is_part, arena);
  if (interpolation == "multiquadric") return radial<RadialFunction::multiquadric>(mesh, given, is_part, arena);
  return smooth_patches(mesh, is_part, arena);
}

// How far places lie from a rectangle: the greater of the distances along x and y.
std::vector<float> distances_from(const Rectangle& box, const PointCloud& cloud) {
  std::vector<float> distances(cloud.points.size());
  std::transform(cloud.points.begin(), cloud.points.end(), distances.begin(), [&](const auto& p) {
    return static_cast<float>(std::max({0.0, box.low_x - p.x, p.x - box.high_x, box.low_y - p.y, p.y - box.high_y}));
  });
  return distances;
}

}  // namespace

surface::Facets* facets_of(surface::Shape& shape) {
  return std::visit(
      []<class S>(S& of) -> surface::Facets* {
        if constexpr (std::is_same_v<S, surface::Facets>) return &of;
        else if constexpr (requires { of.facets; }) return &of.facets;
        else return nullptr;
      },
      shape);
}

CompiledCloud compile_cloud(const prescription::Shape& given, numerics::Arena& arena, Findings& findings) {
  const auto& parameters = given.parameters;
  auto [made, cloud, smoothing] = triangulate_smoothed(given.cloud, parameters.number("max_edge_mm"), parameters.number("smoothing_um") / 1000);
  for (const auto& finding : made.findings.all()) findings.add(finding);
  if (!made.findings.all().empty()) findings.note(given.place, "named here");
  if (!made.mesh) return {};
  if (smoothing)
    findings.note(given.place, fmt::format("smoothed: the heights leave the points by {:.4g} um rms, {:.4g} um at most{}", 1000 * smoothing->residual_rms,
                                           1000 * smoothing->residual_max, std::isfinite(smoothing->lambda) ? "" : ": the best-fit sphere and plane, "
                                           "as smooth as can be, for smoothing_um is more than they leave"));
  return {interpolate(made.mesh, parameters, false, arena), std::move(cloud), smoothing};
}

bool may_be_a_part(const prescription::Shape& given) {
  const auto& parameters = given.parameters;
  const bool wants_mean_edge = parameters.text("interpolation") == "multiquadric" && !(parameters.number("shape_mm") > 0);
  return !(parameters.number("smoothing_um") > 0) && !wants_mean_edge && has_legal_coordinates(*given.cloud);
}

std::optional<PartOfCloud> compile_part(const prescription::Shape& given, const std::vector<Line>& lines, numerics::Arena& arena,
                                        Findings& findings) {
  const PointCloud& cloud = *given.cloud;
  const CloudExtent extent = extent_of(cloud);
  const auto footprint = footprint_of(lines, extent.low.z, extent.high.z);
  if (!footprint) return std::nullopt;
  std::vector<float> distances = distances_from(footprint->places, cloud);
  const auto inside = static_cast<double>(std::count(distances.begin(), distances.end(), 0.0f));
  for (double layers = least_layers; layers <= most_layers; layers *= 2) {
    // as many as a square of `inside` places has with that many layers around it
    const double wanted = inside + 4 * layers * std::sqrt(inside) + 4 * layers * layers;
    if (!(wanted < static_cast<double>(cloud.points.size()) / 2)) return std::nullopt;
    const auto farthest = distances.begin() + static_cast<std::ptrdiff_t>(wanted);
    std::nth_element(distances.begin(), farthest, distances.end());
    const Triangulation made = triangulate_part(cloud, extent, footprint->places.grown(double{*farthest}), given.parameters.number("max_edge_mm"));
    if (!made.mesh) continue;
    numerics::Arena kept = arena;
    surface::Shape shape = interpolate(made.mesh, given.parameters, true, kept);
    if (!settles(*facets_of(shape)->mesh, *footprint)) continue;
    for (const auto& finding : made.findings.all()) findings.add(finding);
    if (!made.findings.all().empty()) findings.note(given.place, "named here");
    arena = std::move(kept);
    return PartOfCloud{std::move(shape), made.place_count};
  }
  return std::nullopt;
}

}  // namespace sagitta::scene
