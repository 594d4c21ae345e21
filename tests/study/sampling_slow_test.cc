// SPDX-License-Identifier: Apache-2.0
// What a study claims of its rungs, held against counts that it has not measured and against a truth that it does not have.
#include <algorithm>
#include <cmath>
#include <random>

#include "lib/analysis/job.h"
#include "lib/prescription/reader.h"
#include "lib/scene/compile.h"
#include "lib/study/settled.h"
#include "lib/surface/status.h"
#include "tests/study/subjects.h"

namespace sagitta::test {
namespace {

using study::Curve;
using study::Quantity;

prescription::Model shipped(const std::string& name) { return prescription::read_prescription(SAGITTA_SOURCE_DIR "/systems/" + name + ".yaml").model.value(); }

// The lens of the founding paper with a hole of 8 mm half way to its focus, where the beam is 6.25 mm wide on the axis, 3.6 mm off at 2.5 degrees: fields of 0 and 2.5 degrees,
// the hole's edge across the second, and at 3.5 degrees across the middle of the beam.
prescription::Model clipped_lens() {
  prescription::Model model = paper_lens();
  model.fields.points = {{0, 0}, {0, 2.5}, {0, 3.5}};
  const double half = model.surfaces[0].thickness_mm / 2, index = 1.64134164;
  model.surfaces[0].thickness_mm = half;
  prescription::Surface hole = surface_of({}, half, index);
  hole.semi_diameter_mm = 8;
  model.surfaces.insert(model.surfaces.begin() + 1, hole);
  return model;
}

std::vector<double> spots_of(const scene::Scene& scene, const std::string& pattern, std::int64_t rays) {
  analysis::JobRequest job;
  job.want_wavefront = false;
  job.pattern = *trace::parse_pattern(pattern);
  job.ray_count = rays;
  job.spot_image_size = 2;
  job.thread_count = 0;
  std::vector<double> spots;
  for (const analysis::JobResult& result : analysis::run_job(scene, job)) spots.push_back(1e3 * result.spot->rms_radius);
  return spots;
}

// 45 counts of each pattern, evenly drawn from a logarithmic scale of 100 to 1e6 (of random rays each with its own seed), against four times as many rays as the study's finest. The claim
// of a count is that of the rung below it, of the same field and wavelength. Where the errors of a rim jump from one count to the next, no measured maximum is safe: for normal errors the worst of 8 is
// passed by one of 9 new ones, twice that by one of a thousand; claims lie between. The share that README.md states is one of 50 for an answer of `square` and `random`, none by twice, and none at all of hexapolar.
void check_claims(const prescription::Model& model) {
  constexpr int draws = 45;
  const study::Sampling sampling = study::sample_system(model, {}, [](double) {});
  const auto compiled = scene::compile(model);
  const std::vector<double> truths = spots_of(*compiled.scene, "hexapolar", 12'000'000);
  int patterns = 0;
  for (const Curve& curve : study::curves_of(sampling)) {
    if (curve.quantity != Quantity::spot_rms) continue;
    ++patterns;
    EXPECT_EQ(curve.steps.back().run->rays, 3'000'000);
    std::mt19937_64 generator(7);  // its values are the same everywhere, those of distributions are not
    int broken = 0;
    for (int draw = 0; draw < draws; ++draw) {
      const auto count = static_cast<std::int64_t>(std::pow(10, 2 + 4 * static_cast<double>(generator() >> 11) * 0x1p-53));
      const std::string pattern = curve.pattern == "random:1" ? "random:" + std::to_string(1000 + draw) : curve.pattern;
      const std::vector<double> spots = spots_of(*compiled.scene, pattern, count);
      ASSERT_EQ(spots.size(), truths.size());
      const auto rung = std::find_if(curve.steps.rbegin(), curve.steps.rend(), [&](const study::Step& step) { return step.run->rays <= count; });
      ASSERT_NE(rung, curve.steps.rend());
      for (std::size_t k = 0; k < spots.size(); ++k) {
        const double error = std::abs(spots[k] - truths[k]);
        broken += error > rung->bounds[k];
        EXPECT_LT(error, 2 * rung->bounds[k]) << pattern << " " << count << " field and wavelength " << k;
      }
    }
    EXPECT_LE(broken, curve.pattern == "hexapolar" ? 0 : draws * static_cast<int>(truths.size()) / 50) << curve.pattern;
  }
  EXPECT_EQ(patterns, 3);
}

TEST(SamplingSlow, ClaimsOfAnEyeHoldBetweenTheRungs) { check_claims(shipped("navarro-eye")); }
TEST(SamplingSlow, ClaimsOfAnObscuredBeamHoldBetweenTheRungs) { check_claims(shipped("ritchey-chretien")); }
TEST(SamplingSlow, ClaimsOfAClippedBeamHoldBetweenTheRungs) { check_claims(clipped_lens()); }

// Over a full disc RMS^2 = sum_(j > 0) c_j^2 + residual^2 for orthonormal terms, to the residual's own sampling: least squares leave the samples of the rim no weight but in the residual, which is small.
TEST(SamplingSlow, TruthOfTheWavefrontHoldsAgainstItsZernikeTerms) {
  int checked = 0;
  for (const char* name : {"ac508-100-b", "le-grand-eye", "navarro-eye", "double-gauss", "cooke-triplet", "cornea-zernike"}) {
    const prescription::Model model = shipped(name);
    const study::Sampling sampling = study::sample_system(model, {}, [](double) {});
    const std::vector<Curve> curves = study::curves_of(sampling);
    const auto curve = std::find_if(curves.begin(), curves.end(), [](const Curve& one) { return one.quantity == Quantity::wavefront_rms; });
    ASSERT_NE(curve, curves.end());
    const auto compiled = scene::compile(model);
    analysis::JobRequest job;
    job.want_spot = false;
    job.wavefront.size = curve->steps.back().run->grid;
    const auto results = analysis::run_job(*compiled.scene, job);
    ASSERT_EQ(results.size(), curve->truths.size());
    for (std::size_t k = 0; k < results.size(); ++k, ++checked) {
      const auto& fit = results[k].wavefront->wavefront->zernike;
      ASSERT_TRUE(fit);
      EXPECT_EQ(results[k].rays.total(), results[k].rays[surface::Status::ok]) << "a full disc";
      double squares = fit->residual_rms * fit->residual_rms;
      for (std::size_t j = 1; j < fit->coefficients.size(); ++j) squares += fit->coefficients[j] * fit->coefficients[j];
      const double rms_waves = std::sqrt(squares) / sampling.wavelengths_um[results[k].wavelength];
      EXPECT_NEAR(curve->truths[k].value[0], rms_waves, curve->truths[k].uncertainty) << name << " " << k;
    }
  }
  EXPECT_EQ(checked, 6 + 3 + 9 + 9 + 9 + 2);
}

}  // namespace
}  // namespace sagitta::test
