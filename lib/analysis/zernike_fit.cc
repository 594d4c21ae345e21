// SPDX-License-Identifier: Apache-2.0
#include "lib/analysis/zernike_fit.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "lib/numerics/sum.h"

namespace sagitta::analysis {

// Of the matrix with a row for each sample and a column for each term.
struct ZernikeFitter::Factors {
  std::vector<Sample> samples;  // at these places
  Eigen::MatrixXd basis;
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr;

  Factors(std::span<const Sample> places, numerics::ZernikeIndexing indexing, int term_count)
      : samples(places.begin(), places.end()), basis(places.size(), term_count) {
    const int first = numerics::first_zernike_index(indexing);
    for (int j = 0; j < term_count; ++j) {
      const numerics::ZernikeTerm term = numerics::zernike_term(indexing, first + j);
      Eigen::Index i = 0;
      for (const Sample& place : places) basis(i++, j) = numerics::zernike_value(indexing, term, place.x, place.y);
    }
    qr.compute(basis);
  }
  bool stand_at(std::span<const Sample> places) const {
    return std::equal(samples.begin(), samples.end(), places.begin(), places.end(),
                      [](const Sample& a, const Sample& b) { return a.x == b.x && a.y == b.y; });
  }
};

ZernikeFitter::ZernikeFitter(numerics::ZernikeIndexing indexing, int term_count) : indexing_(indexing), term_count_(term_count) {}
ZernikeFitter::~ZernikeFitter() = default;

std::optional<ZernikeFit> ZernikeFitter::fit(std::span<const Sample> samples) {
  if (samples.size() < static_cast<std::size_t>(term_count_)) return std::nullopt;
  if (!factors_ || !factors_->stand_at(samples)) factors_ = std::make_unique<const Factors>(samples, indexing_, term_count_);
  if (factors_->qr.rank() < term_count_) return std::nullopt;
  Eigen::VectorXd values(factors_->basis.rows());
  for (Eigen::Index i = 0; const Sample& sample : samples) values(i++) = sample.value;
  const Eigen::VectorXd solution = factors_->qr.solve(values);
  const Eigen::VectorXd residual = values - factors_->basis * solution;

  ZernikeFit fit{indexing_, std::vector<double>(solution.begin(), solution.end())};
  numerics::Sum squares;
  for (const double r : residual) squares.add(r * r);
  fit.residual_rms = std::sqrt(squares.value() / static_cast<double>(samples.size()));
  return fit;
}

}  // namespace sagitta::analysis
