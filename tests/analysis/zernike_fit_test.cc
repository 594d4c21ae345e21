// SPDX-License-Identifier: Apache-2.0
#include "lib/analysis/zernike_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace sagitta::analysis {
namespace {

using numerics::ZernikeIndexing;

// The points of a square grid in the disc, those nearer to the centre than `inner` left out.
std::vector<Sample> grid(int half, double inner, const std::function<double(double, double)>& value) {
  std::vector<Sample> samples;
  for (int i = -half; i <= half; ++i)
    for (int j = -half; j <= half; ++j) {
      const double x = static_cast<double>(i) / half, y = static_cast<double>(j) / half, r = std::hypot(x, y);
      if (r <= 1 && r >= inner) samples.push_back({x, y, value(x, y)});
    }
  return samples;
}

std::optional<ZernikeFit> fit_zernike(const std::vector<Sample>& samples, ZernikeIndexing indexing, int term_count) {
  return ZernikeFitter(indexing, term_count).fit(samples);
}

// Coefficients of order one, found again to the rounding of some 700 samples and the basis' condition of below 1e3.
TEST(ZernikeFit, finds_known_coefficients_in_every_indexing) {
  for (const ZernikeIndexing indexing : {ZernikeIndexing::osa, ZernikeIndexing::noll, ZernikeIndexing::fringe}) {
    const int first = numerics::first_zernike_index(indexing);
    const auto coefficient = [](int place) { return std::cos(1.7 * place) / (1 + place); };
    const auto value = [&](double x, double y) {
      double sum = 0;
      for (int j = 0; j < 36; ++j) sum += coefficient(j) * numerics::zernike_value(indexing, numerics::zernike_term(indexing, first + j), x, y);
      return sum;
    };
    for (const double inner : {0.0, 0.4}) {
      const auto fit = fit_zernike(grid(15, inner, value), indexing, 36);
      ASSERT_TRUE(fit);
      ASSERT_EQ(fit->coefficients.size(), 36u);
      for (int j = 0; j < 36; ++j) EXPECT_NEAR(fit->coefficients[static_cast<std::size_t>(j)], coefficient(j), 1e-12) << j;
      EXPECT_LE(fit->residual_rms, 1e-13);
      EXPECT_EQ(fit->indexing, indexing);
    }
  }
}

// By hand: w = 1 + 2x + 3(x^2 + y^2) + 5xy. OSA: Z0 = 1, Z2 = 2x, Z4 = sqrt3 (2 r^2 - 1), Z3 = 2 sqrt6 xy.
TEST(ZernikeFit, gives_the_textbook_coefficients_of_a_quadratic) {
  const auto fit = fit_zernike(grid(15, 0, [](double x, double y) { return 1 + 2 * x + 3 * (x * x + y * y) + 5 * x * y; }), ZernikeIndexing::osa, 36);
  ASSERT_TRUE(fit);
  const double root3 = std::sqrt(3.0);
  EXPECT_NEAR(fit->coefficients[0], 2.5, 1e-13);
  EXPECT_NEAR(fit->coefficients[1], 0, 1e-13);
  EXPECT_NEAR(fit->coefficients[2], 1, 1e-13);
  EXPECT_NEAR(fit->coefficients[3], 5 / (2 * std::sqrt(6.0)), 1e-13);
  EXPECT_NEAR(fit->coefficients[4], 3 / (2 * root3), 1e-13);
  for (std::size_t j = 5; j < 36; ++j) EXPECT_NEAR(fit->coefficients[j], 0, 1e-13);
}

// Least squares: a term that is not fitted stays in the residual, and the residual is orthogonal to what is.
TEST(ZernikeFit, residual_is_what_the_terms_leave) {
  const auto samples = grid(15, 0.3, [](double x, double y) { return std::pow(x, 7) + y; });
  const auto fit = fit_zernike(samples, ZernikeIndexing::osa, 6);
  ASSERT_TRUE(fit);
  double squares = 0;
  std::vector<double> products(6);
  for (const Sample& s : samples) {
    double rest = s.value;
    for (int j = 0; j < 6; ++j) rest -= fit->coefficients[static_cast<std::size_t>(j)] * numerics::zernike_value(ZernikeIndexing::osa, numerics::osa_term(j), s.x, s.y);
    squares += rest * rest;
    for (int j = 0; j < 6; ++j) products[static_cast<std::size_t>(j)] += rest * numerics::zernike_value(ZernikeIndexing::osa, numerics::osa_term(j), s.x, s.y);
  }
  EXPECT_NEAR(fit->residual_rms, std::sqrt(squares / static_cast<double>(samples.size())), 1e-14);
  EXPECT_GT(fit->residual_rms, 0.01);
  for (const double product : products) EXPECT_NEAR(product, 0, 1e-11);
}

// At the same places, at others, at fewer (which begin as the others do), at places with the same x, with the same y, and back.
TEST(ZernikeFit, has_the_same_bits_whatever_the_fitter_did_before) {
  const auto wave = [](double x, double y) { return std::sin(3 * x) + x * y; };
  const auto other_wave = [](double x, double y) { return std::exp(x - y); };
  std::vector<Sample> fewer = grid(15, 0, wave);
  fewer.resize(fewer.size() - 40);
  std::vector<Sample> higher = grid(15, 0, wave), further = higher;
  for (Sample& sample : higher) sample.y *= 0.9;
  for (Sample& sample : further) sample.x *= 0.9;
  ZernikeFitter fitter(ZernikeIndexing::osa, 21);
  for (const auto& samples : {grid(15, 0, wave), grid(15, 0, other_wave), fewer, grid(15, 0.5, wave), std::vector<Sample>{}, grid(15, 0, wave), higher,
                              grid(15, 0, wave), further, grid(14, 0, wave)}) {
    const auto again = fitter.fit(samples), fresh = fit_zernike(samples, ZernikeIndexing::osa, 21);
    ASSERT_EQ(again.has_value(), fresh.has_value());
    if (!fresh) continue;
    EXPECT_EQ(again->coefficients, fresh->coefficients);
    EXPECT_EQ(again->residual_rms, fresh->residual_rms);
  }
}

TEST(ZernikeFit, is_none_where_the_samples_do_not_tell_the_terms_apart) {
  const auto one = [](double, double) { return 1.0; };
  std::vector<Sample> few = grid(15, 0, one);
  few.resize(35);
  EXPECT_FALSE(fit_zernike(few, ZernikeIndexing::osa, 36));
  EXPECT_FALSE(fit_zernike({}, ZernikeIndexing::osa, 1));
  // one ring: piston and defocus are the same there
  std::vector<Sample> ring;
  for (int i = 0; i < 200; ++i) ring.push_back({std::cos(0.1 * i), std::sin(0.1 * i), 1});
  EXPECT_FALSE(fit_zernike(ring, ZernikeIndexing::osa, 6));
  EXPECT_TRUE(fit_zernike(ring, ZernikeIndexing::osa, 4));
  // one line
  std::vector<Sample> line;
  for (int i = 0; i < 200; ++i) line.push_back({0.01 * i - 1, 0, 1});
  EXPECT_FALSE(fit_zernike(line, ZernikeIndexing::osa, 3));
}

}  // namespace
}  // namespace sagitta::analysis
