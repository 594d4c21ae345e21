// SPDX-License-Identifier: Apache-2.0
// Uniform random numbers, the same on every machine for a seed: the upper 53 bits of std::mt19937_64, whose numbers the standard
// fixes (its distributions it leaves open).
#pragma once

#include <cstdint>
#include <random>

namespace sagitta::study {

class Uniform {
 public:
  explicit Uniform(std::uint64_t seed) : engine_(seed) {}
  double operator()() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }  // in [0, 1)
  double operator()(double low, double high) { return low + (high - low) * (*this)(); }

 private:
  std::mt19937_64 engine_;
};

}  // namespace sagitta::study
