// SPDX-License-Identifier: Apache-2.0
#include "lib/scene/fit_patches.h"

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>

#include "lib/scene/rings.h"

namespace sagitta::scene {
namespace {

using numerics::Vec3;
using surface::CloughTocherPatch;
using surface::Facet;
using surface::Mesh;
using surface::no_facet;

constexpr int cubic_terms = 9;
// X, Y, X^2, XY, Y^2, X^3, X^2 Y, X Y^2, Y^3
using Polynomial = std::array<double, cubic_terms>;

CloughTocherPatch::Slope gradient(const Polynomial& c, double X, double Y) {
  return {c[0] + 2 * c[2] * X + c[3] * Y + 3 * c[5] * X * X + 2 * c[6] * X * Y + c[7] * Y * Y,
          c[1] + c[3] * X + 2 * c[4] * Y + c[6] * X * X + 2 * c[7] * X * Y + 3 * c[8] * Y * Y};
}

class VertexFit {
 public:
  explicit VertexFit(const Mesh& mesh) : mesh_(mesh), rings_(mesh) {}

  Polynomial at(std::uint32_t vertex) {
    rings_.start({vertex});
    rings_.add_ring();
    rings_.add_ring();
    constexpr std::size_t most_points = 300;
    for (;;) {
      Polynomial result{};
      if (solve(vertex, cubic_terms, result)) return result;
      const std::size_t before = rings_.vertices().size();
      if (before < most_points) rings_.add_ring();
      if (rings_.vertices().size() > before) continue;
      if (solve(vertex, 5, result) || solve(vertex, 2, result)) return result;
      return {};
    }
  }

 private:
  bool solve(std::uint32_t vertex, int terms, Polynomial& result) {
    const std::vector<std::uint32_t>& around = rings_.vertices();  // the vertex itself is the first
    const auto count = static_cast<Eigen::Index>(around.size() - 1);
    if (count < terms) return false;
    const Vec3<double> v = mesh_.vertices[vertex];
    double scale = 0;
    for (const std::uint32_t i : around) scale = std::max(scale, std::hypot(mesh_.vertices[i].x - v.x, mesh_.vertices[i].y - v.y));
    matrix_.resize(count, cubic_terms);
    right_.resize(count);
    for (Eigen::Index row = 0; row < count; ++row) {
      const Vec3<double> q = mesh_.vertices[around[static_cast<std::size_t>(row) + 1]] - v;
      const double X = q.x / scale, Y = q.y / scale;
      matrix_.row(row) << X, Y, X * X, X * Y, Y * Y, X * X * X, X * X * Y, X * Y * Y, Y * Y * Y;
      right_(row) = q.z;
    }
    Eigen::MatrixXd used = matrix_.leftCols(terms);
    Eigen::VectorXd size = used.colwise().norm().cwiseMax(1e-300);
    used = used * size.cwiseInverse().asDiagonal();
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(used);
    qr.setThreshold(1e-3);
    if (qr.rank() < terms) return false;
    const Eigen::VectorXd solution = size.cwiseInverse().asDiagonal() * qr.solve(right_);
    constexpr std::array<int, cubic_terms> degree{1, 1, 2, 2, 2, 3, 3, 3, 3};
    for (int i = 0; i < terms; ++i) result[static_cast<std::size_t>(i)] = solution(i) / std::pow(scale, degree[static_cast<std::size_t>(i)]);
    return true;
  }

  const Mesh& mesh_;
  Rings rings_;
  Eigen::Matrix<double, Eigen::Dynamic, cubic_terms> matrix_;
  Eigen::VectorXd right_;
};

}  // namespace

std::vector<CloughTocherPatch> fit_patches(const Mesh& mesh) {
  std::vector<Polynomial> fits(mesh.vertex_count);
  VertexFit fit(mesh);
  for (std::uint32_t v = 0; v < mesh.vertex_count; ++v) fits[v] = fit.at(v);

  std::vector<CloughTocherPatch> patches;
  patches.reserve(mesh.facet_count);
  for (std::uint32_t f = 0; f < mesh.facet_count; ++f) {
    const surface::Corners& corner = mesh.corners[f];
    CloughTocherPatch::Corner corners[3];
    CloughTocherPatch::Slope slopes[3];
    for (int i = 0; i < 3; ++i) {
      const std::uint32_t v = corner[i];
      corners[i] = {mesh.vertices[v], fits[v][0], fits[v][1]};
      // both facets of the edge take its ends in the same order, so their slopes have the same bits
      const auto [a, b] = std::minmax(corner[(i + 1) % 3], corner[(i + 2) % 3]);
      const double X = (mesh.vertices[b].x - mesh.vertices[a].x) / 2, Y = (mesh.vertices[b].y - mesh.vertices[a].y) / 2;
      const auto from_a = gradient(fits[a], X, Y), from_b = gradient(fits[b], -X, -Y);
      slopes[i] = {(from_a.x + from_b.x) / 2, (from_a.y + from_b.y) / 2};
    }
    patches.push_back(CloughTocherPatch::of(corners, slopes));
  }
  return patches;
}

}  // namespace sagitta::scene
