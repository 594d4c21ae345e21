// SPDX-License-Identifier: Apache-2.0
#include "lib/scene/smooth.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/QR>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "lib/scene/cloud_fit.h"
#include "lib/scene/rings.h"

namespace sagitta::scene {
namespace {

using numerics::Vec3;
using surface::Mesh;
using Sparse = Eigen::SparseMatrix<double>;
using Vector = Eigen::VectorXd;

// b of the head comment.
Vector base_heights(const Mesh& mesh) {
  const std::vector<Vec3<double>> vertices(mesh.vertices, mesh.vertices + mesh.vertex_count);
  Vec3<double> mean{};
  for (const auto& v : vertices) mean = mean + (1.0 / mesh.vertex_count) * v;  // not the box's centre, which does not turn with the points
  const surface::BaseSphere sphere = fit_base_sphere(vertices, mean);
  Vector heights(mesh.vertex_count);
  for (std::uint32_t v = 0; v < mesh.vertex_count; ++v)
    heights(v) = mean.z + sphere.path(Vec3<double>{vertices[v].x - mean.x, vertices[v].y - mean.y, 0}, Vec3<double>{0, 0, 1});
  if (!heights.allFinite()) heights.setZero();
  return heights;
}

std::vector<double> vertex_areas(const Mesh& mesh) {
  std::vector<double> areas(mesh.vertex_count, 0.0);
  for (std::uint32_t f = 0; f < mesh.facet_count; ++f) {
    const auto& corner = mesh.corners[f];
    const Vec3<double> a = mesh.vertices[corner[1]] - mesh.vertices[corner[0]], b = mesh.vertices[corner[2]] - mesh.vertices[corner[0]];
    for (const std::uint32_t v : corner) areas[v] += std::abs(a.x * b.y - a.y * b.x) / 6;
  }
  return areas;
}

// The rows of second derivatives at the vertices, weighted so that the sum of their squares is the integral of (1).
class Roughness {
 public:
  explicit Roughness(const Mesh& mesh) : mesh_(mesh), neighbours_(mesh), rings_(neighbours_), areas_(vertex_areas(mesh)) {
    for (std::uint32_t v = 0; v < mesh.vertex_count; ++v) add_vertex(v);
  }
  // P of (3). Empty rows: vertices without second derivatives.
  Sparse matrix() const {
    Sparse rows(row_count_, mesh_.vertex_count);
    rows.setFromTriplets(entries_.begin(), entries_.end());
    return Sparse(rows.transpose()) * rows;
  }

 private:
  void add_vertex(std::uint32_t vertex) {
    constexpr std::size_t most_points = 300;
    rings_.start({vertex});
    rings_.add_ring();
    while (!add_rows(vertex)) {
      const std::size_t before = rings_.vertices().size();
      if (before >= most_points) return;
      rings_.add_ring();
      if (rings_.vertices().size() == before) return;
    }
  }

