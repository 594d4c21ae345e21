// SPDX-License-Identifier: Apache-2.0
#include "lib/scene/triangulate_smoothed.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <utility>

namespace sagitta::scene {
namespace {

using prescription::PointCloud;

constexpr std::uint32_t most_vertices = 1000000;  // beyond, the factors of the sparse matrix outgrow memory and patience

// The cloud with the heights z of the mesh's vertices at their places, repeated points included.
PointCloud with_heights(PointCloud cloud, const surface::Mesh& mesh, const std::vector<double>& z) {
  const auto place_of_vertex = [&](std::uint32_t v) { return std::pair(mesh.vertices[v].x, mesh.vertices[v].y); };
  std::vector<std::uint32_t> order(mesh.vertex_count);
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](auto a, auto b) { return place_of_vertex(a) < place_of_vertex(b); });
  for (auto& p : cloud.points) {
    const std::pair place(p.x, p.y);
    const auto found = std::lower_bound(order.begin(), order.end(), place, [&](auto v, const auto& wanted) { return place_of_vertex(v) < wanted; });
    if (found != order.end() && place_of_vertex(*found) == place) p.z = z[*found];
  }
  return cloud;
}

}  // namespace

SmoothedTriangulation triangulate_smoothed(std::shared_ptr<const PointCloud> cloud, double max_edge, double rms) {
  SmoothedTriangulation result{triangulate(*cloud, max_edge), cloud, std::nullopt};
  prescription::Findings& findings = result.triangulation.findings;
  if (!(rms > 0) || !result.triangulation.mesh) return result;
  const auto refuse = [&](std::string what, std::string hint) {
    findings.error({cloud->file}, std::move(what), std::move(hint));
    result.triangulation.mesh = nullptr;
    return result;
  };
  const surface::Mesh& mesh = result.triangulation.mesh->mesh;
  if (mesh.vertex_count > most_vertices)
    return refuse(fmt::format("{} points: at most {} can be smoothed", mesh.vertex_count, most_vertices), "leave out smoothing_um, or points");
  const auto smoothed = smooth(mesh, rms);
  if (!smoothed) return refuse("the smoothing of the points leaves the range of numbers", "leave out smoothing_um");

  result.smoothing = smoothed->effect;
  result.cloud = std::make_shared<PointCloud>(with_heights(*cloud, mesh, smoothed->z));
  Triangulation again = triangulate(*result.cloud, max_edge);
  if (!again.mesh) findings = again.findings;  // what else it finds was told the first time
  result.triangulation.mesh = again.mesh;
  return result;
}

}  // namespace sagitta::scene
