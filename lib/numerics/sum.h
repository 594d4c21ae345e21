// SPDX-License-Identifier: Apache-2.0
// Sums in a fixed order with compensation: the same bits however many threads made the terms, and an error of about
// one rounding of the result for any number of terms.
//
// Source: Neumaier, Z. Angew. Math. Mech. 54, 39 (1974), algorithm IV.
#pragma once

#include <cmath>

namespace sagitta::numerics {

class Sum {
 public:
  void add(double term) {
    const double total = total_ + term;
    lost_ += std::abs(total_) >= std::abs(term) ? (total_ - total) + term : (term - total) + total_;
    total_ = total;
  }
  double value() const { return total_ + lost_; }

 private:
  double total_ = 0, lost_ = 0;
};

}  // namespace sagitta::numerics
