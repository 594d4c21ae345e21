// SPDX-License-Identifier: Apache-2.0
// Linear least squares in bounded memory: rows are added in blocks, each block reduced with what came before to a
// triangle (Householder QR), so a million rows need no more room than a few hundred. Never the normal equations, which
// square the condition number.
#pragma once

#include <Eigen/QR>
#include <algorithm>
#include <limits>
#include <optional>

namespace sagitta::scene {

class LeastSquares {
 public:
  explicit LeastSquares(Eigen::Index terms)
      : terms_(terms), block_(Eigen::MatrixXd::Zero(std::max<Eigen::Index>(512, 4 * (terms + 1)), terms + 1)) {}

  // The next row, to be filled: `terms` values and the right side.
  auto next_row() {
    if (filled_ == block_.rows()) reduce();
    return block_.row(filled_++);
  }

  // None unless the rows determine every coefficient: to 1e-6 of the largest one after scaling of the columns.
  std::optional<Eigen::VectorXd> solve() const {
    if (filled_ < terms_) return std::nullopt;
    const Eigen::VectorXd scale = column_scale();
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(scaled_matrix());
    qr.setThreshold(1e-6);
    if (qr.rank() < terms_) return std::nullopt;
    Eigen::VectorXd solution = scale.asDiagonal() * qr.solve(block_.col(terms_).head(filled_));
    if (!solution.allFinite()) return std::nullopt;
    return solution;
  }

  // A matrix with the singular values of all rows' matrix, its columns scaled to length 1.
  Eigen::MatrixXd scaled_matrix() const { return block_.topLeftCorner(filled_, terms_) * column_scale().asDiagonal(); }

 private:
  Eigen::VectorXd column_scale() const {
    return block_.topLeftCorner(filled_, terms_).colwise().norm().cwiseMax(std::numeric_limits<double>::min()).cwiseInverse();
  }

  void reduce() {
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(block_.topRows(filled_));
    const Eigen::Index kept = terms_ + 1;
    block_.topRows(kept) = qr.matrixQR().topRows(kept).triangularView<Eigen::Upper>();
    filled_ = kept;
  }

  Eigen::Index terms_, filled_ = 0;
  Eigen::MatrixXd block_;
};

}  // namespace sagitta::scene
