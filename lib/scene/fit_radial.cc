// SPDX-License-Identifier: Apache-2.0
#include "lib/scene/fit_radial.h"

#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "lib/scene/rings.h"

namespace sagitta::scene {
namespace {

using surface::RadialFunction;
using surface::RadialPatches;

// The size of phi over a distance s, so that the system's entries are near 1. (For the thin plate a power of s that has no
// zero: a factor of phi changes the weights alone.)
template <RadialFunction function>
double size_of(double s, double shape_squared) {
  if constexpr (function == RadialFunction::cubic) return s * s * s;
  if constexpr (function == RadialFunction::thin_plate) return s * s;
  return std::sqrt(s * s + shape_squared);
}

}  // namespace

double mean_edge_length(const surface::Mesh& mesh) {
  double sum = 0, count = 0;
  for (std::uint32_t f = 0; f < mesh.facet_count; ++f)
    for (int i = 0; i < 3; ++i) {
      const auto &a = mesh.vertices[mesh.corners[f][(i + 1) % 3]], &b = mesh.vertices[mesh.corners[f][(i + 2) % 3]];
      const double share = mesh.facets[f].neighbour[i] == surface::no_facet ? 1 : 0.5;  // an inner edge comes twice
      sum += share * std::hypot(b.x - a.x, b.y - a.y);
      count += share;
    }
  return sum / count;
}

template <RadialFunction function>
RadialFit<function> fit_radial(const surface::Mesh& mesh, const RadialOptions& options) {
  using Patches = RadialPatches<function>;
  RadialFit<function> fit;
  const double shape = options.shape_mm > 0 ? options.shape_mm : mean_edge_length(mesh);
  fit.shape_squared = function == RadialFunction::multiquadric ? shape * shape : 0;
  fit.patches.reserve(mesh.facet_count);
  const Neighbours neighbours(mesh);
  Rings rings(neighbours);
  Eigen::MatrixXd matrix;
  Eigen::VectorXd right;
  for (std::uint32_t f = 0; f < mesh.facet_count; ++f) {
    const surface::Corners& corner = mesh.corners[f];
    rings.start({corner[0], corner[1], corner[2]});
    for (int ring = 0; ring < options.rings; ++ring) rings.add_ring();
    const std::span<const std::uint32_t> nodes = rings.vertices();
    const auto count = static_cast<Eigen::Index>(nodes.size());
    fit.reaches_rim.push_back(std::any_of(nodes.begin(), nodes.end(), [&](std::uint32_t node) { return neighbours.is_on_rim(node); }));
    const auto& v0 = mesh.vertices[corner[0]];
    double scale = 0;
    for (const std::uint32_t node : nodes) scale = std::max(scale, std::hypot(mesh.vertices[node].x - v0.x, mesh.vertices[node].y - v0.y));
    const double phi_size = size_of<function>(scale, fit.shape_squared);
    matrix.setZero(count + 3, count + 3);
    right.setZero(count + 3);
    for (Eigen::Index i = 0; i < count; ++i) {
      const auto& p = mesh.vertices[nodes[static_cast<std::size_t>(i)]];
      for (Eigen::Index j = 0; j < i; ++j) {
        const auto& q = mesh.vertices[nodes[static_cast<std::size_t>(j)]];
        const double dx = p.x - q.x, dy = p.y - q.y;
        matrix(i, j) = matrix(j, i) = Patches::radial(dx * dx + dy * dy, fit.shape_squared).phi / phi_size;
      }
      matrix(i, i) = Patches::radial(0.0, fit.shape_squared).phi / phi_size;
      matrix(i, count) = matrix(count, i) = 1;
      matrix(i, count + 1) = matrix(count + 1, i) = (p.x - v0.x) / scale;
      matrix(i, count + 2) = matrix(count + 2, i) = (p.y - v0.y) / scale;
      right(i) = p.z - v0.z;
    }
    Eigen::VectorXd solution = Eigen::VectorXd::Zero(count + 3);
    const bool solved = count > 3;
    if (solved) {
      const Eigen::FullPivLU<Eigen::MatrixXd> lu(matrix);
      if (lu.isInvertible())
        solution = lu.solve(right);
      else
        solution = matrix.completeOrthogonalDecomposition().solve(right);
    }
    typename Patches::Patch patch{static_cast<std::uint32_t>(fit.nodes.size()), 0, v0.x, v0.y, v0.z, mesh.facets[f].slope_x, mesh.facets[f].slope_y};
    if (solved && solution.allFinite()) {
      patch.node_count = static_cast<std::uint32_t>(count);
      patch.a = v0.z + solution(count);
      patch.b = solution(count + 1) / scale;
      patch.c = solution(count + 2) / scale;
      fit.nodes.insert(fit.nodes.end(), nodes.begin(), nodes.end());
      for (Eigen::Index i = 0; i < count; ++i) fit.weights.push_back(solution(i) / phi_size);
    }
    fit.patches.push_back(patch);
  }
  return fit;
}

template RadialFit<RadialFunction::cubic> fit_radial(const surface::Mesh&, const RadialOptions&);
template RadialFit<RadialFunction::thin_plate> fit_radial(const surface::Mesh&, const RadialOptions&);
template RadialFit<RadialFunction::multiquadric> fit_radial(const surface::Mesh&, const RadialOptions&);

}  // namespace sagitta::scene
