// SPDX-License-Identifier: Apache-2.0
// A compensated sum of many terms in vectors (numerics/sum.h tells its error): term i goes to sum i mod 8, which is one of a
// vector of any length, so that the bits are those of every instruction set.
//
// Source: Knuth, The Art of Computer Programming 2, 4.2.2, theorem B: an error of addition without a comparison.
#pragma once

#include <cstddef>

#include "lib/numerics/lanes.h"
#include "lib/numerics/sum.h"

namespace sagitta::numerics {

class ColumnSum {
 public:
  static constexpr std::size_t columns = 8;

  // `count`, a multiple of 8, terms in vectors of n. A term of 0 changes nothing.
  template <int n>
  void add(const double* terms, std::size_t count) {
    using Vector = Lanes<n>;
    constexpr std::size_t vectors = columns / n;
    Vector total[vectors], lost[vectors];
    for (std::size_t k = 0; k < vectors; ++k) total[k] = Vector::load(total_ + k * n), lost[k] = Vector::load(lost_ + k * n);
    for (std::size_t i = 0; i < count; i += columns)
      for (std::size_t k = 0; k < vectors; ++k) {
        const Vector term = Vector::load(terms + i + k * n), sum = total[k] + term, taken = sum - total[k];
        lost[k] = lost[k] + ((total[k] - (sum - taken)) + (term - taken));
        total[k] = sum;
      }
    for (std::size_t k = 0; k < vectors; ++k) total[k].store(total_ + k * n), lost[k].store(lost_ + k * n);
  }

  double value() const {
    Sum sum;
    for (const double total : total_) sum.add(total);
    for (const double lost : lost_) sum.add(lost);
    return sum.value();
  }

 private:
  double total_[columns]{}, lost_[columns]{};
};

}  // namespace sagitta::numerics
