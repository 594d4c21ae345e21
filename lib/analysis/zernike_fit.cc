// SPDX-License-Identifier: Apache-2.0
#include "lib/analysis/zernike_fit.h"

#include <Eigen/QR>
#include <cmath>

#include "lib/numerics/sum.h"

namespace sagitta::analysis {

std::optional<ZernikeFit> fit_zernike(std::span<const Sample> samples, numerics::ZernikeIndexing indexing, int term_count) {
  const auto sample_count = static_cast<Eigen::Index>(samples.size());
  if (sample_count < term_count) return std::nullopt;
  Eigen::MatrixXd basis(sample_count, term_count);
  Eigen::VectorXd values(sample_count);
  const int first = numerics::first_zernike_index(indexing);
  for (int j = 0; j < term_count; ++j) {
    const numerics::ZernikeTerm term = numerics::zernike_term(indexing, first + j);
    for (Eigen::Index i = 0; i < sample_count; ++i) {
      const Sample& sample = samples[static_cast<std::size_t>(i)];
      basis(i, j) = numerics::zernike_value(indexing, term, sample.x, sample.y);
    }
  }
  for (Eigen::Index i = 0; i < sample_count; ++i) values(i) = samples[static_cast<std::size_t>(i)].value;

  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(basis);
  if (qr.rank() < term_count) return std::nullopt;
  const Eigen::VectorXd solution = qr.solve(values);
  const Eigen::VectorXd residual = values - basis * solution;

  ZernikeFit fit{indexing, std::vector<double>(solution.begin(), solution.end())};
  numerics::Sum squares;
  for (const double r : residual) squares.add(r * r);
  fit.residual_rms = std::sqrt(squares.value() / static_cast<double>(sample_count));
  return fit;
}

}  // namespace sagitta::analysis
