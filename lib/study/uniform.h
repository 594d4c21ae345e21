// SPDX-License-Identifier: Apache-2.0
// Uniform random numbers, the same on every machine for a seed: the upper 53 bits of std::mt19937_64, whose numbers the standard
// fixes (its distributions it leaves open).
//
// What a study draws comes from streams of its own: a cloud of the seed 3 must not stand where the rays of random:3 go, as both
// would be the same numbers from one generator. A stream's seed is mixed from both by the finaliser of SplitMix64.
//
// Source: Steele, Lea and Flood, Fast Splittable Pseudorandom Number Generators, OOPSLA 2014, figure 17.
#pragma once

#include <cstdint>
#include <random>

namespace sagitta::study {

enum class Stream : std::uint64_t { sites = 1, roughness = 2 };

class Uniform {
 public:
  explicit Uniform(std::uint64_t seed) : engine_(seed) {}
  Uniform(std::uint64_t seed, Stream stream) : engine_(mixed(seed + static_cast<std::uint64_t>(stream) * 0x9E3779B97F4A7C15u)) {}
  double operator()() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }  // in [0, 1)
  double operator()(double low, double high) { return low + (high - low) * (*this)(); }

 private:
  static std::uint64_t mixed(std::uint64_t z) {
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return z ^ (z >> 31);
  }

  std::mt19937_64 engine_;
};

}  // namespace sagitta::study
