// SPDX-License-Identifier: Apache-2.0
// Least-squares fit of Zernike polynomials to scattered samples over the unit disc (numerics/zernike_basis.h).
//
// min_c sum_i (w_i - sum_j c_j Z_j(x_i, y_i))^2 by Householder QR with column pivoting, which tells the rank: terms that the
// samples cannot tell apart are a fault, not a guess. With all the samples of a full disc the coefficients are close to the
// inner products; behind a central obscuration they are not orthogonal, and the rms of the wavefront must not be taken
// from them.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "lib/numerics/zernike_basis.h"

namespace sagitta::analysis {

struct Sample {
  double x, y;   // unit disc
  double value;
};

struct ZernikeFit {
  numerics::ZernikeIndexing indexing = numerics::ZernikeIndexing::osa;
  std::vector<double> coefficients;  // from the indexing's first index on, in the samples' unit
  double residual_rms = 0;           // sqrt(mean (w - fit)^2)
};

// Fits one after another. Samples at the same places as the last ones, as those of other wavelengths are, cost a tenth: the
// factors of their matrix are kept, and the results have the same bits.
class ZernikeFitter {
 public:
  ZernikeFitter(numerics::ZernikeIndexing indexing, int term_count);
  ~ZernikeFitter();

  // None where there are fewer samples than terms, or the samples do not determine every term.
  std::optional<ZernikeFit> fit(std::span<const Sample> samples);

 private:
  struct Factors;
  numerics::ZernikeIndexing indexing_;
  int term_count_;
  std::unique_ptr<const Factors> factors_;
};

}  // namespace sagitta::analysis
