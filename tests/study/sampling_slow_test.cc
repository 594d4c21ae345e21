// SPDX-License-Identifier: Apache-2.0
// What a study claims of its rungs, held against counts that it has not measured and against a truth that it does not have.
#include <cmath>
#include <random>

#include "lib/analysis/job.h"
#include "lib/prescription/reader.h"
#include "lib/scene/compile.h"
#include "lib/study/settled.h"
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

std::vector<double> spots_of(const scene::Scene& scene, const char* pattern, std::int64_t rays) {
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

struct Breaks {
  int checked = 0, broken = 0;
  double worst = 0;  // of error/claim
};

// 45 counts of each pattern, evenly drawn from a logarithmic scale of 100 to 1e6, against rays four times as many as the study's finest. The claim of a count
// is that of the rung below it.
Breaks breaks_of(const prescription::Model& model, const std::string& pattern) {
  const study::Sampling sampling = study::sample_system(model, {}, [](double) {});
  const std::vector<Curve> curves = study::curves_of(sampling);
  const auto compiled = scene::compile(model);
  const std::vector<double> truths = spots_of(*compiled.scene, "hexapolar", 12'000'000);
  Breaks breaks;
  for (const Curve& curve : curves) {
    if (curve.quantity != Quantity::spot_rms || curve.pattern != pattern) continue;
    EXPECT_EQ(curve.steps.back().run->rays, 3'000'000);
    std::mt19937_64 generator(7);  // its values are the same everywhere, those of distributions are not
    for (int draw = 0; draw < 45; ++draw) {
      const double place = static_cast<double>(generator() >> 11) * 0x1p-53;
      const auto count = static_cast<std::int64_t>(std::pow(10, 2 + 4 * place));
      const std::vector<double> spots = spots_of(*compiled.scene, pattern == "random:1" ? ("random:" + std::to_string(1000 + draw)).c_str() : pattern.c_str(), count);
      const auto rung = std::find_if(curve.steps.rbegin(), curve.steps.rend(), [&](const study::Step& step) { return step.run->rays <= count; });
      for (std::size_t k = 0; k < spots.size(); ++k) {
        ++breaks.checked;
        const double ratio = std::abs(spots[k] - truths[k]) / rung->bounds[k];
        breaks.broken += ratio > 1;
        breaks.worst = std::max(breaks.worst, ratio);
      }
    }
  }
  printf("%s %s: %d of %d broken, worst %.3f\n", model.name.c_str(), pattern.c_str(), breaks.broken, breaks.checked, breaks.worst);
  return breaks;
}

TEST(SamplingSlow, ClaimsHoldBetweenTheRungs) {
  for (const auto& model : {shipped("navarro-eye"), shipped("ritchey-chretien"), clipped_lens()})
    for (const char* pattern : {"hexapolar", "square", "random:1"}) breaks_of(model, pattern);
}

// sqrt(sum c_j^2) over j > 0, of orthonormal terms: what the least squares of a wavefront that 36 terms take up leave of the rim's samples.
TEST(SamplingSlow, TruthOfTheWavefrontHoldsAgainstItsZernikeTerms) {
  for (const char* name : {"ac508-100-b", "le-grand-eye", "navarro-eye", "double-gauss", "cooke-triplet", "cornea-zernike"}) {
    const study::Sampling sampling = study::sample_system(shipped(name), {}, [](double) {});
    const std::vector<Curve> curves = study::curves_of(sampling);
    for (const Curve& curve : curves) {
      if (curve.quantity != Quantity::wavefront_rms) continue;
      for (std::size_t k = 0; k < curve.truths.size(); ++k) {
        const study::Answers& finest = curve.steps.back().run->answers[k];
        double squares = 0;
        for (std::size_t j = 1; j < finest.zernike_um.size(); ++j) squares += finest.zernike_um[j] * finest.zernike_um[j];
        const double rms = std::sqrt(squares) / sampling.wavelengths_um[finest.wavelength];
        printf("%s %zu arrived %d: %.6f +- %.6f, %.6f: %.2f\n", name, k, finest.arrived == finest.launched, curve.truths[k].value[0], curve.truths[k].uncertainty, rms, std::abs(curve.truths[k].value[0] - rms) / curve.truths[k].uncertainty);
      }
    }
  }
}

}  // namespace
}  // namespace sagitta::test
