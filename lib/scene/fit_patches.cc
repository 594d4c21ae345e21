// SPDX-License-Identifier: Apache-2.0
#include "lib/scene/fit_patches.h"

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <span>

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

// The vertices that share an edge with each vertex, as lists end to end.
class Neighbours {
 public:
  explicit Neighbours(const Mesh& mesh) : begin_(mesh.vertex_count + 1, 0) {
    const auto for_each_edge = [&](auto&& take) {
      for (std::uint32_t f = 0; f < mesh.facet_count; ++f)
        for (int i = 0; i < 3; ++i) {
          // every edge once: by the facet of the lower number, or by its only one
          const std::uint32_t other = mesh.facets[f].neighbour[i];
          if (other != no_facet && other < f) continue;
          take(mesh.facets[f].corner[(i + 1) % 3], mesh.facets[f].corner[(i + 2) % 3]);
        }
    };
    for_each_edge([&](std::uint32_t a, std::uint32_t b) { ++begin_[a + 1], ++begin_[b + 1]; });
    for (std::size_t i = 1; i < begin_.size(); ++i) begin_[i] += begin_[i - 1];
    list_.resize(begin_.back());
    std::vector<std::uint32_t> filled(begin_.begin(), begin_.end() - 1);
    for_each_edge([&](std::uint32_t a, std::uint32_t b) { list_[filled[a]++] = b, list_[filled[b]++] = a; });
  }
  std::span<const std::uint32_t> of(std::uint32_t vertex) const {
    return {list_.data() + begin_[vertex], begin_[vertex + 1] - begin_[vertex]};
  }

 private:
  std::vector<std::uint32_t> begin_, list_;
};

class VertexFit {
 public:
  explicit VertexFit(const Mesh& mesh) : mesh_(mesh), neighbours_(mesh), seen_(mesh.vertex_count, no_facet) {}

  Polynomial at(std::uint32_t vertex) {
    rings_ = {vertex};
    seen_[vertex] = vertex;
    ring_begin_ = 0;
    add_ring(vertex);
    add_ring(vertex);
    constexpr std::size_t most_points = 300;
    for (;;) {
      Polynomial result{};
      if (solve(vertex, cubic_terms, result)) return result;
      const std::size_t before = rings_.size();
      if (before < most_points) add_ring(vertex);
      if (rings_.size() > before) continue;
      if (solve(vertex, 5, result) || solve(vertex, 2, result)) return result;
      return {};
    }
  }

 private:
  void add_ring(std::uint32_t vertex) {
    const std::size_t end = rings_.size();
    for (; ring_begin_ < end; ++ring_begin_)
      for (const std::uint32_t next : neighbours_.of(rings_[ring_begin_]))
        if (seen_[next] != vertex) {
          seen_[next] = vertex;
          rings_.push_back(next);
        }
  }

  bool solve(std::uint32_t vertex, int terms, Polynomial& result) {
    const auto count = static_cast<Eigen::Index>(rings_.size() - 1);
    if (count < terms) return false;
    const Vec3<double> v = mesh_.vertices[vertex];
    double scale = 0;
    for (const std::uint32_t i : rings_) scale = std::max(scale, std::hypot(mesh_.vertices[i].x - v.x, mesh_.vertices[i].y - v.y));
    matrix_.resize(count, cubic_terms);
    right_.resize(count);
    for (Eigen::Index row = 0; row < count; ++row) {
      const Vec3<double> q = mesh_.vertices[rings_[static_cast<std::size_t>(row) + 1]] - v;
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
  Neighbours neighbours_;
  std::vector<std::uint32_t> seen_;   // the vertex for which it was reached last
  std::vector<std::uint32_t> rings_;  // the vertex, then ring by ring
  std::size_t ring_begin_ = 0;        // where the last ring begins
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
    const Facet& facet = mesh.facets[f];
    CloughTocherPatch::Corner corners[3];
    CloughTocherPatch::Slope slopes[3];
    for (int i = 0; i < 3; ++i) {
      const std::uint32_t v = facet.corner[i];
      corners[i] = {mesh.vertices[v], fits[v][0], fits[v][1]};
      // both facets of the edge take its ends in the same order, so their slopes have the same bits
      const auto [a, b] = std::minmax(facet.corner[(i + 1) % 3], facet.corner[(i + 2) % 3]);
      const double X = (mesh.vertices[b].x - mesh.vertices[a].x) / 2, Y = (mesh.vertices[b].y - mesh.vertices[a].y) / 2;
      const auto from_a = gradient(fits[a], X, Y), from_b = gradient(fits[b], -X, -Y);
      slopes[i] = {(from_a.x + from_b.x) / 2, (from_a.y + from_b.y) / 2};
    }
    patches.push_back(CloughTocherPatch::of(corners, slopes));
  }
  return patches;
}

}  // namespace sagitta::scene
