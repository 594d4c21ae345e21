// SPDX-License-Identifier: Apache-2.0
// The answers of a system whose answers are known in closed form: what a study claims of them holds.
#include <cmath>

#include "lib/analysis/job.h"
#include "lib/scene/compile.h"
#include "lib/study/settled.h"
#include "tests/study/subjects.h"

namespace sagitta::test {
namespace {

using study::Curve;
using study::Quantity;

constexpr double focal = 100, pupil_radius = 20, defocus = 0.5;

// A paraboloid mirror, perfect on the axis, with its image plane `beyond` mm behind the focus.
prescription::Model mirror(double beyond) {
  prescription::Model model = system_of({surface_of(conic_shape(-2 * focal, -1), -focal - beyond, 0)}, 2 * pupil_radius);
  return model;
}

// A ray at the height r (s = r^2) meets the mirror at the sag s/4f before the vertex and goes to the focus, f - s/4f along the axis and r across:
// at a plane d behind the focus it is r d/(f - s/4f) off the axis. The mean of its square over the pupil, s uniform in (0, R^2), with v = f - s/4f:
//   d^2/R^2 int s/v^2 ds = 16 f^2 d^2/R^2 [ln v + f/v] from v = f to v = f - R^2/4f
double spot_rms_um() {
  const double v = focal - pupil_radius * pupil_radius / (4 * focal);
  return 1e3 * 4 * focal * defocus / pupil_radius * std::sqrt((std::log(v) + focal / v) - (std::log(focal) + 1));
}

// All rays come to the focus in phase; from there a ray at the angle theta to the axis, tan(theta/2) = r/2f, has to the sphere of radius R about
// the point d behind the focus the path d cos(theta) + sqrt(R^2 - d^2 sin^2(theta)). The sphere passes through the exit pupil, the mirror's vertex: R = f + d.
double path_from_focus(double s) {
  const double theta = 2 * std::atan(std::sqrt(s) / (2 * focal)), R = focal + defocus;
  return defocus * std::cos(theta) - std::sqrt(R * R - std::pow(defocus * std::sin(theta), 2));
}
// OPD = path of the chief ray - path of the ray. Its moments over the pupil, uniform in s, by Simpson's rule: smooth in s, so 200 steps leave nothing.
struct Moments {
  double mean = 0, square = 0;
  double defocus = 0;  // mean of OPD Z, Z = sqrt(3) (2 s/R^2 - 1), term 4 of OSA
};
Moments opd_moments_um() {
  const int steps = 200;
  Moments moments;
  for (int i = 0; i <= steps; ++i) {
    const double weight = (i == 0 || i == steps ? 1 : i % 2 == 1 ? 4 : 2) / (3.0 * steps), share = 1.0 * i / steps;
    const double opd = 1e3 * (path_from_focus(0) - path_from_focus(pupil_radius * pupil_radius * share));
    moments.mean += weight * opd;
    moments.square += weight * opd * opd;
    moments.defocus += weight * opd * std::sqrt(3.0) * (2 * share - 1);
  }
  return moments;
}
double wavefront_rms_waves(double wavelength_um) {
  const Moments moments = opd_moments_um();
  return std::sqrt(moments.square - moments.mean * moments.mean) / wavelength_um;
}

study::SamplingRequest small_request() {
  study::SamplingRequest request;
  request.most_rays = 30000;
  request.most_grid = 128;
  request.thread_count = 1;
  return request;
}

// The test that matters: true errors lie within what is claimed, and claims are not far above them.
TEST(Sampling, ClaimsOfADefocusedMirrorHoldAgainstTheClosedForm) {
  double last = 0;
  const study::Sampling sampling = study::sample_system(mirror(defocus), small_request(), [&](double share) {
    EXPECT_GT(share, last);
    last = share;
  });
  EXPECT_DOUBLE_EQ(last, 1);
  const std::vector<Curve> curves = study::curves_of(sampling);
  ASSERT_EQ(curves.size(), 5u);
  int checked = 0;
  for (const Curve& curve : curves) {
    if (curve.quantity == Quantity::zernike) {  // the worst of 36 is no better than this one
      for (const study::Step& step : curve.steps) {
        const study::Answer& coefficients = step.run->answers[0].zernike_um;
        ASSERT_EQ(coefficients.size(), 36u);
        EXPECT_NEAR(coefficients[4], opd_moments_um().defocus, step.bounds[0]);
        EXPECT_LT(step.bounds[0], 1e-3 * coefficients[4]);  // a wavefront that terms of order 7 take up
        EXPECT_EQ(step.bound.absolute, step.bounds[0]);
      }
      continue;
    }
    const bool is_spot = curve.quantity == Quantity::spot_rms;
    const double truth = is_spot ? spot_rms_um() : wavefront_rms_waves(sampling.wavelengths_um.front());
    ASSERT_EQ(curve.truths.size(), 1u);
    EXPECT_LE(std::abs(curve.truths[0].value[0] - truth), curve.truths[0].uncertainty);
    double worst_from_there_on = 0;
    const auto off_of = [&](const study::Answers& answers) { return std::abs(study::answer_of(answers, curve.quantity)[0] - truth); };
    for (auto step = curve.steps.rbegin(); step != curve.steps.rend(); ++step, ++checked) {
      const double off = off_of(step->run->answers[0]);
      worst_from_there_on = std::max(worst_from_there_on, off);
      for (const auto& answers : step->run->beyond) worst_from_there_on = std::max(worst_from_there_on, off_of(answers[0]));
      EXPECT_LE(worst_from_there_on, step->bounds[0]) << curve.pattern << step->count;
      // No error rises by more than the worst; the finest's own error, u at most, enters once itself and in either. The last rungs go on with those before.
      if (step->run->beyond.size() >= 4) {
        EXPECT_LE(step->bounds[0], 2 * worst_from_there_on + 3 * curve.truths[0].uncertainty) << curve.pattern << step->count;
      }
      EXPECT_NEAR(step->bound.percent, 100 * step->bounds[0] / curve.truths[0].value[0], 1e-12);
      EXPECT_TRUE(std::isnan(step->bound.absolute));
    }
  }
  EXPECT_EQ(checked, 3 * 6 + 7);
  EXPECT_EQ(curves[0].pattern, "hexapolar");
  EXPECT_LT(curves[0].uncertainty.percent, .02);
}

// Ring i of the hexapolar pattern has 6i points at r^2 = R^2 (1 + 3i^2)/N, so that with N = 1 + m, m = 3k(k + 1), the mean of r^2 over k rings and
// the centre is R^2 (m + m^2/2)/N^2 = R^2/2 (1 - 1/N^2): a collimated beam on a plane settles with order 2. The fit takes 127, 331, 1027 and 3169 rays
// (the error of 10267 is not above twice its own); of these the last has an error too small by (3169/30301)^2 = 0.011, whose weight in the slope is
// (8.06 - 6.41)/5.8 = 0.28 in logarithms: 0.003.
TEST(Sampling, RingsOfACollimatedBeamSettleWithOrderTwo) {
  const study::Sampling sampling = study::sample_system(system_of({surface_of({}, 10, 1)}, 2 * pupil_radius), small_request(), [](double) {});
  const std::vector<Curve> curves = study::curves_of(sampling);
  ASSERT_EQ(curves.size(), 3u) << "there is no wavefront";
  EXPECT_EQ(sampling.wavefronts[0].answers[0].no_wavefront, "the image is afocal");
  EXPECT_NEAR(curves[0].order.slope, -2, .005);
  EXPECT_EQ(curves[0].order.pairs, 4);
  for (const study::Run& run : sampling.spots[0]) {
    const double count = static_cast<double>(run.answers[0].launched), expected = 1e3 * pupil_radius * std::sqrt((1 - 1 / (count * count)) / 2);
    EXPECT_NEAR(run.answers[0].spot_rms_um[0], expected, 1e-12 * expected);  // 30,000 terms, summed with compensation
  }
}

TEST(Sampling, TakesTheRaysAndGridsThatItSays) {
  const study::Sampling sampling = study::sample_system(mirror(defocus), small_request(), [](double) {});
  ASSERT_EQ(sampling.spots.size(), 3u);
  for (const auto& runs : sampling.spots) {
    std::vector<std::int64_t> rays;
    for (const study::Run& run : runs) {
      rays.push_back(run.rays);
      EXPECT_EQ(run.grid, 0);
      ASSERT_EQ(run.answers.size(), 1u);
      EXPECT_GE(run.answers[0].launched, run.rays);
      EXPECT_EQ(run.answers[0].arrived, run.answers[0].launched);
      EXPECT_GE(run.processor_s.runs, 1);
      EXPECT_GT(run.processor_s.median, 0);
      EXPECT_LE(run.processor_s.least, run.processor_s.median);
    }
    EXPECT_EQ(rays, (std::vector<std::int64_t>{100, 300, 1000, 3000, 10000, 30000}));
  }
  std::vector<int> grids;
  for (const study::Run& run : sampling.wavefronts) grids.push_back(run.grid);
  EXPECT_EQ(grids, (std::vector<int>{16, 24, 32, 48, 64, 96, 128}));
  EXPECT_TRUE(sampling.clouds.empty());
}

TEST(Sampling, LooksBetweenTheRungsAtOtherCountsAndSeeds) {
  const prescription::Model model = mirror(defocus);
  const study::Sampling sampling = study::sample_system(model, small_request(), [](double) {});
  const auto counts = [](const std::vector<study::Run>& runs) {
    std::vector<std::size_t> result;
    for (const study::Run& run : runs) result.push_back(run.beyond.size());
    return result;
  };
  for (const auto& runs : sampling.spots) EXPECT_EQ(counts(runs), (std::vector<std::size_t>{8, 8, 8, 5, 1, 0})) << "30000/2N of them";
  // 12469 samples in all; of 18 to 22 a side there are three even ones
  EXPECT_EQ(sampling.wavefronts[0].beyond.size(), 3u);
  EXPECT_EQ(sampling.wavefronts.back().beyond.size(), 0u);
  const auto check_rising = [](const std::vector<study::Run>& runs, bool strictly) {
    for (std::size_t i = 0; i + 1 < runs.size(); ++i) {
      std::int64_t last = runs[i].answers[0].launched;
      for (const auto& answers : runs[i].beyond) {
        EXPECT_GE(answers[0].launched, last + strictly);
        last = answers[0].launched;
      }
      EXPECT_GE(runs[i + 1].answers[0].launched, last + strictly);
    }
  };
  check_rising(sampling.spots[0], false);  // small counts are rounded up to the same rings
  check_rising(sampling.spots[2], true);
  check_rising(sampling.wavefronts, true);
  // The third count of random rays has the seed 4.
  const study::Answers& third = sampling.spots[2][0].beyond[2][0];
  analysis::JobRequest job;
  job.want_wavefront = false;
  job.pattern = *trace::parse_pattern("random:4");
  job.ray_count = third.launched;
  const auto compiled = scene::compile(model);
  EXPECT_DOUBLE_EQ(third.spot_rms_um[0], 1e3 * analysis::run_job(*compiled.scene, job)[0].spot->rms_radius);
}

// In focus nothing is left but rounding: no percents.
TEST(Sampling, OfAPerfectImageIsNotInPercent) {
  const study::Sampling sampling = study::sample_system(mirror(0), small_request(), [](double) {});
  for (const Curve& curve : study::curves_of(sampling)) {
    EXPECT_TRUE(std::isnan(curve.uncertainty.percent));
    for (const study::Step& step : curve.steps) EXPECT_LT(step.bound.absolute, 1e-8) << curve.pattern;
  }
}

// Made up: fields of 100 and 10 um, of 310, 1010 and 4040 rays. Errors of the first: 30, 4, 0 um, of the second: 1, 1, 0: in percent 30, 4 and 10, 10.
// The truth of each is off by its error of 1000 rays: 4 and 10 %. A third field, of a nanometre, is not in percent; its errors are 2, 1 nm.
TEST(Sampling, WorstOfTheFieldsIsInPercentOfEachOne) {
  const auto answers = [](double first, double second, double third, std::int64_t rays) {
    std::vector<study::Answers> result(3);
    const double spots[] = {first, second, third};
    for (std::size_t k = 0; k < 3; ++k) {
      result[k].field = k;
      result[k].launched = rays;
      result[k].spot_rms_um = {spots[k]};
    }
    return result;
  };
  study::Sampling sampling;
  sampling.wavelengths_um = {.5};
  sampling.spots = {{{"hexapolar", 300, 0, answers(130, 11, .003, 310), {}, {}}, {"hexapolar", 1000, 0, answers(96, 9, .002, 1010), {}, {}}, {"hexapolar", 3000, 0, answers(100, 10, .001, 4040), {}, {}}}};
  sampling.wavefronts = {{"", 0, 16, answers(0, 0, 0, 149), {}, {}}};
  const std::vector<Curve> curves = study::curves_of(sampling);
  ASSERT_EQ(curves.size(), 1u);
  ASSERT_EQ(curves[0].steps.size(), 3u);
  const auto& steps = curves[0].steps;
  EXPECT_EQ(steps[1].count, 1010);
  EXPECT_DOUBLE_EQ(steps[0].error.percent, 30);
  EXPECT_DOUBLE_EQ(steps[1].error.percent, 10);
  EXPECT_DOUBLE_EQ(steps[2].error.percent, 0);
  EXPECT_DOUBLE_EQ(steps[0].bound.percent, 34);
  EXPECT_DOUBLE_EQ(steps[1].bound.percent, 20);
  EXPECT_DOUBLE_EQ(steps[2].bound.percent, 10);
  EXPECT_DOUBLE_EQ(curves[0].uncertainty.percent, 10);
  EXPECT_NEAR(steps[0].error.absolute, .002, 1e-15);
  EXPECT_NEAR(steps[1].bound.absolute, .002, 1e-15);
  EXPECT_EQ(curves[0].order.pairs, 1) << "only 30 % stands clear of twice 10 %";
}

// A budget for nothing still takes what `trace` takes, and finer.
TEST(Sampling, BudgetLeavesTheUsualNumbersAndTwoFiner) {
  study::SamplingRequest request;
  request.budget = 1;
  request.thread_count = 1;
  const study::Sampling sampling = study::sample_system(mirror(defocus), request, [](double) {});
  EXPECT_EQ(sampling.spots[0].back().rays, 100'000);
  EXPECT_EQ(sampling.wavefronts.back().grid, 128);
}

TEST(Sampling, HasReasonsWhereThereIsNoAnswer) {
  prescription::Model model = mirror(defocus);
  model.surfaces[0].semi_diameter_mm = 25;
  model.surfaces[1].semi_diameter_mm = 3;
  model.fields.points = {{0, 0}, {0, 5}};  // lands 8.7 mm off the axis
  study::SamplingRequest request = small_request();
  request.most_rays = 1000;
  request.most_grid = 24;
  const study::Sampling sampling = study::sample_system(model, request, [](double) {});
  const study::Answers& spot = sampling.spots[0].back().answers[1];
  EXPECT_EQ(spot.field, 1u);
  EXPECT_EQ(spot.arrived, 0);
  EXPECT_TRUE(spot.spot_rms_um.empty());
  EXPECT_EQ(spot.no_spot, "no ray arrived");
  EXPECT_EQ(sampling.wavefronts.back().answers[1].no_wavefront, "the chief ray is lost: clipped at surface 2");
  const std::vector<Curve> curves = study::curves_of(sampling);
  ASSERT_EQ(curves.size(), 5u);
  for (const Curve& curve : curves) {
    EXPECT_TRUE(curve.truths[1].value.empty());
    for (const study::Step& step : curve.steps) {
      EXPECT_TRUE(std::isnan(step.errors[1]));
      EXPECT_TRUE(std::isfinite(step.bound.main())) << "the field without an answer is no worst one";
    }
  }
}

TEST(Sampling, OfASystemThatIsNoneHasFindings) {
  prescription::Model model = mirror(defocus);
  model.aperture = {prescription::ApertureKind::image_f_number, 4, false, {}};
  model.surfaces[0].shape = conic_shape(std::numeric_limits<double>::infinity(), 0);
  const study::Sampling sampling = study::sample_system(model, small_request(), [](double) {});
  EXPECT_TRUE(sampling.findings.has_errors());
  EXPECT_TRUE(sampling.spots.empty());
}

}  // namespace
}  // namespace sagitta::test
