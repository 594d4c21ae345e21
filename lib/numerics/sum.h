// SPDX-License-Identifier: Apache-2.0
// Sums in a fixed order with compensation: the same bits however many threads made the terms, and an error of about
// one rounding of the result for any number of terms.
//
// Sources: Neumaier, Z. Angew. Math. Mech. 54, 39 (1974), algorithm IV; Knuth, The Art of Computer Programming 2, 4.2.2,
// theorem B, for an error of addition without a comparison.
#pragma once

#include <cmath>
#include <cstddef>

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

// The same for columns of terms: term i goes to sum i mod 8, so that a vector of any length adds them, with the same bits however
// the terms are divided into columns.
class ColumnSum {
 public:
  void add(const double* terms, std::size_t count) {
    std::size_t i = 0;
    for (; i < count && next_ != 0; ++i) add_one(terms[i]);
    for (; i + lanes <= count; i += lanes)
      for (std::size_t lane = 0; lane < lanes; ++lane) add_to(lane, terms[i + lane]);
    for (; i < count; ++i) add_one(terms[i]);
  }
  double value() const {
    Sum sum;
    for (const double total : total_) sum.add(total);
    for (const double lost : lost_) sum.add(lost);
    return sum.value();
  }

 private:
  static constexpr std::size_t lanes = 8;

  void add_one(double term) {
    add_to(next_, term);
    next_ = (next_ + 1) % lanes;
  }
  void add_to(std::size_t lane, double term) {
    const double total = total_[lane] + term, taken = total - total_[lane];
    lost_[lane] += (total_[lane] - (total - taken)) + (term - taken);
    total_[lane] = total;
  }

  double total_[lanes]{}, lost_[lanes]{};
  std::size_t next_ = 0;
};

}  // namespace sagitta::numerics