  // False where the points do not determine a quadratic.
  bool add_rows(std::uint32_t vertex) {
    const std::span<const std::uint32_t> around = rings_.vertices();  // the vertex itself is the first
    const auto count = static_cast<Eigen::Index>(around.size() - 1);
    if (count < 5) return false;
    // In the principal axes of the points around, so that neither rings at 45 degrees nor a turn of the whole change what
    // is determined; (1) is the same in all axes.
    Eigen::Matrix<double, Eigen::Dynamic, 2> place(count, 2);
    for (Eigen::Index row = 0; row < count; ++row) {
      const Vec3<double> q = mesh_.vertices[around[static_cast<std::size_t>(row) + 1]] - mesh_.vertices[vertex];
      place.row(row) << q.x, q.y;
    }
    const double scale = place.cwiseAbs().maxCoeff();
    place /= scale;
    const Eigen::Matrix2d moments = place.transpose() * place;
    const double turn = 0.5 * std::atan2(2 * moments(0, 1), moments(0, 0) - moments(1, 1));
    place = place * Eigen::Rotation2Dd(turn).toRotationMatrix();
    Eigen::Matrix<double, Eigen::Dynamic, 5> used(count, 5);
    used << place, place.col(0).cwiseAbs2(), place.col(0).cwiseProduct(place.col(1)), place.col(1).cwiseAbs2();
    const Eigen::Array<double, 5, 1> size = used.colwise().norm().cwiseMax(1e-300);
    used = used * size.inverse().matrix().asDiagonal();
    Eigen::ColPivHouseholderQR<Eigen::Matrix<double, Eigen::Dynamic, 5>> qr(used);
    qr.setThreshold(1e-3);
    if (qr.rank() < 5) return false;
    // The coefficients of the quadratic are (its pseudo-inverse) times the differences from the vertex's own departure.
    const Eigen::Matrix<double, 5, Eigen::Dynamic> inverse = qr.solve(Eigen::MatrixXd::Identity(count, count));
    const double root_area = std::sqrt(areas_[vertex]);
    constexpr std::array<double, 3> factor{2, std::numbers::sqrt2, 2};  // d_xx = 2 c_XX; sqrt(2) d_xy = sqrt(2) c_XY; d_yy
    for (Eigen::Index i = 0; i < 3; ++i) {
      const double weight = root_area * factor[static_cast<std::size_t>(i)] / (size(2 + i) * scale * scale);
      double sum = 0;
      for (Eigen::Index k = 0; k < count; ++k) {
        const double entry = weight * inverse(2 + i, k);
        entries_.emplace_back(row_count_, static_cast<int>(around[static_cast<std::size_t>(k) + 1]), entry);
        sum += entry;
      }
      entries_.emplace_back(row_count_++, static_cast<int>(vertex), -sum);
    }
    return true;
  }

  const Mesh& mesh_;
  Neighbours neighbours_;
  Rings rings_;
  std::vector<double> areas_;
  std::vector<Eigen::Triplet<double>> entries_;
  int row_count_ = 0;
};

// The limit of (3): the plane of least squares on every connected piece, and the departure itself on pieces that P does
// not see.
Vector limit_of(const Mesh& mesh, const Sparse& roughness, const Vector& departure) {
  Vector limit = departure;
  const Vector diagonal = roughness.diagonal();
  const Neighbours neighbours(mesh);
  Rings piece(neighbours);
  std::vector<char> done(mesh.vertex_count, false);
  for (std::uint32_t first = 0; first < mesh.vertex_count; ++first) {
    if (done[first]) continue;
    piece.start({first});
    for (std::size_t before = 0; before < piece.vertices().size(); piece.add_ring()) before = piece.vertices().size();
    const std::span<const std::uint32_t> vertices = piece.vertices();
    for (const std::uint32_t v : vertices) done[v] = true;
    if (std::none_of(vertices.begin(), vertices.end(), [&](std::uint32_t v) { return diagonal(v) > 0; })) continue;
    const auto count = static_cast<Eigen::Index>(vertices.size());
    Eigen::MatrixXd plane(count, 3);
    Vector right(count);
    double scale = 0;
    for (const std::uint32_t v : vertices) scale = std::max(scale, std::hypot(mesh.vertices[v].x - mesh.vertices[first].x, mesh.vertices[v].y - mesh.vertices[first].y));
    for (Eigen::Index k = 0; k < count; ++k) {
      const Vec3<double> q = mesh.vertices[vertices[static_cast<std::size_t>(k)]] - mesh.vertices[first];
      plane.row(k) << 1, q.x / scale, q.y / scale;
      right(k) = departure(vertices[static_cast<std::size_t>(k)]);
    }
    const Vector fitted = plane * Vector(plane.colPivHouseholderQr().solve(right));
    for (Eigen::Index k = 0; k < count; ++k) limit(vertices[static_cast<std::size_t>(k)]) = fitted(k);
  }
  return limit;
}

double rms_of(const Vector& residual) { return residual.norm() / std::sqrt(static_cast<double>(residual.size())); }

using Solver = Eigen::SimplicialLDLT<Sparse>;

// The rms (2) as a function of k = lambda/lambda0, from the decomposition at lambda0: (4).
class RmsNearby {
 public:
  RmsNearby(const Solver& at_lambda0, const Vector& y) : rms_of_y_(rms_of(y)) {
    constexpr Eigen::Index most_nodes = 25;
    Eigen::MatrixXd basis(y.size(), most_nodes);
    Vector diagonal(most_nodes), beside(most_nodes);
    basis.col(0) = y.normalized();
    Eigen::Index count = 0;
    while (count < most_nodes) {
      Vector next = at_lambda0.solve(basis.col(count));
      diagonal(count) = basis.col(count).dot(next);
      for (int twice = 0; twice < 2; ++twice) next -= basis.leftCols(count + 1) * (basis.leftCols(count + 1).transpose() * next);
      beside(count) = next.norm();
      if (++count == most_nodes || !(beside(count - 1) > 1e-14)) break;
      basis.col(count) = next / beside(count - 1);
    }
    Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen;
    eigen.computeFromTridiagonal(diagonal.head(count), beside.head(count - 1));
    nodes_ = eigen.eigenvalues().cwiseMax(0).cwiseMin(1);
    weights_ = eigen.eigenvectors().row(0).array().square();
  }
  double operator()(double k) const {
    const Eigen::ArrayXd lost = k * (1 - nodes_);
    return rms_of_y_ * std::sqrt((weights_ * (lost / (nodes_ + lost)).square()).sum());
  }

