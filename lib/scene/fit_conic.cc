// SPDX-License-Identifier: Apache-2.0
#include "lib/scene/fit_conic.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "lib/numerics/sum.h"
#include "lib/scene/least_squares_internal.h"

namespace sagitta::scene {
namespace {

using Points = std::span<const numerics::Vec3<double>>;

double u_of(const numerics::Vec3<double>& p) { return p.x * p.x + p.y * p.y; }

// The two models (1): the height at u over the vertex, and its derivatives by c and, for the conic, q.
struct Sphere {
  static constexpr Eigen::Index size = 2;  // z0, c
  static double height(const Eigen::VectorXd& at, double u) { return at(1) * u / (1 + std::sqrt(1 - at(1) * at(1) * u)); }
  template <class Row>
  static void fill_derivatives(const Eigen::VectorXd& at, double u, Row&& row) {
    const double s = std::sqrt(1 - at(1) * at(1) * u);
    row(1) = u / (s * (1 + s));  // (2)
  }
};

struct ConicInQ {
  static constexpr Eigen::Index size = 3;  // z0, c, q
  static double height(const Eigen::VectorXd& at, double u) { return at(1) * u / (1 + std::sqrt(1 - at(2) * u)); }
  template <class Row>
  static void fill_derivatives(const Eigen::VectorXd& at, double u, Row&& row) {
    const double s = std::sqrt(1 - at(2) * u);
    row(1) = u / (1 + s);  // (2)
    row(2) = at(1) * u * u / (2 * s * (1 + s) * (1 + s));
  }
};

// NaN where the model does not reach every point.
template <class Model>
double sum_of_squares(Points points, const Eigen::VectorXd& at) {
  numerics::Sum sum;
  for (const auto& p : points) {
    const double difference = p.z - at(0) - Model::height(at, u_of(p));
    sum.add(difference * difference);
  }
  return sum.value();
}

template <class Model>
std::optional<Eigen::VectorXd> gauss_newton_step(Points points, const Eigen::VectorXd& at) {
  LeastSquares fit(Model::size);
  for (const auto& p : points) {
    auto row = fit.next_row();
    row(0) = 1;
    Model::fill_derivatives(at, u_of(p), row);
    row(Model::size) = p.z - at(0) - Model::height(at, u_of(p));
  }
  return fit.solve();
}

// From `at` downhill to the least sum of squares; none where a step is not determined.
template <class Model>
std::optional<FittedConic> minimise(Points points, Eigen::VectorXd at, double u_max) {
  constexpr int most_steps = 100, most_halvings = 50;
  // What a parameter moves the height by at the rim, to compare steps by.
  const Eigen::VectorXd rim = Eigen::Vector3d(1, u_max / 2, u_max * u_max / 8 * std::abs(at(1))).head(Model::size);
  double least = sum_of_squares<Model>(points, at);
  if (!std::isfinite(least)) return std::nullopt;
  for (int steps = 0; steps < most_steps; ++steps) {
    auto step = gauss_newton_step<Model>(points, at);
    if (!step) return std::nullopt;
    double sum = 0;
    int halvings = 0;
    for (; halvings < most_halvings; ++halvings, *step /= 2) {
      sum = sum_of_squares<Model>(points, at + *step);
      if (sum <= least) break;  // false for NaN
    }
    if (halvings == most_halvings) break;
    at += *step;
    least = sum;
    if (step->cwiseProduct(rim).cwiseAbs().maxCoeff() <= 1e-15 * at.cwiseProduct(rim).cwiseAbs().maxCoeff()) break;
  }
  double c = at(1);
  if (!(c * c * u_max >= 1e-16)) c = 0;
  double K = 0;
  if constexpr (Model::size == 3) K = c == 0 ? 0 : at(2) / (c * c) - 1;
  return FittedConic{at(0), {c, K}, std::sqrt(least / static_cast<double>(points.size()))};
}

// The parabola z0 + c u/2, as (z0, c).
std::optional<Eigen::VectorXd> parabola(Points points) {
  LeastSquares fit(2);
  for (const auto& p : points) fit.next_row() << 1, u_of(p) / 2, p.z;
  return fit.solve();
}

}  // namespace

std::optional<BestFits> fit_sphere_and_conic(Points points) {
  double u_max = 0;
  for (const auto& p : points) u_max = std::max(u_max, u_of(p));
  if (!(u_max > 0) || !std::isfinite(u_max)) return std::nullopt;

  auto start = parabola(points);
  if (!start) return std::nullopt;
  const double steepest = 0.9 / std::sqrt(u_max);  // a sphere reaches the rim only below c^2 u_max = 1
  (*start)(1) = std::clamp((*start)(1), -steepest, steepest);
  const auto sphere = minimise<Sphere>(points, *start, u_max);
  if (!sphere) return std::nullopt;

  BestFits result{*sphere, *sphere};
  const double c = sphere->conic.curvature;
  const auto conic = minimise<ConicInQ>(points, Eigen::Vector3d(sphere->vertex_z, c, c * c), u_max);
  if (conic && std::abs(conic->conic.conic_constant) <= 100) result = {*sphere, *conic, false};
  return result;
}

}  // namespace sagitta::scene
