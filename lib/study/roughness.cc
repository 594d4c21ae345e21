// SPDX-License-Identifier: Apache-2.0
#include "lib/study/roughness.h"

#include <algorithm>
#include <numbers>

#include "lib/numerics/parallel.h"
#include "lib/study/uniform.h"

namespace sagitta::study {

Roughness::Roughness(double rms, double correlation_length, std::uint64_t seed, int wave_count) : amplitude_(rms * std::sqrt(2.0 / wave_count)) {
  constexpr double turn = 2 * std::numbers::pi, golden = std::numbers::phi - 1;
  Uniform u(seed, Stream::roughness);
  const double first_angle = u();
  for (int j = 0; j < wave_count; ++j) {
    const double modulus = 2 / correlation_length * std::sqrt(-std::log((j + 1 - u()) / wave_count));  // (3)
    const double angle = turn * (first_angle + j * golden), phase = turn * u();
    waves_.push_back({modulus * std::cos(angle), modulus * std::sin(angle), phase});
  }
}

std::vector<double> heights(const Roughness& roughness, std::span<const Site> sites, int thread_count) {
  constexpr std::size_t block_size = 1024;
  std::vector<double> result(sites.size());
  numerics::share_blocks((sites.size() + block_size - 1) / block_size, thread_count, [&] {
    return [&](std::size_t block) {
      for (std::size_t i = block * block_size; i < std::min(sites.size(), (block + 1) * block_size); ++i) {
        double z = 0;
        for (const auto& wave : roughness.waves_) z += std::cos(wave.x * sites[i].x + wave.y * sites[i].y + wave.phase);
        result[i] = roughness.amplitude_ * z;
      }
    };
  });
  return result;
}

}  // namespace sagitta::study
