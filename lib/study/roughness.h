// SPDX-License-Identifier: Apache-2.0
// A random height over (x, y), normal and of Gaussian correlation, known with its gradient at every place:
//
//   <h(p) h(p + r)> = s^2 exp(-r^2/l^2)                                                                             (1)
//   h(p) = s sqrt(2/M) sum_j cos(k_j . p + phase_j),   j = 0 ... M-1                                                (2)
//
// s   rms, mm      l   correlation length, mm (1/e of (1))      M   number of waves
//
// The spectrum of (1), s^2 l^2/(4 pi) exp(-k^2 l^2/4), is as a density that of a normal k with the variance 2/l^2 a component. k_j
// is drawn from it, phases uniformly: with k random and no grid of them (2) has no period, so that l may be 1 um or
// 1000 um over any aperture. The moduli are drawn one from each M-th of their distribution,
//   |k_j| = (2/l) sqrt(-ln((j + u_j)/M)),   u_j in (0, 1],                                                            (3)
// and the angles go on by the golden section, 2 pi (j (sqrt 5 - 1)/2 + v): each k_j has the distribution asked for, but
// together they fill it evenly. What one surface keeps of (1) over a large area, rms over 40 surfaces, 7 lags from l/4 to 2 l and 8
// directions, and of its mean square slope along x, 2 s^2/l^2:
//
//   M                          64      128     256     512     1000
//   correlation, of s^2        .0095   .0050   .0027   .0014   .0008    (k drawn independently: .55/sqrt(M), .034 at 256)
//   mean square slope          .056    .030    .017    .009    .005
//
// 256 are taken: a percent is below what ten seeds tell apart, and points and exact rays cost a cosine a wave.
//
// Errors: the rms of one surface over a large area is s but for the products of two waves, which vanish over many correlation
// areas. Heights are normal but for an excess kurtosis of -3/(2M). In double the phase k.p, up to some 1e5 in 12 mm at l = 1 um, is
// right to 1e-11.
//
// Source: spectral synthesis after Tsang, Kong, Ding and Ao, Scattering of Electromagnetic Waves: Numerical Simulations (2001),
// chapter 4, whose (1) this is, with random instead of gridded wave vectors. The golden sequence: Kuipers and Niederreiter,
// Uniform Distribution of Sequences (1974), chapter 2.3.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "lib/study/arrangement.h"
#include "lib/surface/departure.h"

namespace sagitta::study {

class Roughness {
 public:
  static constexpr int default_wave_count = 256;

  // rms >= 0, correlation_length > 0, wave_count >= 1.
  Roughness(double rms, double correlation_length, std::uint64_t seed, int wave_count = default_wave_count);

  // With (2)'s sum of |terms| as its magnitude, as surface/departure.h asks. The waves are taken as exact.
  template <class T>
  surface::Height<T> height(const T& x, const T& y) const {
    using std::cos, std::sin;
    T z(0), along_x(0), along_y(0);
    for (const Wave& wave : waves_) {
      const T phase = T(wave.x) * x + T(wave.y) * y + T(wave.phase), sine = sin(phase);
      z += cos(phase);
      along_x += T(wave.x) * sine;
      along_y += T(wave.y) * sine;
    }
    const T a(amplitude_);
    return {a * z, -a * along_x, -a * along_y, a * T(static_cast<double>(waves_.size()))};
  }

 private:
  friend std::vector<double> heights(const Roughness& roughness, std::span<const Site> sites, int thread_count);
  struct Wave {
    double x, y, phase;
  };
  std::vector<Wave> waves_;
  double amplitude_;
};

// The heights alone, at many places: the same numbers as height().z, for any thread count (0: as many as the machine runs).
std::vector<double> heights(const Roughness& roughness, std::span<const Site> sites, int thread_count = 1);

}  // namespace sagitta::study