 private:
  double rms_of_y_;
  Eigen::ArrayXd nodes_, weights_;
};

}  // namespace

std::optional<SmoothedHeights> smooth(const Mesh& mesh, double rms) {
  const Eigen::Map<const Eigen::VectorXd, 0, Eigen::InnerStride<3>> measured(&mesh.vertices[0].z, mesh.vertex_count);
  const Vector base = base_heights(mesh), departure = measured - base;
  const Sparse P = Roughness(mesh).matrix();
  const Vector limit = limit_of(mesh, P, departure);

  // Without its limit, which no lambda moves, the departure keeps its digits where lambda is large.
  const Vector moving = departure - limit;
  const auto result = [&](const Vector& moved, double lambda) {
    const Vector smoothed = base + (limit + moved), residual = smoothed - measured;
    return SmoothedHeights{{smoothed.begin(), smoothed.end()}, {rms, rms_of(residual), residual.cwiseAbs().maxCoeff(), lambda}};
  };
  if (!(rms < rms_of(moving))) return result(Vector::Zero(moving.size()), std::numeric_limits<double>::infinity());

  Sparse identity(P.rows(), P.cols());
  identity.setIdentity();
  Solver solver;
  solver.analyzePattern(identity + P);
  // To begin with, between the stiffest mode (1/lambda the largest entry of P) and the softest (a bow of the whole).
  double t = 0.5 * (std::log(mesh.vertex_count * 8 * mesh.extent * mesh.extent) - std::log(P.diagonal().maxCoeff()));
  Vector best;
  double best_lambda = 0, best_fault = std::numeric_limits<double>::infinity();
  constexpr int most_steps = 20;
  for (int step = 0; step < most_steps; ++step) {
    const double lambda = std::exp(t);
    solver.factorize(identity + lambda * P);
    if (solver.info() != Eigen::Success) return std::nullopt;
    const Vector moved = solver.solve(moving);
    const double fault = std::abs(std::log(rms_of(moved - moving) / rms));
    if (!std::isfinite(fault)) return std::nullopt;
    if (fault < best_fault) best = moved, best_lambda = lambda, best_fault = fault;
    if (best_fault < 1e-6) break;
    const RmsNearby rms_nearby(solver, moving);
    double low = -15, high = 15;  // of log k: further away the quadrature tells nothing
    while (high - low > 1e-9) {
      const double middle = 0.5 * (low + high);
      (rms_nearby(std::exp(middle)) < rms ? low : high) = middle;
    }
    t += low;
  }
  return result(best, best_lambda);
}

}  // namespace sagitta::scene
